//! The viewer's work: jobs, drawing, truth and metrics.

use crate::choice::Choice;
use crate::inspector::Inspector;
use crate::job::Job;
use crate::loaded_scene::LoadedScene;
use crate::metrics::Measured;
use crate::open::{self, Source};
use crate::render_targets::RenderTargets;
use crate::show::{Show, Shown};
use crate::times::Times;
use crate::truth::{Lazy, Question, Truth};
use crate::view_state::{Compare, OpenScene, ViewState};
use antumbra::{Error, Gpu, Shadows, Timer, View};
use eframe::egui;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use web_time::{Duration, Instant};

/// Frames drawn after the last change, for techniques that converge over several frames.
const SETTLING: u32 = 4;
/// Pause after the last change before the truth is traced again.
const REST: Duration = Duration::from_millis(300);
/// Rotation of occluders, radians per second.
const TURNING: f32 = 0.5;

/// The technique of a half.
pub struct Half {
    /// The technique that is drawn, with its choice.
    pub made: Option<(Choice, Shadows)>,
    /// The job that compiles the next one.
    pub making: Option<(Choice, Making)>,
    /// The choice that failed, with its error.
    pub failed: Option<(Choice, String)>,
    /// Times of its passes.
    pub times: Times,
    /// Its metrics.
    pub measured: Measured,
    timer: Timer,
    /// Debug capture: its state, and the job that compiles for it.
    captured: bool,
    preparing: Option<Job<Result<(), Error>>>,
}

type Making = Job<Result<Shadows, Error>>;

/// Everything that depends on the device.
pub struct Session {
    /// The device.
    pub gpu: Gpu,
    /// The loaded scene.
    pub loaded: Option<LoadedScene>,
    /// Render targets.
    pub targets: Option<RenderTargets>,
    /// Left and right.
    pub halves: [Half; 2],
    /// Draws debug views.
    pub inspector: Inspector,
    /// A scene that is being opened.
    pub opening: Option<Job<Result<(OpenScene, LoadedScene), String>>>,
    /// The truth in progress.
    pub truth: Option<Truth>,
    /// Number of drawn frames.
    pub drawn: u64,
    /// Number of the current render targets; it changes with their size.
    pub resized: u64,
    shown: Shown,
    tracer: Option<(u64, Arc<Lazy>)>,
    /// Number of started truths.
    truths: u64,
    /// The uploaded truth, its number of rows, and whether the right half shows it.
    truth_written: Option<(Option<(u64, u64)>, bool)>,
    poses: u64,
    last: Option<Wanted>,
    changed: Instant,
    last_frame: Instant,
    left_to_draw: u32,
    busy: Arc<AtomicBool>,
    ctx: egui::Context,
}

/// The inputs of a frame.
#[derive(Clone, PartialEq)]
struct Wanted {
    view: View,
    light: antumbra::RectLight,
    size: [u32; 2],
    pose: u64,
    choices: [Option<Choice>; 2],
    compare: Compare,
    show: Show,
    captured: [bool; 2],
}

impl Session {
    /// A session on a new device.
    pub fn new(gpu: Gpu, ctx: egui::Context) -> Result<Session, Error> {
        let half = || {
            Ok::<_, Error>(Half {
                made: None,
                making: None,
                failed: None,
                times: Times::default(),
                measured: Measured::default(),
                timer: Timer::new(&gpu)?,
                captured: false,
                preparing: None,
            })
        };
        let now = Instant::now();
        Ok(Session {
            halves: [half()?, half()?],
            shown: Shown::new(&gpu),
            inspector: Inspector::new(&gpu),
            loaded: None,
            targets: None,
            opening: None,
            truth: None,
            drawn: 0,
            resized: 0,
            tracer: None,
            truths: 0,
            truth_written: None,
            poses: 0,
            last: None,
            changed: now,
            last_frame: now,
            left_to_draw: 0,
            busy: Arc::default(),
            ctx,
            gpu,
        })
    }

    /// Opens a scene in the background; the current one stays until then.
    pub fn open(&mut self, source: Source) {
        self.poses += 1;
        self.opening = Some(open::start(&self.gpu, source, self.poses, self.waker()));
    }

