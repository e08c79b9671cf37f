//! The report of `antumbra compare`: one page that needs nothing else, the figures as JSON and CSV, and the pictures.
//!
//! [`write`] is all that there is to call for it; other pages are made of the same parts. A page is made of compile-time templates, a style sheet and a script that
//! lie beside this file; the pictures are embedded in it.

mod axes;
mod cards;
mod files;
pub mod frame;
pub mod lines;
mod page;
pub mod pictures;
pub mod plot;
pub mod text;

#[cfg(test)]
mod tests;

use std::path::PathBuf;

use antumbra_metrics::{Figures, RgbImage};
use serde::Serialize;

pub use files::{place, write};
pub use lines::Lines;
pub use plot::Point;

/// Everything that a comparison has found. Pictures are row-major with row 0 on top.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// The scene as it was named on the command line.
    pub scene: String,
    /// Triangles of the scene.
    pub triangles: u64,
    /// Width of every picture, pixels.
    pub width: u32,
    /// Height of every picture, pixels.
    pub height: u32,
    /// The adapter's name.
    pub adapter: String,
    /// Whether the adapter computes on the CPU, so that its milliseconds say nothing about a GPU.
    pub software: bool,
    /// The command line that made the report.
    pub command: String,
    /// What the techniques are judged by.
    pub truth: Truth,
    /// The techniques, in the order of the command line; at least one.
    #[serde(skip)]
    pub entries: Vec<Entry>,
}

/// The ray-traced truth.
#[derive(Clone, Debug, Serialize)]
pub struct Truth {
    /// Visibility in [0, 1], `width * height` values.
    #[serde(skip)]
    pub visibility: Vec<f32>,
    /// The scene shaded with the true visibility.
    #[serde(skip)]
    pub picture: RgbImage,
    /// Shadow rays a pixel.
    pub light_samples: u32,
    /// Sub-pixels of a pixel.
    pub pixel_samples: u32,
    /// Wall time of the tracer, seconds.
    pub seconds: f64,
    /// The tracer's estimate of its own mean error in visibility.
    pub error_estimate: f64,
}

/// One technique with one choice of settings.
#[derive(Clone, Debug, Serialize)]
pub struct Entry {
    /// Name on the command line.
    pub technique: String,
    /// Name in words.
    pub title: String,
    /// The paper it comes from.
    pub source: String,
    /// Name and settings as given on the command line.
    pub spec: String,
    /// All settings, as an object.
    pub settings: serde_json::Value,
    /// How far it is from the truth.
    pub figures: Figures,
    /// Cost, pass by pass.
    pub passes: Vec<Pass>,
    /// GPU milliseconds of the shadow alone: all passes that are not the host's.
    pub total_ms: f64,
    /// GPU memory that the technique owns, bytes.
    pub total_bytes: u64,
    /// The scene shaded with this visibility.
    #[serde(skip)]
    pub picture: RgbImage,
    /// Visibility in [0, 1], `width * height` values.
    #[serde(skip)]
    pub visibility: Vec<f32>,
    /// Signed error in the colours of [`antumbra_metrics::heat_map`].
    #[serde(skip)]
    pub heat_map: RgbImage,
}

/// One pass of a technique.
#[derive(Clone, Debug, Serialize)]
pub struct Pass {
    /// What it does, in a few words.
    pub name: String,
    /// Median GPU milliseconds.
    pub ms: f64,
    /// GPU memory that it owns, bytes.
    pub bytes: u64,
    /// Whether the host would do it anyway (the geometry buffer), so that it is not in the total.
    pub host: bool,
}

/// Why there is no report.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// The folder or a file cannot be written.
    #[error("cannot write the report's {}: {source}; choose a folder that you may write to with -o", path.display())]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A picture whose size is not the report's.
    #[error("the {picture} of `{spec}` is not {width} x {height} like the report's other pictures")]
    Size {
        /// Which picture.
        picture: &'static str,
        /// Whose picture.
        spec: String,
        /// Width of the report's pictures, pixels.
        width: u32,
        /// Height of the report's pictures, pixels.
        height: u32,
    },
    /// A picture that cannot become a PNG.
    #[error("cannot encode a picture as PNG: {0}")]
    Png(#[from] image::ImageError),
    /// Figures that cannot become JSON.
    #[error("cannot write the figures as JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// Figures that cannot become CSV.
    #[error("cannot write the figures as CSV: {0}")]
    Csv(#[from] csv::Error),
}

impl Report {
    /// One short and unique name an entry: the technique's, or the whole spec where a technique comes twice.
    fn labels(&self) -> Vec<String> {
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
