//! GPU time per pass over several frames, GPU memory, and the rendered images of a technique on a scene.

use crate::{Error, Monitor};
use antumbra::gpu::timer::PassTime;
use antumbra::scene::SceneRenderer;
use antumbra::{Gpu, Shadows, Spec, Technique, Timer};
use antumbra_metrics::RgbImage;
use antumbra_scene::Scene;
use pollster::block_on;
use serde::Serialize;
use std::collections::BTreeMap;
use std::time::Instant;

/// Frames before the timed ones: the first compiles pipelines and creates textures, the second raises the clock rate.
const WARM_UP: u32 = 2;

/// A first frame of this many milliseconds raises the clock rate by itself.
const LONG: f64 = 1000.0;

/// Largest accepted difference between GPU times of a software adapter and the wall time, relative to the wall time.
const TOLERANCE: f64 = 0.25;

/// One pass.
#[derive(Clone, Debug, Serialize)]
pub struct Pass {
    /// Label.
    pub name: String,
    /// Median GPU time, milliseconds; none where the adapter has no timestamps.
    pub ms: Option<f64>,
    /// GPU memory of the pass, bytes.
    pub bytes: u64,
    /// True for a pass of the host (the geometry buffer), which no total includes.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub host: bool,
}

/// The clock of a total.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Timing {
    /// Timestamps of the GPU.
    Gpu,
    /// Wall time from submission to completion: there are no timestamps, or they contradict the wall clock.
    Wall,
}

impl Timing {
    /// Name in files.
    pub fn name(self) -> &'static str {
        match self {
            Timing::Gpu => "gpu",
            Timing::Wall => "wall",
        }
    }

    /// The mark after milliseconds of the wall clock.
    pub fn mark(self) -> &'static str {
        if self == Timing::Wall { "*" } else { "" }
    }
}

/// Meaning of the star after milliseconds.
pub const WALL: &str = "* wall time of the submitted work: the adapter has no timestamps, or they contradict it\n";

/// Cost of a technique.
#[derive(Clone, Debug, Serialize)]
pub struct Cost {
    /// The host's passes, then the technique's.
    pub passes: Vec<Pass>,
    /// Time of the shadow alone by the clock that `timing` names, milliseconds.
    pub total_ms: f64,
    /// GPU memory of the technique, bytes.
    pub total_bytes: u64,
    /// Median wall time of the shadow alone, from submission to completion, milliseconds.
    pub wall_ms: f64,
    /// The clock of `total_ms`.
    pub timing: Timing,
}

impl Cost {
    /// Milliseconds by a clock that is the same for every technique: on a software adapter always the wall clock.
    pub fn comparable_ms(&self, gpu: &Gpu) -> f64 {
        if gpu.is_software() { self.wall_ms } else { self.total_ms }
    }

    /// Milliseconds of the passes that `selects` accepts; `None` if none of them has a time.
    pub fn ms_of(&self, selects: impl Fn(&Pass) -> bool) -> Option<f64> {
        let times = self.passes.iter().filter(|pass| selects(pass)).filter_map(|pass| pass.ms);
        times.reduce(|sum, ms| sum + ms)
    }
}

/// Result of a technique on a scene.
pub struct Rendered {
    /// Its cost.
    pub cost: Cost,
    /// Visible fraction of the light at each pixel, row 0 on top.
    pub visibility: Vec<f32>,
    /// The technique's own statistics, such as the number of maps.
    pub stats: BTreeMap<&'static str, f64>,
}

/// A scene on the GPU, ready to be rendered at one size.
pub struct LoadedScene<'a> {
    /// The device.
    pub gpu: &'a Gpu,
    /// The renderer.
    pub renderer: SceneRenderer,
    monitor: &'a dyn Monitor,
    size: [u32; 2],
}

impl<'a> LoadedScene<'a> {
    /// Uploads a scene for images of `size` pixels.
    pub fn new(gpu: &'a Gpu, monitor: &'a dyn Monitor, scene: &Scene, size: [u32; 2]) -> Result<Self, Error> {
        gpu.check_size("image", size[0], size[1])?;
        let renderer = block_on(gpu.checked(|| SceneRenderer::new(gpu, scene, size)))?;
        Ok(LoadedScene { gpu, renderer, monitor, size })
    }

