//! Commands from the page's JavaScript, and calls into it.

use super::{files, wake};
use crate::app::PendingCommand;
use crate::commands::{Command, Reply};
use js_sys::{Function, JSON, Object, Promise, Reflect};
use send_wrapper::SendWrapper;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex};
use wasm_bindgen::closure::Closure;
use wasm_bindgen::{JsCast, JsValue};

/// The page's object `window.antumbra`, made if missing.
fn ours() -> Result<Object, JsValue> {
    let global = js_sys::global();
    let name = JsValue::from_str("antumbra");
    let known = Reflect::get(&global, &name)?;
    if let Ok(object) = known.dyn_into() {
        return Ok(object);
    }
    let made = Object::new();
    Reflect::set(&global, &name, &made)?;
    Ok(made)
}

/// Calls a function of the page, if it has it.
pub fn tell(function: &str, text: &str) {
    let found = ours().and_then(|o| Reflect::get(&o, &function.into())).and_then(|f| f.dyn_into::<Function>());
    if let Ok(found) = found {
        // The page reports its own failures.
        let _ = found.call1(&JsValue::NULL, &text.into());
    }
}

/// Adds `ask` to the page's object: commands go to this list.
pub fn listen(commands: &Arc<Mutex<VecDeque<PendingCommand>>>) -> Result<(), JsValue> {
    let commands = commands.clone();
    let ask = Closure::<dyn FnMut(JsValue) -> Promise>::new(move |command: JsValue| {
        let commands = commands.clone();
        Promise::new(&mut move |resolve, _| {
            let resolve = SendWrapper::new(resolve);
            let answer = Box::new(move |answer: Reply| answer_with(&resolve, &answer));
            match read(&command) {
                Ok(command) => {
                    if let Ok(mut queue) = commands.lock() {
                        queue.push_back(PendingCommand { command, answer });
                    }
                }
                Err(error) => answer(Reply { error: Some(error), state: None }),
            }
            wake();
        })
    });
    Reflect::set(&ours()?.into(), &"ask".into(), ask.as_ref())?;
    // The closure lives as long as the page.
    ask.forget();
    Ok(())
}

fn read(command: &JsValue) -> Result<Command, String> {
    let text = JSON::stringify(command).map_err(|e| files::text(&e))?;
    serde_json::from_str(&String::from(text)).map_err(|e| e.to_string())
}

fn answer_with(resolve: &Function, answer: &Reply) {
    let text = serde_json::to_string(answer).unwrap_or_default();
    let value = JSON::parse(&text).unwrap_or(JsValue::NULL);
    // The page may be gone.
    let _ = resolve.call1(&JsValue::NULL, &value);
}
