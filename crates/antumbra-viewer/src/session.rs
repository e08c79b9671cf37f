//! What goes on beside the controls: work in the background, drawing, truth and figures.

use crate::choice::Choice;
use crate::desk::{Compare, Desk, Open};
use crate::figures::Measured;
use crate::inspect::Inspector;
use crate::job::Job;
use crate::open::{self, Source};
use crate::show::{Show, Shown};
use crate::stage::{Canvas, Stage};
use crate::times::Times;
use crate::truth::{Lazy, Question, Truth};
use antumbra::{Error, Gpu, Shadows, Timer, View};
use eframe::egui;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use web_time::{Duration, Instant};

/// Frames that are drawn after the last change, for techniques that take several to come to rest.
const SETTLING: u32 = 4;
/// How long everything rests before the truth is traced anew.
const REST: Duration = Duration::from_millis(300);
/// Radians a second of turning occluders.
const TURNING: f32 = 0.5;

/// A technique at work on one half.
pub struct Half {
    /// What is drawn, with its choice.
    pub made: Option<(Choice, Shadows)>,
    /// What is being compiled.
    pub making: Option<(Choice, Making)>,
    /// Why the chosen one cannot be drawn.
    pub failed: Option<(Choice, String)>,
    /// Times of its passes.
    pub times: Times,
    /// How far it is from the truth.
    pub measured: Measured,
    timer: Timer,
    /// Whether it keeps what only people look at, and what is being compiled for that.
    captured: bool,
    preparing: Option<Job<Result<(), Error>>>,
}

type Making = Job<Result<Shadows, Error>>;

/// All that depends on the device.
pub struct Session {
    /// The device.
    pub gpu: Gpu,
    /// The scene on it.
    pub stage: Option<Stage>,
    /// The pictures.
    pub canvas: Option<Canvas>,
    /// Left and right.
    pub halves: [Half; 2],
    /// Looks into a technique.
    pub inspector: Inspector,
    /// A scene that is being opened.
    pub opening: Option<Job<Result<(Open, Stage), String>>>,
    /// The truth as far as it is known.
    pub truth: Option<Truth>,
    /// Frames that were drawn.
    pub drawn: u64,
    /// Counts drawn sizes: the pictures are others then.
    pub resized: u64,
    shown: Shown,
    tracer: Option<(u64, Arc<Lazy>)>,
    /// Truths that were begun.
    truths: u64,
    /// Which truth is uploaded and how much of it, and whether the right half shows it.
    truth_written: Option<(Option<(u64, u64)>, bool)>,
    poses: u64,
    last: Option<Wanted>,
    changed: Instant,
    last_frame: Instant,
    left_to_draw: u32,
    busy: Arc<AtomicBool>,
    ctx: egui::Context,
}

