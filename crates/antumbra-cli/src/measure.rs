//! What a technique costs: GPU time by pass over several frames, and memory.

use crate::error::CliError;
use crate::{progress, setup};
use antumbra::gpu::recorder::PassTime;
use antumbra::scene::SceneRenderer;
use antumbra::{Error, Gpu, Recorder, Spec, Technique, Timer};
use pollster::block_on;
use serde::Serialize;
use std::time::Instant;

/// Frames before those that count: the first compiles pipelines and makes textures, the second brings the clock up.
const WARM_UP: u32 = 2;

/// A first frame that takes this long, in milliseconds, has brought the clock up too.
const LONG: f64 = 1000.0;

/// How far, relative to the wall time, GPU times of a software adapter may be off before they are not believed.
const BELIEVED: f64 = 0.25;

/// One pass.
#[derive(Clone, Debug, Serialize)]
pub struct Pass {
    /// Its label.
    pub name: String,
    /// Median GPU time; none where the adapter has no timestamps.
    pub ms: Option<f64>,
    /// GPU memory that belongs to it.
    pub bytes: u64,
    /// True if the host does it anyway, so that it is in no total.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub host: bool,
}

/// Which clock the total is read from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Timing {
    /// Timestamps of the GPU.
    Gpu,
    /// From submission to completion: there are no timestamps, or they contradict the wall clock.
    Wall,
}

impl Timing {
    /// As files have it.
    pub fn name(self) -> &'static str {
        match self {
            Timing::Gpu => "gpu",
            Timing::Wall => "wall",
        }
    }
}

/// What a technique costs.
#[derive(Clone, Debug, Serialize)]
pub struct Cost {
    /// The host's passes, then the technique's.
    pub passes: Vec<Pass>,
    /// Milliseconds of the shadow alone, by the clock that `timing` names.
    pub total_ms: f64,
    /// GPU memory that the technique owns.
    pub total_bytes: u64,
    /// Median time from submission to completion of the shadow alone, milliseconds.
    pub wall_ms: f64,
    /// Which clock `total_ms` is read from.
    pub timing: Timing,
}

/// What a technique has made of a scene.
pub struct Drawn {
    /// What it took.
    pub cost: Cost,
    /// What it found, row 0 on top.
    pub visibility: Vec<f32>,
    /// What it says of its work, such as the number of maps.
    pub work: Vec<(&'static str, f64)>,
}

/// Makes a technique and measures it.
pub fn draw(
    gpu: &Gpu,
    renderer: &SceneRenderer,
    spec: &Spec,
    frames: u32,
    on_frame: impl Fn(f32),
) -> Result<Drawn, CliError> {
    let mut technique = block_on(gpu.checked(|| spec.make(gpu)))?;
    let cost = measure(gpu, renderer, &mut *technique, frames, on_frame)?;
    let work = block_on(gpu.checked(|| block_on(technique.figures(gpu))))?;
    Ok(Drawn { cost, visibility: setup::visibility(gpu, renderer)?, work })
}

/// Draws frames of a technique until `frames` of them have been timed, or a single one without warming up if `frames`
/// is 0. The last one's visibility stays.
pub fn measure(
    gpu: &Gpu,
    renderer: &SceneRenderer,
    technique: &mut dyn Technique,
    frames: u32,
    on_frame: impl Fn(f32),
) -> Result<Cost, CliError> {
    let mut timer = block_on(gpu.checked(|| Timer::new(gpu)))?;
    let (mut host, mut own, mut wall) = (Samples::default(), Samples::default(), Vec::new());
    let mut warm_up = if frames == 0 { 0 } else { WARM_UP };
    let mut frame = 0;
    while frame < warm_up + frames.max(1) {
        progress::check_cancelled()?;
        let (host_times, _) = submit(gpu, &mut timer, |recorder| renderer.record_geometry(recorder))?;
        let (own_times, wall_ms) = submit(gpu, &mut timer, |recorder| renderer.record_shadow(technique, recorder))?;
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
    Ok(cost(gpu, host, with_memory(own.passes(false), technique), median(wall)))
}

/// How many frames warm up, now that one of them has taken so long. Only the first may say that it is enough: where
/// the second one did, it would take the place of a frame that counts.
fn frames_to_warm_up(planned: u32, frame: u32, wall_ms: f64) -> u32 {
    if frame == 0 && wall_ms > LONG { 1 } else { planned }
}

/// Records and submits some work, and waits for it: the passes' GPU times, and the wall time from submission on.
fn submit(
    gpu: &Gpu,
    timer: &mut Timer,
    record: impl FnOnce(&mut Recorder) -> Result<(), Error>,
) -> Result<(Vec<PassTime>, f64), Error> {
    block_on(gpu.checked(|| {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        record(&mut Recorder::timed(gpu, &mut encoder, timer))?;
        let started = Instant::now();
        let times = timer.finish(gpu, encoder)?;
        Ok((times, started.elapsed().as_secs_f64() * 1000.0))
    }))
}

fn cost(gpu: &Gpu, host: Vec<Pass>, own: Vec<Pass>, wall_ms: f64) -> Cost {
    let gpu_ms: Option<f64> = own.iter().map(|p| p.ms).sum();
    let believed = |ms: &f64| !gpu.is_software() || (ms - wall_ms).abs() <= BELIEVED * wall_ms;
    let (total_ms, timing) = match gpu_ms.filter(believed) {
        Some(ms) => (ms, Timing::Gpu),
        None => (wall_ms, Timing::Wall),
    };
    let total_bytes = own.iter().map(|p| p.bytes).sum();
    Cost { passes: host.into_iter().chain(own).collect(), total_ms, total_bytes, wall_ms, timing }
}

/// Adds the technique's memory to its passes. Memory that no timed pass answers for becomes an entry of its own.
fn with_memory(mut passes: Vec<Pass>, technique: &dyn Technique) -> Vec<Pass> {
    let timed = passes.iter().any(|p| p.ms.is_some());
    for memory in technique.memory() {
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

    /// A pass that a frame did without took no time in it.
    fn passes(self, host: bool) -> Vec<Pass> {
        let pass = |(name, mut list): (String, Vec<Option<f64>>)| {
            list.resize(self.frames, Some(0.0));
            let known: Option<Vec<f64>> = list.into_iter().collect();
            Pass { name, ms: known.map(median), bytes: 0, host }
        };
        self.times.into_iter().map(pass).collect()
    }
}

/// The middle value, or the mean of the two in the middle; 0 of nothing.
fn median(mut values: Vec<f64>) -> f64 {
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
    fn a_long_second_frame_leaves_the_frames_that_count() {
        let planned = |frame, ms| frames_to_warm_up(WARM_UP, frame, ms);
        assert_eq!([planned(0, 900.0), planned(0, 1100.0), planned(1, 1100.0)], [2, 1, 2]);
    }

    #[test]
    fn the_median_is_the_middle() {
        assert_eq!([median(vec![]), median(vec![3.0, 1.0, 2.0]), median(vec![4.0, 1.0])], [0.0, 2.0, 2.5]);
    }

    #[test]
    fn passes_that_a_frame_did_without_count_as_zero() {
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
