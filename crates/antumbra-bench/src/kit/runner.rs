//! Running experiments.

use super::experiment::Experiment;
use super::trial::{Run, Trial};
use crate::measure::{LoadedScene, Rendered, Timing};
use crate::page::text;
use crate::truth::{Truth, TruthSettings};
use crate::{Error, Monitor};
use antumbra::{Gpu, Spec};
use antumbra_scene::Scene;
use std::time::Instant;

/// Visibility of pixels that viewers perceive as penumbra.
const PENUMBRA: std::ops::Range<f32> = 0.01..0.99;

/// The device and the settings of all experiments.
pub struct Runner<'a> {
    /// The device.
    pub gpu: &'a Gpu,
    /// Display of progress, and requests to stop.
    pub monitor: &'a dyn Monitor,
    /// Size of the images, pixels; none for each suite's own.
    pub size: Option<[u32; 2]>,
    /// Timed frames of each technique; their median counts.
    pub frames: u32,
    /// Sampling of the references.
    pub truth: TruthSettings,
    /// Scenes in addition to a suite's own.
    pub scenes: &'a [Scene],
}

impl Runner<'_> {
    /// The command line's size, or a suite's own.
    pub fn size(&self, own: [u32; 2]) -> [u32; 2] {
        self.size.unwrap_or(own)
    }

    /// Half of the command line's size each way, or a suite's own.
    pub fn half_size(&self, own: [u32; 2]) -> [u32; 2] {
        self.size.map_or(own, |size| size.map(|side| (side / 2).max(1)))
    }

    /// Uploads a scene.
    pub fn load(&self, scene: &Scene, size: [u32; 2]) -> Result<LoadedScene<'_>, Error> {
        LoadedScene::new(self.gpu, self.monitor, scene, size)
    }

    /// Runs one experiment after another and logs each.
    pub fn run_all(&self, experiments: &[Experiment]) -> Result<Vec<Trial>, Error> {
        let (all, started) = (experiments.len(), Instant::now());
        let trial = |(i, experiment): (usize, &Experiment)| {
            let Experiment { name, specs, size: [width, height], .. } = experiment;
            let (techniques, after) = (specs.len(), text::seconds(started.elapsed().as_secs_f64()));
            let line =
                format!("{} of {all}: {name}, {width} x {height}, {techniques} techniques, after {after}", i + 1);
            self.monitor.log(&line);
            self.run(experiment)
        };
        experiments.iter().enumerate().map(trial).collect()
    }

    /// Runs groups of experiments. Returns all trials and the number in each group, for [`split`](super::trial::split).
    pub fn run_groups<const N: usize>(&self, groups: [Vec<Experiment>; N]) -> Result<(Vec<Trial>, [usize; N]), Error> {
        let counts = groups.each_ref().map(Vec::len);
        Ok((self.run_all(&groups.into_iter().flatten().collect::<Vec<_>>())?, counts))
    }

    /// Measures the techniques next to each other and then traces the reference.
    pub fn run(&self, experiment: &Experiment) -> Result<Trial, Error> {
        let Experiment { scene, size, specs, .. } = experiment;
        let loaded = self.load(scene, *size)?;
        let frames = if experiment.timed { self.frames } else { 0 };
        let task = format!("Measuring {}", experiment.name);
        let mut rendered = loaded.render_all(&task, &specs.iter().collect::<Vec<_>>(), frames)?;
        use_one_clock(&mut rendered);
        let settings = (experiment.truth)(&self.truth);
        let truth = Truth::of(scene, *size, &settings, self.monitor)?;
        self.monitor.check()?;
        let run = |(spec, rendered): (&Spec, Rendered)| {
            let image = experiment.keeps_images.then(|| loaded.shaded(&rendered.visibility)).transpose()?;
            Run::new(spec, rendered, image, &truth)
        };
        let runs = specs.iter().zip(rendered).map(run).collect::<Result<_, _>>()?;
        Ok(Trial {
            name: experiment.name.clone(),
            scene: scene.name.clone(),
            triangles: scene.triangle_count(),
            width: size[0],
            height: size[1],
            penumbra: penumbra(&truth),
            light_samples: settings.light_samples,
            pixel_samples: settings.pixel_samples,
            truth_error: truth.reference.rms_error(),
            frames,
            image: loaded.shaded(&truth.reference.visibility)?,
            runs,
        })
    }
}

/// Ratios need both sides by the same clock: if one run is timed by the wall clock, all are.
fn use_one_clock(rendered: &mut [Rendered]) {
    if rendered.iter().any(|r| r.cost.timing == Timing::Wall) {
        for Rendered { cost, .. } in rendered {
            (cost.total_ms, cost.timing) = (cost.wall_ms, Timing::Wall);
        }
    }
}

/// Fraction of the valid pixels in penumbra.
fn penumbra(truth: &Truth) -> f64 {
    let reference = &truth.reference;
    let valid = || reference.visibility.iter().zip(&reference.valid).filter(|(_, valid)| **valid);
    valid().filter(|(v, _)| PENUMBRA.contains(v)).count() as f64 / valid().count().max(1) as f64
}
