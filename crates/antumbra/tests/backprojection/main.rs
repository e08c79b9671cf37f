//! Layered back-projection against closed forms and the ray-traced truth: umbrae without gaps, overlapping occluders,
//! lights of all sizes, both ways to walk the pyramid, and pictures that move.

#[path = "../common/mod.rs"]
mod common;

mod joins;
mod lights;
mod planes;
mod scenes;
mod steady;

use antumbra_metrics::Metrics;
use antumbra_reference::Reference;
use antumbra_scene::Scene;
use common::{compared, drawn, shadowed, technique, truth};

/// A scene that is drawn once, with its truth.
struct Judged {
    renderer: antumbra::scene::SceneRenderer,
    truth: Reference,
    name: String,
}

impl Judged {
    fn new(scene: &Scene, size: [u32; 2], light_samples: u32) -> Judged {
        Judged { renderer: drawn(scene, size), truth: truth(scene, size, light_samples), name: scene.name.clone() }
    }

    fn builtin(spec: &str, size: [u32; 2], light_samples: u32) -> Judged {
        Judged::new(&common::builtin(spec), size, light_samples)
    }

    fn picture(&self, spec: &str) -> Vec<f32> {
        shadowed(&self.renderer, &mut technique(spec)).unwrap_or_else(|e| panic!("{} by {spec}: {e}", self.name))
    }

    fn metrics(&self, spec: &str) -> Metrics {
        compared(&self.picture(spec), &self.truth)
    }

    /// Pixels that the truth says something of, all within `radius` pixels of which are as `class` says.
    fn all_around(&self, radius: i32, class: impl Fn(f32) -> bool) -> Vec<usize> {
        let (w, h) = (self.truth.width as i32, self.truth.height as i32);
        let is = |x: i32, y: i32| {
            let i = (y.clamp(0, h - 1) * w + x.clamp(0, w - 1)) as usize;
            self.truth.valid[i] && class(self.truth.visibility[i])
        };
        let around = |x: i32, y: i32| (-radius..=radius).all(|dy| (-radius..=radius).all(|dx| is(x + dx, y + dy)));
        (0..w * h).filter(|i| around(i % w, i / w)).map(|i| i as usize).collect()
    }
}

/// The largest difference of two pictures.
fn largest_difference(a: &[f32], b: &[f32]) -> f32 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}
