//! The browser's file dialog.

use super::files;
use crate::open::Chosen;
use eframe::egui;
use send_wrapper::SendWrapper;
use std::future::Future;
use std::path::{Path, PathBuf};
use std::pin::Pin;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use wasm_bindgen::closure::Closure;
use wasm_bindgen::{JsCast, JsValue};
use wasm_bindgen_futures::JsFuture;

/// Shows the file dialog. A browser opens it only shortly after a click, and reports nothing otherwise.
pub fn choose_files(extensions: &[&str], wake: impl Fn() + 'static) -> Receiver<Chosen> {
    let (send, receive) = channel();
    if let Err(error) = ask(extensions, send.clone(), wake) {
        let _ = send.send(Err(files::text(&error)));
    }
    receive
}

fn ask(extensions: &[&str], send: Sender<Chosen>, wake: impl Fn() + 'static) -> Result<(), JsValue> {
    let document = web_sys::window().and_then(|w| w.document()).ok_or("there is no page")?;
    let input: web_sys::HtmlInputElement = document.create_element("input")?.dyn_into()?;
    input.set_type("file");
    input.set_multiple(true);
    input.set_accept(&extensions.iter().map(|e| format!(".{e}")).collect::<Vec<_>>().join(","));
    let chosen = {
        let input = input.clone();
        move || {
            let list = input.files();
            let files = (0..list.as_ref().map_or(0, web_sys::FileList::length)).filter_map(|i| list.as_ref()?.get(i));
            let files = files.map(|file| Arc::new(ChosenFile::of(file)) as egui::DroppedFileHandle).collect();
            // The viewer may have restarted.
            let _ = send.send(Ok(files));
            wake();
        }
    };
    // Either event ends both.
    let heard = Rc::new(chosen);
    for event in ["change", "cancel"] {
        let heard = heard.clone();
        let listener = Closure::once_into_js(move || heard());
        input.add_event_listener_with_callback(event, listener.unchecked_ref())?;
    }
    input.click();
    Ok(())
}

#[derive(Debug)]
struct ChosenFile {
    path: PathBuf,
    file: SendWrapper<web_sys::File>,
}

impl ChosenFile {
    fn of(file: web_sys::File) -> ChosenFile {
        ChosenFile { path: file.name().into(), file: SendWrapper::new(file) }
    }
}

impl egui::DroppedFile for ChosenFile {
    fn path(&self) -> &Path {
        &self.path
    }

    fn bytes_async(&self) -> Pin<Box<dyn Future<Output = Result<Vec<u8>, String>> + '_>> {
        Box::pin(async {
            let bytes = JsFuture::from(self.file.array_buffer()).await.map_err(|e| files::text(&e))?;
            Ok(js_sys::Uint8Array::new(&bytes).to_vec())
        })
    }
}
