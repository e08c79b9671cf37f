//! The ray-traced truth, refined in the background: from a coarse picture to the very one that `antumbra reference` traces.

use crate::here;
use crate::job::{Died, Slice};
use antumbra_reference::{Pixel, Settings, Tracer, TracerBuild, View};
use antumbra_scene::{Camera, RectLight, Scene};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex, OnceLock};

/// Shadow rays and primary rays of a pixel, level after level. Each level replaces the one before; all but the last
/// together take a third of its time. The last is what the command line traces.
const LEVELS: [[u32; 2]; 4] = [[16, 1], [64, 4], [256, 16], [1024, 16]];

/// Pixels that are traced at a stretch.
const RUN: u32 = 16;

/// What a truth is the truth about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Question {
    /// Camera.
    pub camera: Camera,
    /// Light.
    pub light: RectLight,
    /// Pixels.
    pub size: [u32; 2],
    /// Changes when occluders have moved or another scene is open.
    pub pose: u64,
}

/// The picture so far. Lists are row-major, row 0 on top.
pub struct Picture {
    /// Pixels.
    pub size: [u32; 2],
    /// Visible fraction of the light.
    pub visibility: Vec<f32>,
    /// True where errors are measured: traced already, and a surface that faces the light.
    pub valid: Vec<bool>,
    /// Levels that each row has.
    rows: Vec<u8>,
    /// Counts rows that have come in.
    pub version: u64,
    /// Why no more will come in.
    pub died: Option<Died>,
}

impl Picture {
    fn empty(size: [u32; 2]) -> Picture {
        let count = size[0] as usize * size[1] as usize;
        let rows = vec![0; size[1] as usize];
        Picture { size, visibility: vec![1.0; count], valid: vec![false; count], rows, version: 0, died: None }
    }

    /// Puts a row in; rows beside it that have nothing yet show it too, and do not count.
    fn put(&mut self, y: usize, level: u8, pixels: &[Pixel]) {
        let width = self.size[0] as usize;
        for (x, pixel) in pixels.iter().enumerate() {
            self.visibility[y * width + x] = pixel.visibility;
            self.valid[y * width + x] = pixel.valid;
        }
        self.rows[y] = level;
        self.version += 1;
        let below = (y + 1..self.rows.len()).take_while(|&r| self.rows[r] == 0).last().unwrap_or(y);
        for row in y + 1..=below {
            self.visibility.copy_within(y * width..(y + 1) * width, row * width);
        }
    }

    /// True if every row has been traced at least once.
    pub fn is_whole(&self) -> bool {
        self.rows.iter().all(|&r| r > 0)
    }

    /// True if every row is as fine as it gets.
    fn is_finest(&self) -> bool {
        self.rows.iter().all(|&r| usize::from(r) == LEVELS.len())
    }

    /// The fraction of all work that is done, by the rays of the levels.
    pub fn done(&self) -> f32 {
        let total: u32 = LEVELS.iter().map(|l| l[0]).sum();
        let of = |&r: &u8| LEVELS[..usize::from(r)].iter().map(|l| l[0]).sum::<u32>() as f32 / total as f32;
        self.rows.iter().map(of).sum::<f32>() / self.rows.len().max(1) as f32
    }

    /// Shadow rays a pixel of the coarsest row.
    pub fn rays(&self) -> u32 {
        let least = self.rows.iter().copied().min().unwrap_or(0);
        least.checked_sub(1).map_or(0, |level| LEVELS[usize::from(level)][0])
    }
}

/// How far a truth is.
#[derive(Clone, Debug, PartialEq)]
pub enum Progress {
    /// The tree over the triangles is being built.
    Preparing,
    /// Rows come in.
    Tracing {
        /// Part of all work.
        done: f32,
        /// Shadow rays a pixel of the coarsest row.
        rays: u32,
    },
    /// As fine as it gets.
    Done,
    /// The tracing broke off: no more will come.
    Died(String),
}

impl std::fmt::Display for Progress {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Progress::Preparing => write!(f, "sorting triangles for rays …"),
            Progress::Tracing { done, rays } => write!(f, "{:.0} %   {rays} rays a pixel", 100.0 * done),
            Progress::Done => write!(f, "1024 rays a pixel"),
            Progress::Died(why) => write!(f, "cannot be traced: {why}"),
        }
    }
}

