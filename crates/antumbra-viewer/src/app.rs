//! The viewer's program: events, commands, saving, lost devices.

use crate::commands::{Command, Reply, State, apply};
use crate::open::{Chosen, EXTENSIONS, Source};
use crate::save::{self, Saving};
use crate::session::Session;
use crate::ui::{self, Save, UiActions, UiState};
use crate::view_state::ViewState;
use crate::{here, light};
use antumbra::Gpu;
use antumbra::techniques::TECHNIQUES;
use eframe::egui;
use eframe::egui_wgpu::RenderState;
use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::sync::{Arc, Mutex};
use web_time::{Duration, Instant};

/// State that outlives a lost device.
pub struct PersistentState {
    /// What the user has chosen.
    pub view_state: ViewState,
    /// The scene to open first.
    pub first: Option<Source>,
    /// Queued commands.
    pub commands: Arc<Mutex<VecDeque<PendingCommand>>>,
    /// Unexpected GPU errors.
    pub faults: Arc<Mutex<Vec<String>>>,
    /// Number of lost devices.
    pub lost: u32,
    /// True if the window opens again.
    pub again: bool,
}

/// A command with its reply function.
pub struct PendingCommand {
    /// The command.
    pub command: Command,
    /// Receives the reply.
    pub answer: Box<dyn FnOnce(Reply) + Send>,
}

/// Slot for the persistent state while no app holds it.
pub type SharedState = Arc<Mutex<Option<PersistentState>>>;

/// The program.
pub struct App {
    kept: PersistentState,
    keep: SharedState,
    session: Session,
    memory: UiState,
    render: RenderState,
    lost: Arc<AtomicBool>,
    dropped: Vec<egui::DroppedFileHandle>,
    saving: Option<(Saving, Vec<Vec<u8>>)>,
    screenshot: Option<Screenshot>,
    /// Number of idle frames in a row.
    idle: u32,
    /// The open file dialog.
    choosing: Option<Receiver<Chosen>>,
    /// Time of the last frame and the longest time between two, during [`Command::Watch`].
    watched: Option<(Instant, Duration)>,
}

type ReplyTo = Box<dyn FnOnce(Reply) + Send>;

/// A pending screenshot, its path, and its reply function.
type Screenshot = (Receiver<Arc<egui::ColorImage>>, Option<PathBuf>, Option<ReplyTo>);

impl App {
    /// An app on eframe's device.
    pub fn new(context: &eframe::CreationContext, keep: SharedState) -> Result<App, String> {
        let kept = keep.lock().ok().and_then(|mut k| k.take()).ok_or("the viewer is open already")?;
        let render =
            context.wgpu_render_state.clone().ok_or("there is no graphics adapter that draws to this window")?;
        let gpu = Gpu::from_host(render.device.clone(), render.queue.clone());
        ui::style::apply(&context.egui_ctx);
        let lost = Arc::new(AtomicBool::new(false));
        watch(&gpu, &context.egui_ctx, &kept, &lost);
        let session = Session::new(gpu, context.egui_ctx.clone()).map_err(|e| e.to_string())?;
        let mut app = App {
            kept,
            keep,
            session,
            memory: UiState::default(),
            render,
            lost,
            dropped: Vec::new(),
            saving: None,
            screenshot: None,
            idle: 0,
            choosing: None,
            watched: None,
        };
        let source = app.kept.first.take().or_else(|| app.kept.view_state.open.clone().map(Source::Again));
        if let Some(source) = source {
            app.session.open(source);
        }
        if app.kept.lost > 0 {
            app.memory.notices.done("The graphics device was lost; everything was set up again.");
        }
        Ok(app)
    }

    /// True once the device is lost. A poll delivers the callback.
    fn is_lost(&self) -> bool {
        // The callback sets the flag.
        let _ = self.session.gpu.device.poll(wgpu::PollType::Poll);
        self.lost.load(Ordering::Relaxed)
    }