    /// A function that wakes the window from any thread.
    pub fn waker(&self) -> impl Fn() + Clone + Send + 'static {
        let ctx = self.ctx.clone();
        move || ctx.request_repaint()
    }

    /// Takes results of jobs and starts needed ones. Returns messages for the user.
    pub fn work(&mut self, view_state: &mut ViewState) -> Vec<String> {
        let mut messages = Vec::new();
        if let Some(result) = self.opening.as_ref().and_then(Job::poll) {
            self.opening = None;
            match result.map_err(|died| died.to_string()).and_then(|r| r) {
                Ok((open, loaded)) => {
                    view_state.take_unless_open(open);
                    self.take(loaded);
                }
                Err(message) => messages.push(message),
            }
        }
        if let Some(loaded) = &self.loaded {
            for (i, half) in self.halves.iter_mut().enumerate().take(view_state.techniques()) {
                half.work(&self.gpu, loaded, &view_state.choices[i], &self.ctx);
                half.set_debug_capture(view_state.shows_debug_views(i), &self.gpu, loaded, &self.ctx);
            }
        }
        messages
    }

    fn take(&mut self, loaded: LoadedScene) {
        self.loaded = Some(loaded);
        (self.targets, self.truth, self.tracer, self.truth_written) = (None, None, None, None);
        for half in &mut self.halves {
            half.times = Times::default();
            half.measured = Measured::default();
            // An error of the last scene says nothing about this one.
            half.failed = None;
        }
        self.last = None;
    }

    /// Draws the images after a change, `size` pixels each. True if drawn.
    pub fn draw(&mut self, view_state: &mut ViewState, size: [u32; 2]) -> Result<bool, Error> {
        self.turn(view_state);
        let Some(loaded) = &mut self.loaded else { return Ok(false) };
        if size.contains(&0) {
            return Ok(false);
        }
        if self.targets.as_ref().is_none_or(|c| c.size != size) {
            let targets = RenderTargets::new(&self.gpu, &loaded.scene, loaded.casters(), size)?;
            // Fully lit until a technique is compiled.
            let lit = vec![1.0; size[0] as usize * size[1] as usize];
            targets.halves.iter().for_each(|half| half.write_visibility(&self.gpu, &lit));
            self.targets = Some(targets);
            self.resized += 1;
            self.truth_written = None;
        }
        let view = View::of_camera(&view_state.camera, size);
        let wanted = Wanted {
            view,
            light: view_state.light,
            size,
            pose: loaded.pose,
            choices: [0, 1].map(|i| self.halves[i].made.as_ref().map(|m| m.0.clone())),
            compare: view_state.compare,
            show: view_state.show,
            captured: [0, 1].map(|i| self.halves[i].captured),
        };
        if self.last.as_ref() != Some(&wanted) {
            let of = |l: &Wanted| Wanted { show: l.show, captured: l.captured, ..wanted.clone() };
            let only_shown = self.last.as_ref().is_some_and(|l| of(l) == *l);
            if !only_shown {
                self.changed = Instant::now();
            }
            (self.last, self.left_to_draw) = (Some(wanted), SETTLING);
        }
        let truth_is_new = self.write_truth(view_state);
        if truth_is_new {
            self.left_to_draw = self.left_to_draw.max(1);
        }
        if self.left_to_draw == 0 && !view_state.keeps_drawing {
            return Ok(false);
        }
        if self.busy.load(Ordering::Relaxed) {
            // The GPU is still busy: more work in its queue would slow the controls.
            self.ctx.request_repaint_after(Duration::from_millis(4));
            return Ok(false);
        }
        self.left_to_draw = self.left_to_draw.saturating_sub(1);
        self.draw_now(view_state, view)?;
        self.ctx.request_repaint();
        Ok(true)
    }

    fn draw_now(&mut self, view_state: &ViewState, view: View) -> Result<(), Error> {
        let waker = self.waker();
        let (Some(loaded), Some(targets)) = (&mut self.loaded, &mut self.targets) else { return Ok(()) };
        let gpu = &self.gpu;
        let frustum = loaded.frustum(view, view_state.light, waker);
        targets.update(loaded, view, view_state.light, frustum);
        targets.record_geometry(gpu, &loaded.casters(), &view)?;
        let count = if view_state.compare == Compare::One { 1 } else { 2 };
        for (i, drawn) in targets.halves.iter_mut().enumerate().take(count) {
            let half = &mut self.halves[i];
            let is_truth = i == 1 && view_state.compare == Compare::Truth;
            let technique = half.made.as_mut().filter(|_| !is_truth).map(|m| &mut m.1);
            // The truth has no error: show its visibility.
            let show = if is_truth && view_state.show == Show::Error { Show::Visibility } else { view_state.show };
            let shown = (&self.shown, show, &targets.truth);
            if let Err(error) = drawn.draw(gpu, &mut half.timer, technique, &targets.geometry, shown) {
                half.fail(&error);
            }
            if let Some(times) = half.timer.poll(gpu) {
                half.times.push(&times);
            }
            half.measured.outdated();
        }
        self.drawn += 1;
        self.busy.store(true, Ordering::Relaxed);
        let busy = self.busy.clone();
        gpu.queue.on_submitted_work_done(move || busy.store(false, Ordering::Relaxed));
        Ok(())
    }

    /// Turns the occluders by the elapsed time.
    fn turn(&mut self, view_state: &mut ViewState) {
        let now = Instant::now();
        let passed = (now - self.last_frame).as_secs_f32().min(0.1);
        self.last_frame = now;
        if view_state.turning {
            view_state.angle = (view_state.angle + TURNING * passed) % std::f32::consts::TAU;
            self.ctx.request_repaint();
        }
        if let Some(loaded) = &mut self.loaded {
            self.poses += 1;
            loaded.turn_occluders(&self.gpu, view_state.angle, self.poses);
        }
    }

    /// Starts, refines and drops the truth.
    pub fn trace(&mut self, view_state: &ViewState, size: [u32; 2]) {
        let Some(loaded) = &self.loaded else { return };
        let question = Question { camera: view_state.camera, light: view_state.light, size, pose: loaded.pose };
        if self.truth.as_ref().is_some_and(|t| t.question != question) {
            self.truth = None;
        }
        if self.truth.is_none() && view_state.wants_truth() && !size.contains(&0) {
            let rested = self.changed.elapsed();
            if rested < REST || view_state.turning {
                self.ctx.request_repaint_after(REST.saturating_sub(rested));
                return;
            }
            let known = self.tracer.take().filter(|(pose, _)| *pose == loaded.pose);
            let (pose, tracer) = known.unwrap_or_else(|| (loaded.pose, Arc::new(Lazy::new(loaded.posed()))));
            let ctx = self.ctx.clone();
            let wake = move || ctx.request_repaint_after(Duration::from_millis(100));
            self.truths += 1;
            self.truth = Some(Truth::start(question, tracer.clone(), wake));
            self.tracer = Some((pose, tracer));
        }
        if self.truth.as_ref().is_some_and(|t| !t.is_over()) {
            self.ctx.request_repaint_after(Duration::from_millis(250));
        }
    }

    /// Uploads new rows of the truth, and drops an outdated truth. True if that changes the
    /// display.
    fn write_truth(&mut self, view_state: &ViewState) -> bool {
        let Some(targets) = &self.targets else { return false };
        let is_shown = view_state.compare == Compare::Truth;
        let image = self.truth.as_ref().and_then(|t| t.image.lock().ok());
        let image = image.filter(|p| p.size == targets.size && p.version > 0);
        let now = (image.as_ref().map(|p| (self.truths, p.version)), is_shown);
        if self.truth_written == Some(now) {
            return false;
        }
        match &image {
            Some(image) => targets.write_truth(&self.gpu, image),
            None => targets.forget_truth(&self.gpu),
        }
        if is_shown {
            // Fully lit where no row has arrived.
            let lit = || vec![1.0; targets.size[0] as usize * targets.size[1] as usize];
            let values = image.as_ref().map_or_else(lit, |p| p.visibility.clone());
            targets.halves[1].write_visibility(&self.gpu, &values);
        }
        self.truth_written = Some(now);
        true
    }

    /// Starts measuring and takes results.
    pub fn measure(&mut self, view_state: &ViewState) {
        let (Some(targets), Some(truth)) = (&self.targets, &self.truth) else { return };
        let waker = self.waker();
        for (i, half) in self.halves.iter_mut().enumerate().take(view_state.techniques()) {
            if half.made.is_some() {
                half.measured.work(&self.gpu, &targets.halves[i].visibility, truth, waker.clone());
            }
        }
    }

    /// True if no work is pending: no loading, compiling, drawing, tracing or measuring.
    pub fn is_idle(&self, view_state: &ViewState) -> bool {
        let ready = |i: usize| {
            let half = &self.halves[i];
            half.is_settled(&view_state.choices[i])
                && (half.made.is_none() || half.captured == view_state.shows_debug_views(i))
        };
        let drawn = self.left_to_draw == 0 && self.loaded.is_some() && self.last.is_some();
        let traced = !view_state.wants_truth() || self.truth.as_ref().is_some_and(Truth::is_over);
        let measured = !view_state.wants_truth()
            || self.halves.iter().take(view_state.techniques()).all(|h| h.measured.is_current());
        let made = (0..view_state.techniques()).all(ready);
        self.opening.is_none() && drawn && made && traced && measured
    }
}

