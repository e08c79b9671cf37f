//! The page.

use crate::app::{App, Asked, Keep, Kept};
use crate::commands::{Answer, Command};
use crate::desk::Desk;
use crate::open::Source;
use antumbra::{Spec, gpu::device_descriptor};
use eframe::egui_wgpu::{WgpuConfiguration, WgpuSetup, WgpuSetupCreateNew};
use eframe::{egui, wasm_bindgen::JsCast};
use std::collections::VecDeque;
use std::sync::{Arc, Mutex};
use wasm_bindgen::prelude::*;

/// The viewer on a page.
#[wasm_bindgen]
pub struct Page {
    commands: Arc<Mutex<VecDeque<Asked>>>,
    runner: eframe::WebRunner,
}

#[wasm_bindgen]
impl Page {
    /// Starts on a canvas; `scene` and `specs` (separated by blanks) are as on the command line, and may be empty.
    pub async fn start(canvas: web_sys::HtmlCanvasElement, scene: String, specs: String) -> Result<Page, JsValue> {
        let specs: Result<Vec<Spec>, _> = specs.split_whitespace().map(str::parse).collect();
        let specs = specs.map_err(|e| JsValue::from_str(&e.to_string()))?;
        let commands = Arc::new(Mutex::new(VecDeque::new()));
        let first = if scene.is_empty() { "builtin:fence".to_owned() } else { scene };
        let keep: Keep = Arc::new(Mutex::new(Some(Kept {
            desk: Desk::new(&specs),
            first: Some(Source::Argument(first)),
            commands: commands.clone(),
            faults: Arc::default(),
            lost: 0,
            again: false,
        })));
        let mut setup = WgpuSetupCreateNew {
            device_descriptor: Arc::new(device_descriptor),
            ..WgpuSetupCreateNew::without_display_handle()
        };
        setup.instance_descriptor.backends = wgpu::Backends::BROWSER_WEBGPU;
        let options = eframe::WebOptions {
            wgpu_options: WgpuConfiguration { wgpu_setup: WgpuSetup::CreateNew(setup), ..Default::default() },
            dithering: false,
            ..Default::default()
        };
        let runner = eframe::WebRunner::new();
        let creator = Box::new(move |context: &eframe::CreationContext| {
            App::new(context, keep).map(|app| Box::new(app) as Box<dyn eframe::App>).map_err(Into::into)
        });
        runner.start(canvas, options, creator).await?;
        Ok(Page { commands, runner })
    }

    /// Does a [command](crate::commands), given as JSON, and resolves to its answer, as JSON too.
    pub async fn command(&self, json: String) -> Result<String, JsValue> {
        let command: Command = serde_json::from_str(&json).map_err(|e| JsValue::from_str(&e.to_string()))?;
        let answer = Arc::new(Mutex::new(None));
        let given = answer.clone();
        let take = Box::new(move |a: Answer| {
            if let Ok(mut slot) = given.lock() {
                *slot = Some(a);
            }
        });
        if let Ok(mut queue) = self.commands.lock() {
            queue.push_back(Asked { command, answer: take });
        }
        loop {
            if let Some(answer) = answer.lock().ok().and_then(|mut a| a.take()) {
                return serde_json::to_string(&answer).map_err(|e| JsValue::from_str(&e.to_string()));
            }
            if let Some(summary) = self.runner.panic_summary() {
                return Err(JsValue::from_str(&summary.message()));
            }
            pause(20).await?;
        }
    }
}

/// Gives the page time for its own affairs.
async fn pause(milliseconds: i32) -> Result<(), JsValue> {
    let promise = js_sys::Promise::new(&mut |resolve, _| {
        if let Some(window) = web_sys::window() {
            // Without timers nothing on the page moves, this included.
            let _ = window.set_timeout_with_callback_and_timeout_and_arguments_0(&resolve, milliseconds);
        }
    });
    wasm_bindgen_futures::JsFuture::from(promise).await.map(|_| ())
}

/// Starts the page anew, on a fresh device.
pub fn restart(_ctx: &egui::Context) {
    if let Some(window) = web_sys::window() {
        // A page that may not be loaded again stays as it is.
        let _ = window.location().reload();
    }
}

/// Hands bytes to the browser as a file.
pub fn download(name: &str, bytes: &[u8]) -> Result<(), JsValue> {
    let window = web_sys::window().ok_or("no window")?;
    let document = window.document().ok_or("no document")?;
    let parts = js_sys::Array::of1(&js_sys::Uint8Array::from(bytes));
    let blob = web_sys::Blob::new_with_u8_array_sequence(&parts)?;
    let url = web_sys::Url::create_object_url_with_blob(&blob)?;
    let link: web_sys::HtmlAnchorElement = document.create_element("a")?.unchecked_into();
    link.set_href(&url);
    link.set_download(name);
    link.click();
    web_sys::Url::revoke_object_url(&url)
}