    /// Asks for the [`State`].
    fn state(&self, pixels_per_point: f32) -> State {
        let (view_state, session) = (&self.kept.view_state, &self.session);
        let halves = &session.halves;
        let handles = self
            .memory
            .area
            .map_or_else(Vec::new, |area| light::handles(&view_state.light, &ui::screen(view_state, area)));
        let error = |h: &crate::session::Half| h.measured.metrics.as_ref()?.as_ref().ok().map(|f| f.average_error);
        State {
            scene: view_state.open.as_ref().filter(|_| session.loaded.is_some()).map(|o| o.source.clone()),
            drawn: [0, 1].map(|i| halves[i].made.as_ref().map(|m| m.0.text())),
            failed: [0, 1].map(|i| halves[i].failed.as_ref().map(|f| f.1.clone())),
            average_error: [0, 1].map(|i| error(&halves[i])),
            errors: self.memory.notices.errors().map(str::to_owned).collect(),
            faults: self.kept.faults.lock().map_or_else(|_| Vec::new(), |f| f.clone()),
            frames: session.drawn,
            lost: self.kept.lost,
            image: session.targets.as_ref().map(|c| c.size),
            debug_views: [0, 1].map(|i| {
                let made = halves[i].made.iter();
                made.flat_map(|m| m.1.debug_views()).map(|p| p.name).collect()
            }),
            camera: (view_state.camera.eye.to_array(), view_state.camera.target.to_array()),
            light: (view_state.light.center.to_array(), view_state.light.size.to_array()),
            handles: handles.into_iter().map(|(h, p)| (format!("{h:?}"), (p * pixels_per_point).to_array())).collect(),
            truth: session.truth.as_ref().and_then(|t| t.image.lock().ok().map(|p| p.done())),
            truth_says: session.truth.as_ref().map(|t| t.progress().to_string()),
            milliseconds: [0, 1].map(|i| halves[i].times.median_total()),
            longest_frame: self.watched.map(|(_, longest)| 1000.0 * longest.as_secs_f64()),
            refused: TECHNIQUES
                .iter()
                .filter_map(|t| Some((t.name, t.check(&session.gpu).err()?.to_string())))
                .collect(),
        }
    }

    /// Runs queued commands in order; a waiting command blocks those after it.
    fn run_commands(&mut self, ctx: &egui::Context) {
        let is_idle = self.session.is_idle(&self.kept.view_state) && self.saving.is_none();
        self.idle = if is_idle { self.idle + 1 } else { 0 };
        while self.screenshot.is_none() {
            let Some(next) = self.kept.commands.lock().ok().and_then(|mut q| q.pop_front()) else { return };
            if matches!(next.command, Command::Wait) && self.idle < 3 {
                ctx.request_repaint_after(std::time::Duration::from_millis(20));
                if let Ok(mut queue) = self.kept.commands.lock() {
                    queue.push_front(next);
                }
                return;
            }
            self.idle = 0;
            self.run_command(ctx, next);
            ctx.request_repaint();
        }
    }

    fn run_command(&mut self, ctx: &egui::Context, asked: PendingCommand) {
        let mut answer = Reply::default();
        match apply(asked.command, &mut self.kept.view_state) {
            Err(error) => answer.error = Some(error),
            Ok(None | Some(Command::Wait)) => {}
            Ok(Some(Command::Open(source))) => self.session.open(Source::Argument(source)),
            Ok(Some(Command::Drop(path))) => self.dropped.push(here::dropped(path)),
            Ok(Some(Command::State)) => answer.state = Some(self.state(ctx.pixels_per_point())),
            Ok(Some(Command::Choose)) => self.choose_files(ctx),
            Ok(Some(Command::Watch(watch))) => self.watched = watch.then(|| (Instant::now(), Duration::ZERO)),
            Ok(Some(Command::Dismiss)) => self.memory.notices.clear(),
            Ok(Some(Command::LoseDevice)) => self.session.gpu.device.destroy(),
            Ok(Some(Command::Zoom(zoom))) => ctx.set_zoom_factor(zoom.clamp(0.3, 4.0)),
            Ok(Some(Command::Close)) => ctx.send_viewport_cmd(egui::ViewportCommand::Close),
            Ok(Some(Command::SaveScene(path))) => {
                let text = save::scene_text(&self.kept.view_state, &self.session);
                answer.error = text.and_then(|t| here::write(&path, t.as_bytes())).err();
            }
            Ok(Some(Command::Screenshot(path))) => {
                self.take_screenshot(ctx, Some(path), Some(asked.answer));
                return;
            }
            Ok(Some(other)) => answer.error = Some(format!("{other:?} changes nothing")),
        }
        (asked.answer)(answer);
    }

