//! `alias-free` and `alias-free-soft` against the truth: on every built-in scene, whatever the map, and where lists
//! overflow.

#[path = "../common/mod.rs"]
mod common;

mod hard;
mod overflow;
mod soft;

use antumbra_scene::Scene;
use glam::Vec2;

/// A scene whose light is a point at its centre.
fn with_point_light(mut scene: Scene) -> Scene {
    scene.light.size = Vec2::ZERO;
    scene
}

/// Pixels where two pictures differ by more than rounding, of those where errors are measured.
fn differing(a: &[f32], b: &[f32], valid: &[bool]) -> usize {
    (0..a.len()).filter(|&i| valid[i] && (a[i] - b[i]).abs() > 1e-3).count()
}
