//! Soft shadow maps [Atty 2006] against closed forms, against the truth, and in extreme cases.

#[path = "../common/mod.rs"]
mod common;

mod accumulation;
mod extremes;
mod receivers;
mod square;

use antumbra_scene::Scene;

/// Size of most images, pixels.
const SIZE: [u32; 2] = [96, 72];

/// The visibility of a scene; panics if a pixel is outside of [0, 1].
fn in_range(scene: &Scene, spec: &str) -> Vec<f32> {
    let visibility = common::visibility(scene, spec, SIZE);
    for (i, v) in visibility.iter().enumerate() {
        assert!((0.0..=1.0).contains(v), "{spec}: pixel ({}, {}) is {v}", i as u32 % SIZE[0], i as u32 / SIZE[0]);
    }
    visibility
}

/// The mean and the largest absolute difference.
fn difference(a: &[f32], b: &[f32]) -> (f32, f32) {
    let each = || a.iter().zip(b).map(|(a, b)| (a - b).abs());
    (each().sum::<f32>() / a.len() as f32, each().fold(0.0, f32::max))
}