impl Half {
    /// Starts making the chosen technique, unless it exists, is being made, or has failed.
    fn work(&mut self, gpu: &Gpu, loaded: &LoadedScene, choice: &Choice, ctx: &egui::Context) {
        if let Some((of, result)) = self.making.as_ref().and_then(|(c, job)| Some((c.clone(), job.poll()?))) {
            self.making = None;
            match result {
                Ok(Ok(technique)) => {
                    (self.made, self.failed) = (Some((of, technique)), None);
                    (self.captured, self.preparing) = (false, None);
                    self.times = Times::default();
                    // Pending times belong to the last technique.
                    if let Ok(timer) = Timer::new(gpu) {
                        self.timer = timer;
                    }
                }
                Ok(Err(error)) => self.failed = Some((of, error.to_string())),
                Err(died) => self.failed = Some((of, died.to_string())),
            }
        }
        if self.is_settled(choice) || self.making.as_ref().is_some_and(|(c, _)| c == choice) {
            return;
        }
        let (gpu, spec, ctx) = (gpu.clone(), choice.spec(), ctx.clone());
        let (scene, casters) = (loaded.scene.clone(), loaded.casters());
        let title = format!("Compiling {}", choice.technique.title);
        let job = Job::start(
            title,
            move || ctx.request_repaint(),
            move |_| async move { LoadedScene::technique(&gpu, &scene, casters, &spec).await },
        );
        self.making = Some((choice.clone(), job));
    }

