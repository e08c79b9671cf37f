//! `alias-free` and `alias-free-soft` against the truth: on every built-in scene, with maps of all sizes, and where
//! lists overflow.

#[path = "../common/mod.rs"]
mod common;

mod hard;
mod overflow;
mod soft;

use antumbra_scene::Scene;
use glam::Vec2;

/// The scene with its light reduced to a point at the light's centre.
fn with_point_light(mut scene: Scene) -> Scene {
    scene.light.size = Vec2::ZERO;
    scene
}

/// Number of valid pixels where two visibility images differ by more than rounding.
fn differing(a: &[f32], b: &[f32], valid: &[bool]) -> usize {
    (0..a.len()).filter(|&i| valid[i] && (a[i] - b[i]).abs() > 1e-3).count()
}
