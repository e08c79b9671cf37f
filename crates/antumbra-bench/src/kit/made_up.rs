//! Runs and trials with made-up numbers, for the tests of suites.

use super::trial::{Run, Trial};
use crate::measure::{Cost, Timing};
use antumbra_metrics::{Image, RgbImage, metrics};

/// A run of this time; technique and metrics are arbitrary.
pub fn run(spec: &str, ms: f64, stats: &[(&'static str, f64)]) -> Run {
    let (test, truth) = ([0.5, 0.25, 1.0, 0.0], [0.5, 0.5, 1.0, 0.0]);
    let image = |values| Image::new(2, 2, values).unwrap();
    Run {
        technique: "pcf",
        spec: spec.into(),
        settings: serde_json::json!({"map": 512}),
        metrics: metrics(image(&test), image(&truth), &[true; 4]).unwrap(),
        stats: stats.iter().copied().collect(),
        cost: Cost { passes: Vec::new(), total_ms: ms, total_bytes: 1 << 20, wall_ms: 2.0 * ms, timing: Timing::Gpu },
        image: None,
    }
}

/// A trial of these runs.
pub fn trial(name: &str, runs: Vec<Run>) -> Trial {
    Trial {
        name: name.into(),
        scene: "builtin:fence".into(),
        triangles: 4662,
        width: 2,
        height: 2,
        penumbra: 0.08,
        light_samples: 1024,
        pixel_samples: 16,
        truth_error: 0.001,
        frames: 3,
        image: RgbImage { width: 2, height: 2, data: vec![200; 12] },
        runs,
    }
}
