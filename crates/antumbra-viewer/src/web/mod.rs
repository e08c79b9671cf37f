//! The platform of a web page: jobs in slices of one thread, addresses, downloads.
//!
//! The page (`index.html`) shows its own text until the viewer draws, and whenever it cannot. It has an object
//! `window.antumbra` with the functions `ready()` and `failed(message)`; the viewer adds `ask(command)`, which takes a
//! [command](crate::commands) as an object and gives a promise of its answer.

mod asking;
mod dialog;
mod files;
mod jobs;

pub use dialog::choose_files;
pub use files::{dropped, keep, load, load_dropped, write};
pub use jobs::{HAS_THREADS, run as run_job, workers, yield_to_frame};

use crate::app::{App, PersistentState, SharedState};
use crate::commands::Command;
use crate::open::Source;
use crate::view_state::ViewState;
use antumbra::Spec;
use antumbra::gpu::device::device_descriptor;
use eframe::egui;
use eframe::egui_wgpu::{WgpuConfiguration, WgpuSetup, WgpuSetupCreateNew};
use std::cell::RefCell;
use std::sync::{Arc, Mutex};
use wasm_bindgen::{JsCast, JsValue};
use wasm_bindgen_futures::spawn_local;

/// The id of the element that is drawn on.
const CANVAS: &str = "viewer";

/// Globals of the page.
struct Page {
    runner: eframe::WebRunner,
    targets: web_sys::HtmlCanvasElement,
    keep: SharedState,
    /// True while the viewer is begun anew.
    restarts: bool,
}

thread_local! {
    static PAGE: RefCell<Option<Page>> = const { RefCell::new(None) };
    static CONTEXT: RefCell<Option<egui::Context>> = const { RefCell::new(None) };
}

/// Opens the viewer on the page, as its address asks.
pub fn open_page() {
    match page() {
        Ok(page) => {
            PAGE.set(Some(page));
            begin();
        }
        Err(message) => asking::tell("failed", &message),
    }
}

fn page() -> Result<Page, String> {
    let document = web_sys::window().and_then(|w| w.document()).ok_or("there is no page")?;
    let targets = document.get_element_by_id(CANVAS).and_then(|e| e.dyn_into().ok());
    let targets = targets.ok_or_else(|| format!("the page has no targets `{CANVAS}`"))?;
    let (view_state, scene) = asked_by_address()?;
    let commands = Arc::default();
    asking::listen(&commands).map_err(|e| files::text(&e))?;
    let kept = PersistentState {
        view_state,
        first: Some(Source::Argument(scene)),
        commands,
        faults: Arc::default(),
        lost: 0,
        again: false,
    };
    let keep = Arc::new(Mutex::new(Some(kept)));
    Ok(Page { runner: eframe::WebRunner::new(), targets, keep, restarts: false })
}

/// `?scene=builtin:fence&technique=pcss:map=512&technique=hard&compare=two&show=error&resolution=0.5`.
fn asked_by_address() -> Result<(ViewState, String), String> {
    let search = web_sys::window().and_then(|w| w.location().search().ok()).unwrap_or_default();
    let asked = web_sys::UrlSearchParams::new_with_str(&search).map_err(|e| files::text(&e))?;
    let specs = asked.get_all("technique").into_iter().filter_map(|v| v.as_string());
    let specs: Result<Vec<Spec>, String> = specs.map(|s| s.parse::<Spec>().map_err(|e| e.to_string())).collect();
    let mut view_state = ViewState::new(&specs?);
    for key in ["compare", "show"] {
        if let Some(value) = asked.get(key) {
            set(&mut view_state, serde_json::json!({ key: value })).map_err(|e| format!("{key}={value}: {e}"))?;
        }
    }
    if let Some(value) = asked.get("resolution") {
        let number: f32 = value.parse().map_err(|e| format!("resolution={value}: {e}"))?;
        set(&mut view_state, serde_json::json!({ "resolution": number }))?;
    }
    Ok((view_state, asked.get("scene").unwrap_or_else(|| crate::FIRST_SCENE.to_owned())))
}

fn set(view_state: &mut ViewState, command: serde_json::Value) -> Result<(), String> {
    let command: Command = serde_json::from_value(command).map_err(|e| e.to_string())?;
    crate::commands::apply(command, view_state).map(|_| ())
}

/// Starts the viewer on the page with its persistent state.
fn begin() {
    let Some((runner, targets, keep)) =
        PAGE.with_borrow(|p| p.as_ref().map(|p| (p.runner.clone(), p.targets.clone(), p.keep.clone())))
    else {
        return;
    };
    spawn_local(async move {
        let creator = Box::new(move |context: &eframe::CreationContext| {
            CONTEXT.set(Some(context.egui_ctx.clone()));
            App::new(context, keep).map(|app| Box::new(app) as Box<dyn eframe::App>).map_err(Into::into)
        });
        let started: Result<(), JsValue> = runner.start(targets, options(), creator).await;
        PAGE.with_borrow_mut(|p| p.iter_mut().for_each(|p| p.restarts = false));
        match started {
            Ok(()) => asking::tell("ready", ""),
            Err(error) => asking::tell("failed", &files::text(&error)),
        }
    });
}

fn options() -> eframe::WebOptions {
    let setup = WgpuSetupCreateNew {
        device_descriptor: Arc::new(device_descriptor),
        power_preference: wgpu::PowerPreference::HighPerformance,
        ..WgpuSetupCreateNew::without_display_handle()
    };
    eframe::WebOptions {
        wgpu_options: WgpuConfiguration { wgpu_setup: WgpuSetup::CreateNew(setup), ..Default::default() },
        // Dithering would look like noise of the technique.
        dithering: false,
        ..Default::default()
    }
}

/// Restarts on a new device after this frame.
pub fn restart(_ctx: &egui::Context) {
    let runner = PAGE.with_borrow_mut(|page| {
        let page = page.as_mut().filter(|p| !p.restarts)?;
        page.restarts = true;
        Some(page.runner.clone())
    });
    let Some(runner) = runner else { return };
    spawn_local(async move {
        yield_to_frame().await;
        // The app returns the persistent state when it is dropped.
        runner.destroy();
        begin();
    });
}

/// Requests the next frame.
fn wake() {
    CONTEXT.with_borrow(|ctx| ctx.iter().for_each(egui::Context::request_repaint));
}
