//! The ray-traced truth, refined in the background up to the image that `antumbra reference` traces.

use crate::here;
use crate::job::{Died, Slice};
use antumbra_reference::{Pixel, Settings, Tracer, TracerBuild, View};
use antumbra_scene::{Camera, RectLight, Scene};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex, OnceLock};

/// Shadow rays and primary rays per pixel of each level. A level replaces the last; all but the final one
/// together take a third of its time. The final one equals the command line's.
const LEVELS: [[u32; 2]; 4] = [[16, 1], [64, 4], [256, 16], [1024, 16]];

/// Pixels per slice.
const RUN: u32 = 16;

/// The inputs of a truth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Question {
    /// Camera.
    pub camera: Camera,
    /// Light.
    pub light: RectLight,
    /// Pixels.
    pub size: [u32; 2],
    /// Number of the pose and scene.
    pub pose: u64,
}

/// The current image, row-major, row 0 on top.
pub struct TracedImage {
    /// Pixels.
    pub size: [u32; 2],
    /// Visible fraction of the light.
    pub visibility: Vec<f32>,
    /// True where errors are measured: a traced surface that faces the light.
    pub valid: Vec<bool>,
    /// Finished levels of each row.
    rows: Vec<u8>,
    /// Number of finished rows.
    pub version: u64,
    /// Error that stopped the tracing.
    pub died: Option<Died>,
}

impl TracedImage {
    fn empty(size: [u32; 2]) -> TracedImage {
        let count = size[0] as usize * size[1] as usize;
        let rows = vec![0; size[1] as usize];
        TracedImage { size, visibility: vec![1.0; count], valid: vec![false; count], rows, version: 0, died: None }
    }

    /// Stores a row, also into empty neighbouring rows, which do not count.
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

    /// True if every row has its final level.
    fn is_finest(&self) -> bool {
        self.rows.iter().all(|&r| usize::from(r) == LEVELS.len())
    }

    /// Fraction of all rays that are traced.
    pub fn done(&self) -> f32 {
        let total: u32 = LEVELS.iter().map(|l| l[0]).sum();
        let of = |&r: &u8| LEVELS[..usize::from(r)].iter().map(|l| l[0]).sum::<u32>() as f32 / total as f32;
        self.rows.iter().map(of).sum::<f32>() / self.rows.len().max(1) as f32
    }

    /// Shadow rays per pixel of the coarsest row.
    pub fn rays(&self) -> u32 {
        let least = self.rows.iter().copied().min().unwrap_or(0);
        least.checked_sub(1).map_or(0, |level| LEVELS[usize::from(level)][0])
    }
}

/// Progress of a truth.
#[derive(Clone, Debug, PartialEq)]
pub enum Progress {
    /// The tracer's hierarchy is built.
    Preparing,
    /// Rows are traced.
    Tracing {
        /// Fraction of all rays.
        done: f32,
        /// Shadow rays per pixel of the coarsest row.
        rays: u32,
    },
    /// The final level is complete.
    Done,
    /// Tracing failed.
    Died(String),
}

impl std::fmt::Display for Progress {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Progress::Preparing => write!(f, "sorting triangles for rays …"),
            Progress::Tracing { done, rays } => write!(f, "{:.0} %   {rays} rays per pixel", 100.0 * done),
            Progress::Done => write!(f, "1024 rays per pixel"),
            Progress::Died(why) => write!(f, "cannot be traced: {why}"),
        }
    }
}

/// A truth in progress or finished.
pub struct Truth {
    /// Its inputs.
    pub question: Question,
    /// The current image.
    pub image: Arc<Mutex<TracedImage>>,
    work: Arc<Work>,
}

struct Work {
    question: Question,
    tracer: Arc<Lazy>,
    image: Arc<Mutex<TracedImage>>,
    /// Number of started rows over all levels.
    next: AtomicU32,
    cancelled: AtomicBool,
}

/// A scene whose tracer is built on first use.
pub struct Lazy {
    scene: Arc<Scene>,
    tracer: OnceLock<Tracer>,
    /// True once building has started.
    begun: AtomicBool,
}

impl Lazy {
    /// The scene in its current pose.
    pub fn new(scene: Arc<Scene>) -> Lazy {
        Lazy { scene, tracer: OnceLock::new(), begun: AtomicBool::new(false) }
    }

    /// The tracer, once it is built; none if `is_wanted` returns false.
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
                // The flag excludes other builders.
                let _ = self.tracer.set(build.finish());
            }
            here::yield_to_frame().await;
        }
        self.tracer.get()
    }

    /// True once the tracer is built.
    pub fn is_ready(&self) -> bool {
        self.tracer.get().is_some()
    }
}

impl Truth {
    /// Starts tracing on all cores but one, or in slices between frames. `wake` is called for new rows.
    pub fn start(question: Question, tracer: Arc<Lazy>, wake: impl Fn() + Clone + Send + 'static) -> Truth {
        let image = Arc::new(Mutex::new(TracedImage::empty(question.size)));
        let work = Arc::new(Work {
            question,
            tracer,
            image: image.clone(),
            next: AtomicU32::new(0),
            cancelled: AtomicBool::new(false),
        });
        work.spawn(wake);
        Truth { question, image, work }
    }

    /// True once tracing has ended or failed.
    pub fn is_over(&self) -> bool {
        self.image.lock().map_or(true, |p| p.died.is_some() || p.is_finest())
    }

    /// Progress as text.
    pub fn progress(&self) -> Progress {
        let Ok(image) = self.image.lock() else { return Progress::Died("its image is lost".to_owned()) };
        match &image.died {
            Some(died) => Progress::Died(died.to_string()),
            None if image.is_finest() => Progress::Done,
            None if image.version == 0 && !self.work.tracer.is_ready() => Progress::Preparing,
            None => Progress::Tracing { done: image.done(), rays: image.rays() },
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
            let (work, image, wake) = (self.clone(), self.image.clone(), wake.clone());
            let trace = move || async move {
                let mut slice = Slice::default();
                while work.row(&mut slice).await {
                    wake();
                }
            };
            here::run_job(trace, move |ended| {
                if let (Err(died), Ok(mut image)) = (ended, image.lock()) {
                    image.died = Some(died);
                }
            });
        }
    }

    fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    /// Traces the next row; false if there is none, or the truth is no longer wanted.
    async fn row(&self, slice: &mut Slice) -> bool {
        let [width, height] = self.question.size;
        let next = self.next.fetch_add(1, Ordering::Relaxed);
        let level = (next / height.max(1)) as usize;
        if level >= LEVELS.len() {
            return false;
        }
        let [light_samples, pixel_samples] = LEVELS[level];
        let settings = Settings { light_samples, pixel_samples, ..Settings::of_size(width, height) };
        // The next truth of this scene uses the same tracer.
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
        if let Ok(mut image) = self.image.lock() {
            // A slow row of a coarser level may arrive after a finer one.
            if usize::from(image.rows[y as usize]) <= level {
                image.put(y as usize, level as u8 + 1, &pixels);
            }
        }
        true
    }
}

/// The `k`-th row in an order that fills the image evenly: every 16th, then those half-way between, and so on.
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
        let image = truth.image.lock().unwrap();
        assert_eq!((image.done(), image.rays()), (1.0, 1024));
        assert_eq!(image.visibility, whole.visibility);
        assert_eq!(image.valid, whole.valid);
    }

    #[test]
    fn a_truth_that_breaks_off_says_so() {
        let mut scene = antumbra_scene::builtin::build("square").unwrap();
        // An index out of range: no importer produces one.
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
