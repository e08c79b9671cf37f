//! Lights of all sizes: lines, points, and up to three times as wide as the occluder is far away.

use crate::Judged;
use crate::common::{builtin, camera, cuboid, ground, light, scene};
use antumbra_scene::{RectLight, Scene};
use glam::Vec2;

const SIZE: [u32; 2] = [80, 60];

/// A box over the ground, under a light of `size` metres that shines aslant.
fn hovering(size: Vec2) -> Scene {
    let meshes = vec![ground(20.0), cuboid([-0.5, 0.7, -0.3], [0.4, 1.0, 0.35])];
    let view = camera([1.5, 1.7, 2.6], [0.1, 0.3, 0.1], 42.0);
    let light = RectLight { size, ..light([-0.7, 3.2, 0.5], [0.0, 0.3, 0.0], 1.0) };
    Scene { name: format!("a box under a light of {} m x {} m", size.x, size.y), ..scene(meshes, view, light) }
}

#[test]
fn lines_and_points_are_lights_too() {
    let mut faults = Vec::new();
    for (size, bound, leak) in [
        (Vec2::new(0.9, 0.7), 0.008, 0.001),
        (Vec2::new(1.1, 0.0), 0.002, 0.001),
        (Vec2::new(0.0, 0.8), 0.002, 0.001),
        // The truth is all or nothing, an edge of the map a texel wide: a few pixels lie in it.
        (Vec2::ZERO, 0.003, 0.003),
    ] {
        let judged = Judged::new(&hovering(size), SIZE, 256);
        for spec in ["backprojection:window=16", "packet:window=16"] {
            let f = judged.metrics(spec);
            println!("{} by {spec}: average {:.4}, max {:.3}, leak {:.4}", judged.name, f.average_error, f.max, f.leak);
            if f.average_error > bound || f.leak > leak || f.acne > 0.001 {
                faults.push(format!("{} by {spec}: {f:?}", judged.name));
            }
        }
    }
    assert!(faults.is_empty(), "{faults:#?}");
}

/// Average and largest error over lights from 0.05 to 3 times as wide as the occluder is far from what it shades.
fn sweep(name: &str, scene: &Scene, distance: f32, bound: f64) {
    let mut faults = Vec::new();
    for ratio in [0.05, 0.5, 3.0] {
        let mut scene = scene.clone();
        scene.light.size = Vec2::splat(ratio * distance);
        let f = Judged::new(&scene, SIZE, 256).metrics("backprojection");
        println!(
            "{name}, light of {ratio} times the distance: average {:.4}, max {:.3}, leak {:.4}, acne {:.5}",
            f.average_error, f.max, f.leak, f.acne
        );
        if f.average_error > bound {
            faults.push(format!("{ratio}: {f:?}"));
        }
    }
    assert!(faults.is_empty(), "{name}, bound {bound}: {faults:#?}");
}

#[test]
fn a_fence_under_small_and_large_lights() {
    sweep("fence", &builtin("fence:slats=9"), 1.2, 0.03);
}

#[test]
fn spheres_under_small_and_large_lights() {
    sweep("spheres", &builtin("spheres:segments=16"), 0.8, 0.018);
}
