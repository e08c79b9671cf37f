//! Results of a comparison.

use crate::measure::Cost;
use antumbra_metrics::{ErrorMetrics, Metrics, RgbImage};
use serde::Serialize;

/// Results of a comparison. Images are row-major with row 0 on top.
#[derive(Clone, Debug, Serialize)]
pub struct Comparison {
    /// Name of the scene on the command line.
    pub scene: String,
    /// Triangles of the scene.
    pub triangles: u64,
    /// Width of every image, pixels.
    pub width: u32,
    /// Height of every image, pixels.
    pub height: u32,
    /// Name of the adapter.
    pub adapter: String,
    /// Whether the adapter computes on the CPU, so that its milliseconds say nothing about a GPU.
    pub software: bool,
    /// The command line.
    pub command: String,
    /// The ray-traced reference.
    pub truth: Reference,
    /// The techniques in the order of the command line; at least one.
    #[serde(skip)]
    pub entries: Vec<Entry>,
}

/// The ray-traced reference.
#[derive(Clone, Debug, Serialize)]
pub struct Reference {
    /// Visibility in [0, 1], `width * height` values.
    #[serde(skip)]
    pub visibility: Vec<f32>,
    /// The scene shaded with the reference visibility.
    #[serde(skip)]
    pub image: RgbImage,
    /// Shadow rays per pixel.
    pub light_samples: u32,
    /// Primary rays per pixel.
    pub pixel_samples: u32,
    /// Wall time of the tracer, seconds.
    pub seconds: f64,
    /// The tracer's estimate of its own error in visibility, root mean square.
    pub error_estimate: f64,
    /// One line for the terminal.
    #[serde(skip)]
    pub summary: String,
}

/// One technique with one choice of settings.
#[derive(Clone, Debug, Serialize)]
pub struct Entry {
    /// Name on the command line.
    pub technique: String,
    /// Descriptive name.
    pub title: String,
    /// The paper: authors, year.
    pub source: String,
    /// Name and settings as given on the command line.
    pub spec: String,
    /// All settings, as an object.
    pub settings: serde_json::Value,
    /// Error metrics.
    #[serde(rename = "figures")]
    pub metrics: Metrics,
    /// Errors where the light is grazing, which `metrics` leave out; `None` without such pixels.
    pub grazing: Option<ErrorMetrics>,
    /// Time and memory.
    #[serde(skip)]
    pub cost: Cost,
    /// The scene shaded with this visibility.
    #[serde(skip)]
    pub image: RgbImage,
    /// Visibility in [0, 1], `width * height` values.
    #[serde(skip)]
    pub visibility: Vec<f32>,
    /// Signed error in the colours of [`antumbra_metrics::heat_map`].
    #[serde(skip)]
    pub heat_map: RgbImage,
}

impl Comparison {
    /// A short unique name for each entry: the technique's, or the SPEC where a technique occurs twice.
    pub(super) fn labels(&self) -> Vec<String> {
        let mut labels: Vec<String> = Vec::with_capacity(self.entries.len());
        for entry in &self.entries {
            let same = self.entries.iter().filter(|other| other.technique == entry.technique).count();
            let base = if same == 1 { &entry.technique } else { &entry.spec };
            let earlier = self.entries[..labels.len()].iter().filter(|other| other.spec == entry.spec).count();
            labels.push(if same > 1 && earlier > 0 { format!("{base} ({})", earlier + 1) } else { base.clone() });
        }
        labels
    }
}