    /// Renders with one technique after another, shown as the task `name`; see [`LoadedScene::cost`] for `frames`.
    pub fn render_all(&self, name: &str, specs: &[&Spec], frames: u32) -> Result<Vec<Rendered>, Error> {
        let progress = self.monitor.task(name);
        let show = |i: usize, done| progress((i as f32 + done) / specs.len() as f32);
        specs.iter().enumerate().map(|(i, spec)| self.render(spec, frames, |done| show(i, done))).collect()
    }

    /// Creates a technique and measures it; see [`LoadedScene::cost`] for `frames` and `on_frame`.
    pub fn render(&self, spec: &Spec, frames: u32, on_frame: impl Fn(f32)) -> Result<Rendered, Error> {
        let gpu = self.gpu;
        let mut shadows = block_on(gpu.checked(|| Shadows::from_spec(gpu, spec)))?;
        let cost = self.cost(&mut shadows, frames, on_frame)?;
        let stats = self.stats(&shadows)?;
        let visibility = block_on(gpu.checked(|| block_on(self.renderer.read_visibility(gpu))))?;
        Ok(Rendered { cost, visibility, stats })
    }

    /// Renders until `frames` frames are timed, or a single frame without warm-up if `frames` is 0. The visibility of
    /// the last frame stays in the renderer's texture. `on_frame` receives the completed fraction.
    pub fn cost<T: Technique + ?Sized>(
        &self,
        shadows: &mut Shadows<T>,
        frames: u32,
        on_frame: impl Fn(f32),
    ) -> Result<Cost, Error> {
        let (gpu, renderer) = (self.gpu, &self.renderer);
        let mut timer = block_on(gpu.checked(|| Timer::new(gpu)))?;
        let (mut host, mut own, mut wall) = (Samples::default(), Samples::default(), Vec::new());
        let mut warm_up = if frames == 0 { 0 } else { WARM_UP };
        let mut frame = 0;
        while frame < warm_up + frames.max(1) {
            self.monitor.check()?;
            let (host_times, _) =
                submit(gpu, &mut timer, |encoder, timer| renderer.record_geometry(gpu, encoder, Some(timer)))?;
            let (own_times, wall_ms) = submit(gpu, &mut timer, |encoder, timer| {
                shadows.record_timed(gpu, encoder, &renderer.frame, Some(timer))
            })?;
            if frame >= warm_up {
                host.push(host_times);
                own.push(own_times);
                wall.push(wall_ms);
            } else {
                warm_up = frames_to_warm_up(warm_up, frame, wall_ms);
            }
            frame += 1;
            on_frame(frame as f32 / (warm_up + frames.max(1)) as f32);
        }
        let mut host = host.passes(true);
        if let Some(pass) = host.first_mut() {
            pass.bytes = renderer.geometry.bytes();
        }
        Ok(cost(gpu, host, with_memory(own.passes(false), shadows), median(wall)))
    }

    /// Statistics of a technique's last frame.
    pub fn stats<T: Technique + ?Sized>(&self, shadows: &Shadows<T>) -> Result<BTreeMap<&'static str, f64>, Error> {
        Ok(block_on(self.gpu.checked(|| block_on(shadows.stats(self.gpu))))?.into_iter().collect())
    }

    /// The scene shaded with the visibility of the last frame, 8-bit sRGB.
    pub fn image(&self) -> Result<RgbImage, Error> {
        let rgba = block_on(self.gpu.checked(|| block_on(self.renderer.image(self.gpu))))?;
        let [width, height] = self.size;
        Ok(RgbImage { width, height, data: rgba.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect() })
    }

    /// The scene shaded with this visibility, 8-bit sRGB.
    pub fn shaded(&self, visibility: &[f32]) -> Result<RgbImage, Error> {
        self.renderer.write_visibility(self.gpu, visibility);
        self.image()
    }
}

/// Number of warm-up frames after one of them took `wall_ms`. Only the first may end the warm-up: the second would
/// replace a timed frame.
fn frames_to_warm_up(planned: u32, frame: u32, wall_ms: f64) -> u32 {
    if frame == 0 && wall_ms > LONG { 1 } else { planned }
}

