//! Results of an experiment.

use crate::Error;
use crate::measure::{Cost, Rendered};
use crate::page::text;
use crate::truth::Truth;
use antumbra::Spec;
use antumbra_metrics::{Metrics, RgbImage};
use serde::Serialize;
use std::collections::BTreeMap;

/// A scene at one size and the results of several techniques, measured next to each other.
#[derive(Clone, Debug, Serialize)]
pub struct Trial {
    /// Name in the suite.
    pub name: String,
    /// Name of the scene.
    pub scene: String,
    /// Triangles of the scene.
    pub triangles: usize,
    /// Width of the image, pixels.
    pub width: u32,
    /// Height of the image, pixels.
    pub height: u32,
    /// Fraction of the valid pixels whose reference is within 0.01..0.99.
    pub penumbra: f64,
    /// Shadow rays per pixel of the reference.
    pub light_samples: u32,
    /// Primary rays per pixel of the reference.
    pub pixel_samples: u32,
    /// The tracer's estimate of its own error in visibility, root mean square.
    pub truth_error: f64,
    /// Timed frames of each technique; with 0 the times include the preparations of the first frame.
    pub frames: u32,
    /// The scene shaded with the reference.
    #[serde(skip)]
    pub image: RgbImage,
    /// One entry per technique.
    pub runs: Vec<Run>,
}

/// One technique on one scene.
#[derive(Clone, Debug, Serialize)]
pub struct Run {
    /// Name of the technique.
    pub technique: &'static str,
    /// Name and settings as a user types them.
    pub spec: String,
    /// All settings.
    pub settings: serde_json::Value,
    /// Error metrics.
    #[serde(rename = "figures")]
    pub metrics: Metrics,
    /// The technique's statistics, such as the number of maps.
    #[serde(rename = "work")]
    pub stats: BTreeMap<&'static str, f64>,
    /// Time and memory.
    #[serde(flatten)]
    pub cost: Cost,
    /// The scene shaded with the technique's visibility, if the report shows it.
    #[serde(skip)]
    pub image: Option<RgbImage>,
}

/// Consecutive groups of trials with these numbers of members; fewer where trials are missing.
pub fn split<const N: usize>(trials: &[Trial], counts: [usize; N]) -> [&[Trial]; N] {
    let mut rest = trials;
    counts.map(|count| {
        let (group, others) = rest.split_at(count.min(rest.len()));
        rest = others;
        group
    })
}

impl Trial {
    /// The run of this SPEC.
    pub fn run(&self, spec: &str) -> Option<&Run> {
        self.runs.iter().find(|run| run.spec == spec)
    }

    /// Each run with the trial, as a row of a table.
    pub fn rows(&self) -> impl Iterator<Item = (&Trial, &Run)> {
        self.runs.iter().map(move |run| (self, run))
    }

    /// Size of the image as text.
    pub fn pixels(&self) -> String {
        format!("{} x {} pixels", self.width, self.height)
    }

    /// Number of pixels.
    pub fn pixel_count(&self) -> f64 {
        f64::from(self.width) * f64::from(self.height)
    }

    /// Name and description, a title in a table.
    pub fn heading(&self) -> String {
        format!("{}: {}", self.name, self.description())
    }

    /// The scene, its size, and the reference's error.
    pub fn description(&self) -> String {
        format!(
            "{}, {} triangles, {:.1} % penumbra, truth ± {}",
            self.scene,
            text::count(self.triangles as u64),
            100.0 * self.penumbra,
            text::metric(self.truth_error)
        )
    }
}

impl Run {
    /// The result of a technique beside the reference.
    pub fn new(spec: &Spec, rendered: Rendered, image: Option<RgbImage>, truth: &Truth) -> Result<Run, Error> {
        Ok(Run {
            technique: spec.technique.name,
            spec: spec.text.clone(),
            settings: spec.settings.clone(),
            metrics: truth.metrics(&spec.text, &rendered.visibility)?,
            stats: rendered.stats,
            cost: rendered.cost,
            image,
        })
    }

    /// Milliseconds of `base`, a run of the same trial, over these.
    pub fn speed_over(&self, base: &Run) -> f64 {
        base.cost.total_ms / self.cost.total_ms
    }

    /// Milliseconds, with a star for wall time.
    pub fn ms(&self) -> String {
        text::ms(self.cost.total_ms) + self.cost.timing.mark()
    }

    /// A statistic as a whole number, or a dash.
    pub fn count(&self, stat: &str) -> String {
        text::or_dash(self.stats.get(stat).map(|n| text::count(n.round() as u64)))
    }
}