    /// Switches debug capture, on once its pipelines are compiled.
    fn set_debug_capture(&mut self, wanted: bool, gpu: &Gpu, loaded: &LoadedScene, ctx: &egui::Context) {
        let Some((choice, technique)) = self.made.as_mut().filter(|_| self.captured != wanted) else { return };
        if !wanted {
            technique.set_debug_capture(false);
            (self.captured, self.preparing) = (false, None);
            return;
        }
        if let Some(result) = self.preparing.as_ref().and_then(Job::poll) {
            // Debug capture that does not fit is left out; other debug views remain.
            technique.set_debug_capture(matches!(result, Ok(Ok(()))));
            (self.captured, self.preparing) = (true, None);
        } else if self.preparing.is_none() {
            let (gpu, spec, ctx) = (gpu.clone(), choice.spec(), ctx.clone());
            let (scene, casters) = (loaded.scene.clone(), loaded.casters());
            self.preparing = Some(Job::start(
                "Debug views",
                move || ctx.request_repaint(),
                move |_| async move { LoadedScene::compile(&gpu, &scene, casters, &spec, true).await },
            ));
        }
    }

    /// True if the choice is drawn or has failed.
    pub fn is_settled(&self, choice: &Choice) -> bool {
        let fails = self.failed.as_ref().is_some_and(|f| f.0 == *choice);
        fails || self.made.as_ref().is_some_and(|m| m.0 == *choice)
    }

    fn fail(&mut self, error: &Error) {
        if let Some((choice, _)) = self.made.take() {
            self.failed = Some((choice, error.to_string()));
        }
    }
}