    fn take_screenshot(&mut self, ctx: &egui::Context, path: Option<PathBuf>, answer: Option<ReplyTo>) {
        let (send, receive) = channel();
        let woken = ctx.clone();
        ctx.request_screenshot(move |image| {
            // The window may have closed.
            let _ = send.send(image);
            woken.request_repaint();
        });
        self.screenshot = Some((receive, path, answer));
    }

    /// Writes a screenshot and a saved image once they have arrived.
    fn finish_saving(&mut self, ctx: &egui::Context) {
        if let Some(image) = self.screenshot.as_ref().and_then(|(receive, ..)| receive.try_recv().ok()) {
            let (_, path, answer) = self.screenshot.take().unwrap_or_else(|| unreachable!("just looked at"));
            let rgba: Vec<u8> = image.pixels.iter().flat_map(|p| p.to_array()).collect();
            let size = [image.size[0] as u32, image.size[1] as u32];
            let png = crate::export::png(size, &rgba).map_err(|e| e.to_string());
            let kept = png.and_then(|png| match path {
                Some(path) => here::write(&path, &png),
                None => here::keep("antumbra-window", "png", &png),
            });
            match answer {
                Some(answer) => answer(Reply { error: kept.err(), state: None }),
                None => self.say_kept(kept),
            }
        } else if self.screenshot.is_some() {
            ctx.request_repaint();
        }
        let saved = self.saving.as_mut().and_then(|(saving, parts)| saving.poll(parts));
        if let Some(png) = saved {
            self.saving = None;
            self.say_kept(png.and_then(|png| here::keep("antumbra", "png", &png)));
        } else if self.saving.is_some() {
            ctx.request_repaint();
        }
    }

    fn say_kept(&mut self, kept: Result<String, String>) {
        match kept {
            Ok(place) => self.memory.notices.done(format!("saved {place}")),
            Err(error) => self.memory.notices.error(error),
        }
    }

    fn apply_actions(&mut self, ctx: &egui::Context, actions: UiActions) {
        if let Some(source) = actions.open {
            self.session.open(source);
        }
        if actions.choose {
            self.choose_files(ctx);
        }
        let view_state = &self.kept.view_state;
        match actions.save {
            None => {}
            Some(Save::Image) => {
                self.saving = Saving::start(view_state, &self.session).map(|saving| (saving, Vec::new()));
            }
            Some(Save::Window) => self.take_screenshot(ctx, None, None),
            Some(Save::Scene) => {
                let kept = save::scene_text(view_state, &self.session)
                    .and_then(|text| here::keep("antumbra-scene", "toml", text.as_bytes()));
                self.say_kept(kept);
            }
            Some(Save::Spec(half)) => {
                let text = view_state.choices[half].text();
                ctx.copy_text(text.clone());
                self.memory.notices.done(format!("copied: {text}"));
            }
            Some(Save::Command(half)) => self.copy_command(ctx, half),
        }
    }

    /// The command line that draws the same image, from a new scene file if camera or light were moved.
    fn copy_command(&mut self, ctx: &egui::Context, half: usize) {
        let view_state = &self.kept.view_state;
        let (Some(open), Some(targets)) = (&view_state.open, &self.session.targets) else { return };
        let scene = if view_state.is_as_opened() {
            Ok(open.source.clone())
        } else {
            save::scene_text(view_state, &self.session)
                .and_then(|text| here::keep("antumbra-scene", "toml", text.as_bytes()))
        };
        match scene {
            Ok(scene) => {
                let command = crate::export::command(&scene, &view_state.choices[half].text(), targets.size);
                ctx.copy_text(command.clone());
                self.memory.notices.done(format!("copied: {command}"));
            }
            Err(error) => self.memory.notices.error(error),
        }
    }