/// Everything that a frame depends on.
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
    /// On a device that was just opened.
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
            stage: None,
            canvas: None,
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

    /// Opens a scene in the background; what is open stays until then.
    pub fn open(&mut self, source: Source) {
        self.poses += 1;
        self.opening = Some(open::start(&self.gpu, source, self.poses, self.waker()));
    }

    /// Something that wakes the window from any thread.
    pub fn waker(&self) -> impl Fn() + Clone + Send + 'static {
        let ctx = self.ctx.clone();
        move || ctx.request_repaint()
    }

    /// Takes what the background has finished and starts what is wanted. Messages for the user come back.
    pub fn work(&mut self, desk: &mut Desk) -> Vec<String> {
        let mut messages = Vec::new();
        if let Some(result) = self.opening.as_ref().and_then(Job::poll) {
            self.opening = None;
            match result.map_err(|died| died.to_string()).and_then(|r| r) {
                Ok((open, stage)) => {
                    desk.take_unless_open(open);
                    self.take(stage);
                }
                Err(message) => messages.push(message),
            }
        }
        if let Some(stage) = &self.stage {
            for (i, half) in self.halves.iter_mut().enumerate().take(desk.techniques()) {
                half.work(&self.gpu, stage, &desk.choices[i], &self.ctx);
                half.set_debug_capture(desk.shows_debug_views(i), &self.gpu, stage, &self.ctx);
            }
        }
        messages
    }

    fn take(&mut self, stage: Stage) {
        self.stage = Some(stage);
        (self.canvas, self.truth, self.tracer, self.truth_written) = (None, None, None, None);
        for half in &mut self.halves {
            half.times = Times::default();
            half.measured = Measured::default();
            // Made for other casters: techniques find out themselves, but an error of the last scene is none of this.
            half.failed = None;
        }
        self.last = None;
    }

    /// Draws the pictures if something has changed, `size` pixels each. True if it did.
    pub fn draw(&mut self, desk: &mut Desk, size: [u32; 2]) -> Result<bool, Error> {
        self.turn(desk);
        let Some(stage) = &mut self.stage else { return Ok(false) };
        if size.contains(&0) {
            return Ok(false);
        }
        if self.canvas.as_ref().is_none_or(|c| c.size != size) {
            let canvas = Canvas::new(&self.gpu, stage, size)?;
            // Without a shadow until a technique is compiled: all would be dark.
            let lit = vec![1.0; size[0] as usize * size[1] as usize];
            canvas.halves.iter().for_each(|half| half.write_visibility(&self.gpu, &lit));
            self.canvas = Some(canvas);
            self.resized += 1;
            self.truth_written = None;
        }
        let view = View::of_camera(&desk.camera, size);
        let wanted = Wanted {
            view,
            light: desk.light,
            size,
            pose: stage.pose,
            choices: [0, 1].map(|i| self.halves[i].made.as_ref().map(|m| m.0.clone())),
            compare: desk.compare,
            show: desk.show,
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
        let truth_is_new = self.write_truth(desk);
        if truth_is_new {
            self.left_to_draw = self.left_to_draw.max(1);
        }
        if self.left_to_draw == 0 && !desk.keeps_drawing {
            return Ok(false);
        }
        if self.busy.load(Ordering::Relaxed) {
            // The GPU still works on the last one: the controls stay quick if no more is piled up before it.
            self.ctx.request_repaint_after(Duration::from_millis(4));
            return Ok(false);
        }
        self.left_to_draw = self.left_to_draw.saturating_sub(1);
        self.draw_now(desk, view)?;
        self.ctx.request_repaint();
        Ok(true)
    }

    fn draw_now(&mut self, desk: &Desk, view: View) -> Result<(), Error> {
        let waker = self.waker();
        let (Some(stage), Some(canvas)) = (&mut self.stage, &mut self.canvas) else { return Ok(()) };
        let gpu = &self.gpu;
        let frustum = stage.frustum(view, desk.light, waker);
        canvas.update(gpu, stage, view, desk.light, frustum);
        canvas.record_geometry(gpu, &stage.casters(), &view)?;
        let count = if desk.compare == Compare::One { 1 } else { 2 };
        for (i, picture) in canvas.halves.iter_mut().enumerate().take(count) {
            let half = &mut self.halves[i];
            let is_truth = i == 1 && desk.compare == Compare::Truth;
            let technique = half.made.as_mut().filter(|_| !is_truth).map(|m| &mut m.1);
            // The truth has no error: what it is stands there instead.
            let show = if is_truth && desk.show == Show::Error { Show::Visibility } else { desk.show };
            let shown = (&self.shown, show, &canvas.truth);
            if let Err(error) = picture.draw(gpu, &mut half.timer, technique, &canvas.geometry, shown) {
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

    /// Turns the occluders by the time that has passed.
    fn turn(&mut self, desk: &mut Desk) {
        let now = Instant::now();
        let passed = (now - self.last_frame).as_secs_f32().min(0.1);
        self.last_frame = now;
        if desk.turning {
            desk.angle = (desk.angle + TURNING * passed) % std::f32::consts::TAU;
            self.ctx.request_repaint();
        }
        if let Some(stage) = &mut self.stage {
            self.poses += 1;
            stage.turn_occluders(&self.gpu, desk.angle, self.poses);
        }
    }

    /// Starts, refines and drops the truth.
    pub fn trace(&mut self, desk: &Desk, size: [u32; 2]) {
        let Some(stage) = &self.stage else { return };
        let question = Question { camera: desk.camera, light: desk.light, size, pose: stage.pose };
        if self.truth.as_ref().is_some_and(|t| t.question != question) {
            self.truth = None;
        }
        if self.truth.is_none() && desk.wants_truth() && !size.contains(&0) {
            let rested = self.changed.elapsed();
            if rested < REST || desk.turning {
                self.ctx.request_repaint_after(REST.saturating_sub(rested));
                return;
            }
            let known = self.tracer.take().filter(|(pose, _)| *pose == stage.pose);
            let (pose, tracer) = known.unwrap_or_else(|| (stage.pose, Arc::new(Lazy::new(stage.posed()))));
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

    /// Uploads what has come in of the truth, and takes away what was true of another view. True if that changes what is
    /// seen.
    fn write_truth(&mut self, desk: &Desk) -> bool {
        let Some(canvas) = &self.canvas else { return false };
        let is_shown = desk.compare == Compare::Truth;
        let picture = self.truth.as_ref().and_then(|t| t.picture.lock().ok());
        let picture = picture.filter(|p| p.size == canvas.size && p.version > 0);
        let now = (picture.as_ref().map(|p| (self.truths, p.version)), is_shown);
        if self.truth_written == Some(now) {
            return false;
        }
        match &picture {
            Some(picture) => canvas.write_truth(&self.gpu, picture),
            None => canvas.forget_truth(&self.gpu),
        }
        if is_shown {
            // Where nothing is known yet there is no shadow.
            let lit = || vec![1.0; canvas.size[0] as usize * canvas.size[1] as usize];
            let values = picture.as_ref().map_or_else(lit, |p| p.visibility.clone());
            canvas.halves[1].write_visibility(&self.gpu, &values);
        }
        self.truth_written = Some(now);
        true
    }

    /// Asks for and takes in figures.
    pub fn measure(&mut self, desk: &Desk) {
        let (Some(canvas), Some(truth)) = (&self.canvas, &self.truth) else { return };
        let waker = self.waker();
        for (i, half) in self.halves.iter_mut().enumerate().take(desk.techniques()) {
            if half.made.is_some() {
                half.measured.work(&self.gpu, &canvas.halves[i].visibility, truth, waker.clone());
            }
        }
    }

    /// True if nothing is under way: no loading, compiling, drawing, tracing or measuring.
    pub fn is_idle(&self, desk: &Desk) -> bool {
        let ready = |i: usize| {
            let half = &self.halves[i];
            half.is_settled(&desk.choices[i]) && (half.made.is_none() || half.captured == desk.shows_debug_views(i))
        };
        let drawn = self.left_to_draw == 0 && self.stage.is_some() && self.last.is_some();
        let traced = !desk.wants_truth() || self.truth.as_ref().is_some_and(Truth::is_over);
        let measured =
            !desk.wants_truth() || self.halves.iter().take(desk.techniques()).all(|h| h.measured.is_current());
        let made = (0..desk.techniques()).all(ready);
        self.opening.is_none() && drawn && made && traced && measured
    }
}

impl Half {
    /// Makes what is chosen, unless it is there, on its way or known to fail.
    fn work(&mut self, gpu: &Gpu, stage: &Stage, choice: &Choice, ctx: &egui::Context) {
        if let Some((of, result)) = self.making.as_ref().and_then(|(c, job)| Some((c.clone(), job.poll()?))) {
            self.making = None;
            match result {
                Ok(Ok(technique)) => {
                    (self.made, self.failed) = (Some((of, technique)), None);
                    (self.captured, self.preparing) = (false, None);
                    self.times = Times::default();
                    // What the one before has under way are no times of this one.
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
        let (scene, casters) = (stage.scene.clone(), stage.casters());
        let title = format!("Compiling {}", choice.technique.title);
        let job = Job::start(
            title,
            move || ctx.request_repaint(),
            move |_| async move { Stage::technique(&gpu, &scene, casters, &spec).await },
        );
        self.making = Some((choice.clone(), job));
    }

    /// Has the technique keep what only people look at once that is compiled, or keep it no longer.
    fn set_debug_capture(&mut self, wanted: bool, gpu: &Gpu, stage: &Stage, ctx: &egui::Context) {
        let Some((choice, technique)) = self.made.as_mut().filter(|_| self.captured != wanted) else { return };
        if !wanted {
            technique.set_debug_capture(false);
            (self.captured, self.preparing) = (false, None);
            return;
        }
        if let Some(result) = self.preparing.as_ref().and_then(Job::poll) {
            // What the adapter has no room for is not seen; what is there anyway is.
            technique.set_debug_capture(matches!(result, Ok(Ok(()))));
            (self.captured, self.preparing) = (true, None);
        } else if self.preparing.is_none() {
            let (gpu, spec, ctx) = (gpu.clone(), choice.spec(), ctx.clone());
            let (scene, casters) = (stage.scene.clone(), stage.casters());
            self.preparing = Some(Job::start(
                "Looking inside",
                move || ctx.request_repaint(),
                move |_| async move { Stage::compile(&gpu, &scene, casters, &spec, true).await },
            ));
        }
    }

    /// True if the choice is drawn, or known to fail.
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