/// A truth that is being traced, or has been.
pub struct Truth {
    /// What it is about.
    pub question: Question,
    /// What is known.
    pub picture: Arc<Mutex<Picture>>,
    work: Arc<Work>,
}

struct Work {
    question: Question,
    tracer: Arc<Lazy>,
    picture: Arc<Mutex<Picture>>,
    /// Rows that were begun, over all levels.
    next: AtomicU32,
    cancelled: AtomicBool,
}

/// A scene whose tree is built by the first who traces.
pub struct Lazy {
    scene: Arc<Scene>,
    tracer: OnceLock<Tracer>,
    /// True from when somebody began to build it.
    begun: AtomicBool,
}

impl Lazy {
    /// The scene as it stands.
    pub fn new(scene: Arc<Scene>) -> Lazy {
        Lazy { scene, tracer: OnceLock::new(), begun: AtomicBool::new(false) }
    }

    /// The tree once it is built; none if it is given up because `is_wanted` says so.
    async fn get(&self, slice: &mut Slice, is_wanted: impl Fn() -> bool) -> Option<&Tracer> {
        if here::HAS_THREADS {
            return Some(self.tracer.get_or_init(|| Tracer::new(&self.scene)));
        }
        while self.tracer.get().is_none() {
            if !self.begun.swap(true, Ordering::Relaxed) {
                let mut build = TracerBuild::new(&self.scene);
                let is_whole = slice.run(&mut build, &is_wanted).await;
                self.begun.store(false, Ordering::Relaxed);
                if !is_whole {
                    return None;
                }
                // Nobody else builds it meanwhile.
                let _ = self.tracer.set(build.finish());
            }
            here::yield_to_frame().await;
        }
        self.tracer.get()
    }

    /// True once the tree is built.
    pub fn is_ready(&self) -> bool {
        self.tracer.get().is_some()
    }
}

impl Truth {
    /// Starts tracing on all cores but one, or between the frames where there are no threads. `wake` is called when there is more to show.
    pub fn start(question: Question, tracer: Arc<Lazy>, wake: impl Fn() + Clone + Send + 'static) -> Truth {
        let picture = Arc::new(Mutex::new(Picture::empty(question.size)));
        let work = Arc::new(Work {
            question,
            tracer,
            picture: picture.clone(),
            next: AtomicU32::new(0),
            cancelled: AtomicBool::new(false),
        });
        work.spawn(wake);
        Truth { question, picture, work }
    }

    /// True if no more will come: it is as fine as it gets, or the tracing broke off.
    pub fn is_over(&self) -> bool {
        self.picture.lock().map_or(true, |p| p.died.is_some() || p.is_finest())
    }

    /// How far it is, for people.
    pub fn progress(&self) -> Progress {
        let Ok(picture) = self.picture.lock() else { return Progress::Died("its picture is lost".to_owned()) };
        match &picture.died {
            Some(died) => Progress::Died(died.to_string()),
            None if picture.is_finest() => Progress::Done,
            None if picture.version == 0 && !self.work.tracer.is_ready() => Progress::Preparing,
            None => Progress::Tracing { done: picture.done(), rays: picture.rays() },
        }
    }
}

impl Drop for Truth {
    fn drop(&mut self) {
        self.work.cancelled.store(true, Ordering::Relaxed);
    }
}

impl Work {
    fn spawn(self: &Arc<Self>, wake: impl Fn() + Clone + Send + 'static) {
        for _ in 0..here::workers() {
            let (work, picture, wake) = (self.clone(), self.picture.clone(), wake.clone());
            let trace = move || async move {
                let mut slice = Slice::default();
                while work.row(&mut slice).await {
                    wake();
                }
            };
            here::run_job(trace, move |ended| {
                if let (Err(died), Ok(mut picture)) = (ended, picture.lock()) {
                    picture.died = Some(died);
                }
            });
        }
    }

    fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    /// Traces the next row; false if there is none, or nobody wants it.
    async fn row(&self, slice: &mut Slice) -> bool {
        let [width, height] = self.question.size;
        let next = self.next.fetch_add(1, Ordering::Relaxed);
        let level = (next / height.max(1)) as usize;
        if level >= LEVELS.len() {
            return false;
        }
        let [light_samples, pixel_samples] = LEVELS[level];
        let settings = Settings { light_samples, pixel_samples, ..Settings::of_size(width, height) };
        // The next truth of the same scene goes on with what this one has begun.
        let is_wanted = || !self.is_cancelled() || Arc::strong_count(&self.tracer) > 1;
        let Some(tracer) = self.tracer.get(slice, is_wanted).await else { return false };
        let view = View::new(tracer, &self.question.camera, &self.question.light, &settings);
        let y = spread(next % height, height);
        let mut pixels = Vec::with_capacity(width as usize);
        for x in (0..width).step_by(RUN as usize) {
            pixels.extend(view.pixels(x..(x + RUN).min(width), y..y + 1));
            slice.breathe().await;
            if self.is_cancelled() {
                return false;
            }
        }
        if let Ok(mut picture) = self.picture.lock() {
            // A slow row of a coarser level may come in after a finer one.
            if usize::from(picture.rows[y as usize]) <= level {
                picture.put(y as usize, level as u8 + 1, &pixels);
            }
        }
        true
    }
}

/// The `k`-th row in an order that fills the picture evenly: every 16th, then those half-way between, and so on.
fn spread(k: u32, height: u32) -> u32 {
    let mut before = 0;
    for pass in 0..5u32 {
        let (start, step) = if pass == 0 { (0, 16) } else { (16 >> pass, 32 >> pass) };
        let count = if start < height { (height - start).div_ceil(step) } else { 0 };
        if k < before + count {
            return start + (k - before) * step;
        }
        before += count;
    }
    unreachable!("the passes have every row")
}

#[cfg(test)]
mod tests {
    use super::*;
    use antumbra_reference::trace;

    #[test]
    fn every_row_comes_once() {
        for height in [1, 2, 5, 16, 17, 100, 719] {
            let mut rows: Vec<u32> = (0..height).map(|k| spread(k, height)).collect();
            rows.sort_unstable();
            assert_eq!(rows, (0..height).collect::<Vec<_>>(), "{height}");
        }
    }

    #[test]
    fn the_last_level_is_what_the_command_line_traces() {
        let scene = antumbra_scene::builtin::build("square").unwrap();
        let size = [24, 16];
        let question = Question { camera: scene.camera, light: scene.light, size, pose: 0 };
        let truth = Truth::start(question, Arc::new(Lazy::new(Arc::new(scene.clone()))), || ());
        for _ in 0..3000 {
            if truth.is_over() {
                break;
            }
            std::thread::sleep(std::time::Duration::from_millis(10));
        }
        let settings = Settings::of_size(size[0], size[1]);
        let whole = trace(&scene, &settings, &|_| (), &AtomicBool::new(false)).unwrap();
        let picture = truth.picture.lock().unwrap();
        assert_eq!((picture.done(), picture.rays()), (1.0, 1024));
        assert_eq!(picture.visibility, whole.visibility);
        assert_eq!(picture.valid, whole.valid);
    }

    #[test]
    fn a_truth_that_breaks_off_says_so() {
        let mut scene = antumbra_scene::builtin::build("square").unwrap();
        // No importer gives such a mesh: a corner that is not there.
        scene.meshes[0].indices[0] = u32::MAX;
        let question = Question { camera: scene.camera, light: scene.light, size: [24, 16], pose: 0 };
        let truth = Truth::start(question, Arc::new(Lazy::new(Arc::new(scene))), || ());
        for _ in 0..3000 {
            if truth.is_over() {
                break;
            }
            std::thread::sleep(std::time::Duration::from_millis(10));
        }
        let said = truth.progress().to_string();
        assert!(said.contains("cannot be traced") && said.contains("out of bounds"), "{said}");
    }

    #[test]
    fn a_truth_that_nobody_wants_ends() {
        let scene = Arc::new(antumbra_scene::builtin::build("forest").unwrap());
        let question = Question { camera: scene.camera, light: scene.light, size: [640, 480], pose: 0 };
        let truth = Truth::start(question, Arc::new(Lazy::new(scene)), || ());
        let work = truth.work.clone();
        drop(truth);
        for _ in 0..3000 {
            if Arc::strong_count(&work) == 1 {
                return;
            }
            std::thread::sleep(std::time::Duration::from_millis(10));
        }
        panic!("threads still trace after 30 s");
    }
}