    /// Opens the file dialog. A page never learns whether its browser opened one, so it may ask again.
    fn choose_files(&mut self, ctx: &egui::Context) {
        if self.choosing.is_none() || cfg!(target_arch = "wasm32") {
            let woken = ctx.clone();
            self.choosing = Some(here::choose_files(&EXTENSIONS, move || woken.request_repaint()));
        } else {
            self.memory.notices.done("the file dialog is open already, maybe behind this window");
        }
    }

    /// Opens the files that were chosen in the file dialog.
    fn take_chosen(&mut self) {
        let Some(chosen) = self.choosing.as_ref().map(Receiver::try_recv) else { return };
        match chosen {
            Err(TryRecvError::Empty) => return,
            Ok(Ok(files)) if !files.is_empty() => self.session.open(Source::Dropped(files)),
            // The dialog was closed.
            Ok(Ok(_)) | Err(TryRecvError::Disconnected) => {}
            Ok(Err(why)) => self.memory.notices.error(why),
        }
        self.choosing = None;
    }

    /// Measures the time of the last frame during [`Command::Watch`].
    fn watch(&mut self, ctx: &egui::Context) {
        if let Some((last, longest)) = &mut self.watched {
            *longest = (*longest).max(last.elapsed());
            *last = Instant::now();
            ctx.request_repaint();
        }
    }

    /// Opens files that were dropped on the window.
    fn take_dropped(&mut self, ctx: &egui::Context) {
        let files = ctx.input(|i| i.raw.dropped_files.clone());
        if !files.is_empty() {
            self.session.open(Source::Dropped(files));
        }
    }
}

impl eframe::App for App {
    fn raw_input_hook(&mut self, _ctx: &egui::Context, input: &mut egui::RawInput) {
        input.dropped_files.append(&mut self.dropped);
    }

    fn logic(&mut self, ctx: &egui::Context, _frame: &mut eframe::Frame) {
        if self.is_lost() {
            here::restart(ctx);
            return;
        }
        for message in self.session.work(&mut self.kept.view_state) {
            if message != "cancelled" {
                self.memory.notices.error(message);
            }
        }
        self.watch(ctx);
        self.take_chosen();
        self.run_commands(ctx);
    }

    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        if self.is_lost() {
            return;
        }
        let ctx = ui.ctx().clone();
        self.take_dropped(&ctx);
        let actions = ui::show(ui, &self.render, &mut self.kept.view_state, &mut self.session, &mut self.memory);
        self.apply_actions(&ctx, actions);
        self.finish_saving(&ctx);
        let faults: Vec<String> = self.kept.faults.lock().map_or_else(|_| Vec::new(), |f| f.clone());
        for fault in faults.iter().skip(self.memory.faults_shown) {
            self.memory.notices.error(fault.as_str());
        }
        self.memory.faults_shown = faults.len();
        if self.is_lost() {
            // egui's renderer panics without a device: give it nothing to draw.
            ctx.graphics_mut(|layers| *layers = Default::default());
            ctx.request_repaint();
        }
    }
}

impl Drop for App {
    /// Returns the persistent state.
    fn drop(&mut self) {
        let lost = self.is_lost();
        let outlives = PersistentState {
            view_state: self.kept.view_state.clone(),
            first: None,
            commands: self.kept.commands.clone(),
            faults: self.kept.faults.clone(),
            lost: self.kept.lost + u32::from(lost),
            again: lost,
        };
        if let Ok(mut keep) = self.keep.lock() {
            *keep = Some(outlives);
        }
    }
}

/// Collects uncaptured errors, and records a lost device.
fn watch(gpu: &Gpu, ctx: &egui::Context, kept: &PersistentState, lost: &Arc<AtomicBool>) {
    let (flag, woken) = (lost.clone(), ctx.clone());
    gpu.device.set_device_lost_callback(move |_, _| {
        flag.store(true, Ordering::Relaxed);
        woken.request_repaint();
    });
    let (faults, lost, woken) = (kept.faults.clone(), lost.clone(), ctx.clone());
    gpu.device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
        // Errors after the loss of the device are expected.
        if !lost.load(Ordering::Relaxed)
            && let Ok(mut faults) = faults.lock()
        {
            faults.push(format!("GPU error, which is a bug in antumbra: {error}"));
        }
        woken.request_repaint();
    }));
}