/// Records work, submits it and waits for it. Returns the GPU time of each pass and the wall time from submission to
/// completion, milliseconds.
fn submit(
    gpu: &Gpu,
    timer: &mut Timer,
    record: impl FnOnce(&mut wgpu::CommandEncoder, &Timer) -> Result<(), antumbra::Error>,
) -> Result<(Vec<PassTime>, f64), antumbra::Error> {
    block_on(gpu.checked(|| {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        record(&mut encoder, timer)?;
        let started = Instant::now();
        let times = timer.finish(gpu, encoder)?;
        Ok((times, started.elapsed().as_secs_f64() * 1000.0))
    }))
}

fn cost(gpu: &Gpu, host: Vec<Pass>, own: Vec<Pass>, wall_ms: f64) -> Cost {
    let gpu_ms: Option<f64> = own.iter().map(|p| p.ms).sum();
    let agrees = |ms: &f64| !gpu.is_software() || (ms - wall_ms).abs() <= TOLERANCE * wall_ms;
    let (total_ms, timing) = match gpu_ms.filter(agrees) {
        Some(ms) => (ms, Timing::Gpu),
        None => (wall_ms, Timing::Wall),
    };
    let total_bytes = own.iter().map(|p| p.bytes).sum();
    Cost { passes: host.into_iter().chain(own).collect(), total_ms, total_bytes, wall_ms, timing }
}

/// Adds the technique's memory to its passes. Memory of a pass that was not timed becomes an entry of its own.
fn with_memory<T: Technique + ?Sized>(mut passes: Vec<Pass>, shadows: &Shadows<T>) -> Vec<Pass> {
    let timed = passes.iter().any(|p| p.ms.is_some());
    for memory in shadows.memory() {
        match passes.iter_mut().find(|p| p.name == memory.pass) {
            Some(pass) => pass.bytes += memory.bytes,
            None => {
                let ms = timed.then_some(0.0);
                passes.push(Pass { name: memory.pass.to_owned(), ms, bytes: memory.bytes, host: false });
            }
        }
    }
    passes
}

/// Times of passes over several frames, in the order of their first appearance.
#[derive(Default)]
struct Samples {
    frames: usize,
    times: Vec<(String, Vec<Option<f64>>)>,
}

impl Samples {
    fn push(&mut self, frame: Vec<PassTime>) {
        for (name, ms) in frame {
            match self.times.iter_mut().find(|(n, _)| *n == name) {
                Some((_, list)) => list.push(ms),
                None => self.times.push((name, vec![ms])),
            }
        }
        self.frames += 1;
    }

    /// A pass that is absent from a frame took no time in it.
    fn passes(self, host: bool) -> Vec<Pass> {
        let pass = |(name, mut list): (String, Vec<Option<f64>>)| {
            list.resize(self.frames, Some(0.0));
            let known: Option<Vec<f64>> = list.into_iter().collect();
            Pass { name, ms: known.map(median), bytes: 0, host }
        };
        self.times.into_iter().map(pass).collect()
    }
}

/// The middle value, or the mean of the two in the middle; 0 if there are no values.
pub(crate) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let half = values.len() / 2;
    match values.len() {
        0 => 0.0,
        n if n % 2 == 1 => values[half],
        _ => 0.5 * (values[half - 1] + values[half]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_long_first_frame_shortens_the_warm_up() {
        let planned = |frame, ms| frames_to_warm_up(WARM_UP, frame, ms);
        assert_eq!([planned(0, 900.0), planned(0, 1100.0), planned(1, 1100.0)], [2, 1, 2]);
    }

    #[test]
    fn the_median_is_the_middle() {
        assert_eq!([median(vec![]), median(vec![3.0, 1.0, 2.0]), median(vec![4.0, 1.0])], [0.0, 2.0, 2.5]);
    }

    #[test]
    fn a_pass_that_is_absent_from_a_frame_counts_as_zero() {
        let mut samples = Samples::default();
        samples.push(vec![("map".into(), Some(2.0)), ("extra".into(), Some(9.0))]);
        samples.push(vec![("map".into(), Some(4.0))]);
        samples.push(vec![("map".into(), Some(3.0))]);
        let passes = samples.passes(false);
        assert_eq!(passes.iter().map(|p| p.ms).collect::<Vec<_>>(), [Some(3.0), Some(0.0)]);
    }

    #[test]
    fn a_pass_without_timestamps_has_no_time() {
        let mut samples = Samples::default();
        samples.push(vec![("map".into(), None)]);
        assert_eq!(samples.passes(true)[0].ms, None);
    }
}
