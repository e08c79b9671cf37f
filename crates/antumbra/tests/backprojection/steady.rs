//! Slow moves of the camera and of the light: a pixel changes by little more from frame to frame than its truth does.

use crate::common::{builtin, gpu, shadowed, submit, technique, truth};
use antumbra::{ShadowFrustum, View};
use antumbra_scene::Scene;
use glam::Vec3;

const SIZE: [u32; 2] = [96, 72];
const FRAMES: usize = 24;

/// By how much the error of pixels changes from one frame to the next.
struct Jumps {
    sorted: Vec<f32>,
    worst: (f32, usize, usize),
}

impl Jumps {
    fn at(&self, share: f64) -> f32 {
        self.sorted[(share * (self.sorted.len() - 1) as f64) as usize]
    }
}

/// The scene of each frame, seen by one instance. The frustum moves with the light.
fn jumps(spec: &str, scene_of: impl Fn(f32) -> Scene) -> Jumps {
    let first = scene_of(0.0);
    let mut renderer = crate::common::drawn(&first, SIZE);
    let frustum: ShadowFrustum = renderer.frame.frustum;
    let mut shadow = technique(spec);
    let mut shot = |i: usize| {
        let scene = scene_of(i as f32 / FRAMES as f32);
        renderer.frame.update(gpu(), View::of_camera(&scene.camera, SIZE), scene.light, frustum);
        submit(|recorder| renderer.record_geometry(recorder)).unwrap_or_else(|e| panic!("{e}"));
        let visibility = shadowed(&renderer, &mut *shadow).unwrap_or_else(|e| panic!("{spec}: {e}"));
        (visibility, truth(&scene, SIZE, 1024))
    };
    let shots: Vec<_> = (0..=FRAMES).map(&mut shot).collect();
    let mut found = Jumps { sorted: Vec::new(), worst: (0.0, 0, 0) };
    for (frame, pair) in shots.windows(2).enumerate() {
        let [(before, truth_before), (after, truth_after)] = [&pair[0], &pair[1]];
        for i in (0..after.len()).filter(|i| truth_before.valid[*i] && truth_after.valid[*i]) {
            let ours = (after[i] - before[i]).abs();
            let beyond = ours - (truth_after.visibility[i] - truth_before.visibility[i]).abs();
            found.sorted.push(beyond);
            if beyond > found.worst.0 {
                found.worst = (beyond, frame, i);
            }
        }
    }
    found.sorted.sort_by(f32::total_cmp);
    found
}

fn check(what: &str, scene_of: impl Fn(f32) -> Scene, worst: f32, most: f32) {
    for spec in ["backprojection:quality=balanced", "packet:quality=balanced"] {
        let jumps = jumps(spec, &scene_of);
        let (beyond, frame, pixel) = jumps.worst;
        println!(
            "{what} by {spec}: worst {beyond:.4} (frame {frame}, pixel {pixel}), 99 % {:.4}, 99.9 % {:.4}, 99.99 % {:.4}",
            jumps.at(0.99),
            jumps.at(0.999),
            jumps.at(0.9999)
        );
        assert!(beyond <= worst, "{what} by {spec}: {beyond} in frame {frame} at pixel {pixel}");
        assert!(jumps.at(0.999) <= most, "{what} by {spec}: 99.9 % {}", jumps.at(0.999));
    }
}

#[test]
fn a_slow_camera_sees_no_jumps() {
    // Along the view, so that surfaces stay where they are in the picture but for what the eye's nearness changes.
    let scene_of = |t: f32| {
        let mut scene = builtin("spheres:segments=32");
        let to_target = scene.camera.target - scene.camera.eye;
        scene.camera.eye += 0.02 * t * to_target;
        scene
    };
    check("camera", scene_of, 0.2, 0.1);
}

#[test]
fn a_slow_light_makes_no_jumps() {
    let scene_of = |t: f32| {
        let mut scene = builtin("spheres:segments=32");
        let shift = Vec3::new(0.15, 0.02, 0.1) * t;
        scene.light.center += shift;
        scene
    };
    check("light", scene_of, 0.2, 0.05);
}
