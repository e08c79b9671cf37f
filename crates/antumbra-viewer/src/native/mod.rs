//! The platform of a window: threads and files.

mod dialog;
mod files;
mod jobs;

pub use dialog::choose_files;
pub use files::{dropped, keep, load, load_dropped, write};
pub use jobs::{HAS_THREADS, run as run_job, workers, yield_to_frame};

use crate::app::{App, PendingCommand, PersistentState, SharedState};
use crate::commands::Reply;
use crate::open::Source;
use crate::view_state::ViewState;
use antumbra::gpu::device::device_descriptor;
use antumbra::{AdapterChoice, Spec};
use eframe::egui;
use eframe::egui_wgpu::{WgpuConfiguration, WgpuSetup, WgpuSetupCreateNew};
use std::collections::VecDeque;
use std::io::{BufRead, Write};
use std::sync::{Arc, Mutex, PoisonError};

/// Options of the viewer.
#[derive(Default)]
pub struct Options {
    /// Opens a scene, named as on the command line.
    pub scene: Option<String>,
    /// Up to two techniques.
    pub specs: Vec<Spec>,
    /// Graphics adapter.
    pub adapter: AdapterChoice,
    /// Size of the window in points.
    pub size: Option<[u32; 2]>,
    /// Takes [commands](crate::commands) from stdin and answers on stdout.
    pub commands: bool,
}

/// The window cannot be opened, with the reason.
#[derive(Debug, thiserror::Error)]
#[error("the window cannot be opened: {0}")]
pub struct WindowError(String);

/// Opens the window and returns when it is closed. Has to be called on the program's first thread.
pub fn run(options: Options) -> Result<(), WindowError> {
    let commands = Arc::new(Mutex::new(VecDeque::new()));
    let waker: Arc<Mutex<Option<egui::Context>>> = Arc::default();
    if options.commands {
        listen(commands.clone(), waker.clone());
    }
    jobs::leave_panics_of_jobs_to_their_owners();
    let scene = options.scene.unwrap_or_else(|| crate::FIRST_SCENE.to_owned());
    let keep: SharedState = Arc::new(Mutex::new(Some(PersistentState {
        view_state: ViewState::new(&options.specs),
        first: Some(Source::Argument(scene)),
        commands,
        faults: Arc::default(),
        lost: 0,
        again: false,
    })));
    loop {
        let (kept, woken) = (keep.clone(), waker.clone());
        let native = native_options(&options.adapter, options.size);
        let creator = Box::new(move |context: &eframe::CreationContext| {
            if let Ok(mut waker) = woken.lock() {
                *waker = Some(context.egui_ctx.clone());
            }
            App::new(context, kept).map(|app| Box::new(app) as Box<dyn eframe::App>).map_err(Into::into)
        });
        eframe::run_native("antumbra", native, creator).map_err(|e| WindowError(e.to_string()))?;
        let mut kept = keep.lock().unwrap_or_else(PoisonError::into_inner);
        match kept.as_mut().filter(|k| k.again) {
            Some(kept) => kept.again = false,
            None => return Ok(()),
        }
    }
}

/// Closes this window so that another opens on a new device.
pub fn restart(ctx: &egui::Context) {
    ctx.send_viewport_cmd(egui::ViewportCommand::Close);
}

fn native_options(adapter: &AdapterChoice, size: Option<[u32; 2]>) -> eframe::NativeOptions {
    let choice = adapter.clone();
    let setup = WgpuSetupCreateNew {
        native_adapter_selector: Some(Arc::new(move |adapters, surface| {
            let suits = |a: &wgpu::Adapter| surface.is_none_or(|s| a.is_surface_supported(s));
            choice.of(adapters, suits).map_err(|e| e.to_string())
        })),
        device_descriptor: Arc::new(device_descriptor),
        ..WgpuSetupCreateNew::without_display_handle()
    };
    let [width, height] = size.unwrap_or([1440, 900]).map(|s| s as f32);
    eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_title("Antumbra")
            .with_inner_size([width, height])
            .with_min_inner_size([360.0, 240.0])
            .with_icon(icon())
            .with_drag_and_drop(true),
        wgpu_options: WgpuConfiguration { wgpu_setup: WgpuSetup::CreateNew(setup), ..Default::default() },
        // Dithering would look like noise of the technique.
        dithering: false,
        ..Default::default()
    }
}

/// The icon: a ball in front of a light, with its antumbra.
fn icon() -> egui::IconData {
    const SIDE: usize = 64;
    let at = |i: usize| (i as f32 + 0.5) / SIDE as f32 * 2.0 - 1.0;
    let pixel = |i: usize| {
        let (x, y) = (at(i % SIDE), at(i / SIDE));
        let distance = x.hypot(y);
        let glow = (1.0 - (distance - 0.62).abs() / 0.3).clamp(0.0, 1.0);
        let light = [255.0, 196.0, 84.0].map(|c| (c * glow) as u8);
        let alpha = ((0.98 - distance) * 24.0).clamp(0.0, 1.0);
        [light[0], light[1], light[2], (255.0 * alpha) as u8]
    };
    egui::IconData { rgba: (0..SIDE * SIDE).flat_map(pixel).collect(), width: SIDE as u32, height: SIDE as u32 }
}

/// Reads commands from stdin until its end.
fn listen(commands: Arc<Mutex<VecDeque<PendingCommand>>>, waker: Arc<Mutex<Option<egui::Context>>>) {
    std::thread::spawn(move || {
        for line in std::io::stdin().lock().lines().map_while(Result::ok).filter(|l| !l.trim().is_empty()) {
            match serde_json::from_str(&line) {
                Ok(command) => {
                    let answer = Box::new(|answer: Reply| say(&answer));
                    if let Ok(mut queue) = commands.lock() {
                        queue.push_back(PendingCommand { command, answer });
                    }
                }
                Err(error) => say(&Reply { error: Some(format!("{line}: {error}")), state: None }),
            }
            if let Some(ctx) = waker.lock().ok().and_then(|w| w.clone()) {
                ctx.request_repaint();
            }
        }
    });
}

fn say(answer: &Reply) {
    let text = serde_json::to_string(answer).unwrap_or_else(|e| format!("{{\"error\":\"{e}\"}}"));
    // The receiver may be gone.
    let _ = writeln!(std::io::stdout().lock(), "{text}");
}
