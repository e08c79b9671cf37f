//! Light sampling by many shadow maps, in a fixed number or refined: images that must be equal, errors against the
//! truth, and the choice of maps.

#[path = "../common/mod.rs"]
mod common;

mod accuracy;
mod identities;
mod refinement;
mod rest;

use antumbra::Shadows;
use antumbra::scene::SceneRenderer;
use antumbra_scene::{RectLight, Scene};
use common::{drawn, gpu, shadowed, technique};
use glam::Vec2;
use pollster::block_on;

/// Size of the images, pixels.
const SIZE: [u32; 2] = [96, 72];

/// A renderer with the geometry buffer of a scene.
fn seen(scene: &Scene) -> SceneRenderer {
    drawn(scene, SIZE)
}

/// Visibility by a technique that may have resources of earlier frames.
fn visibility(renderer: &SceneRenderer, shadows: &mut Shadows) -> Vec<f32> {
    shadowed(renderer, shadows).unwrap_or_else(|e| panic!("{e}"))
}

/// Visibility by a new instance of a technique.
fn fresh(renderer: &SceneRenderer, spec: &str) -> Vec<f32> {
    shadowed(renderer, &mut technique(spec)).unwrap_or_else(|e| panic!("{spec}: {e}"))
}

/// A count of the last frame.
fn stat(shadows: &Shadows, name: &str) -> u32 {
    let stats = block_on(shadows.stats(gpu())).unwrap_or_else(|e| panic!("{e}"));
    let found = stats.iter().find(|(n, _)| *n == name);
    found.unwrap_or_else(|| panic!("no `{name}` among {stats:?}")).1 as u32
}

/// Panics if two images are not equal bit for bit.
fn assert_same(a: &[f32], b: &[f32], what: &str) {
    assert_eq!(a.len(), b.len());
    let places: Vec<usize> = (0..a.len()).filter(|i| a[*i].to_bits() != b[*i].to_bits()).collect();
    if let Some(&i) = places.first() {
        panic!("{what}: {} of {} pixels differ, number {i} is {} and {}", places.len(), a.len(), a[i], b[i]);
    }
}

/// The largest difference of two images.
fn largest_difference(a: &[f32], b: &[f32]) -> f32 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

/// True if part of an image is penumbra and part is lit: many tests would pass if all of it were lit.
fn has_penumbra(image: &[f32]) -> bool {
    let percent = |low: f32, high: f32| image.iter().filter(|v| (low..=high).contains(v)).count() * 100 / image.len();
    percent(0.05, 0.95) >= 2 && percent(0.99, 1.0) >= 10
}

/// A box over the ground, under a tilted light of `size` metres.
fn hovering(size: Vec2) -> Scene {
    let meshes = vec![common::ground(20.0), common::cuboid([-0.5, 0.7, -0.3], [0.4, 1.0, 0.35])];
    let camera = common::camera([1.5, 1.7, 2.6], [0.1, 0.3, 0.1], 42.0);
    let light = RectLight { size, ..common::light([-0.7, 3.2, 0.5], [0.0, 0.3, 0.0], 1.0) };
    Scene {
        name: format!("a box under a light of {} m x {} m", size.x, size.y),
        ..common::scene(meshes, camera, light)
    }
}
