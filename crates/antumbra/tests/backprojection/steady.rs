//! Slow moves of the camera and of the light: a pixel changes by little more from frame to frame than its truth does.

use crate::common::{builtin, gpu, shadowed, submit, technique, truth};
use antumbra::{ShadowFrustum, View};
use antumbra_scene::Scene;
use glam::Vec3;

const SIZE: [u32; 2] = [64, 48];
const FRAMES: usize = 8;

const CAMERA: [f32; 3] = [0.025, 0.035, 0.06];
const LIGHT: [f32; 3] = [0.03, 0.04, 0.06];

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

/// Each frame of a scene that changes with time, from 0 to 1, by one instance.
fn jumps(spec: &str, scene_of: impl Fn(f32) -> Scene) -> Jumps {
    let first = scene_of(0.0);
    let mut renderer = crate::common::drawn(&first, SIZE);
    // One frustum for all frames, wider than what the first sees: what is out of it is lit.
    let fit = renderer.frame.frustum;
    let frustum = ShadowFrustum { tan_half: 1.15 * fit.tan_half, ..fit };
    let (mut shadow, mut control) = (technique(spec), technique("uniform-sampling:samples=16,map=512"));
    let mut shot = |i: usize| {
        let scene = scene_of(i as f32 / FRAMES as f32);
        renderer.frame.update(View::of_camera(&scene.camera, SIZE), scene.light, frustum);
        submit(|encoder| renderer.record_geometry(gpu(), encoder, None)).unwrap_or_else(|e| panic!("{e}"));
        let [visibility, control] = [&mut shadow, &mut control]
            .map(|technique| shadowed(&renderer, technique).unwrap_or_else(|e| panic!("{spec}: {e}")));
        let mut truth = truth(&scene, SIZE, 256);
        // What many maps too find far from the truth is a pixel whose middle the rasteriser gives to another surface.
        let values = truth.visibility.iter().zip(&control);
        truth.valid.iter_mut().zip(values).for_each(|(valid, (t, c))| *valid &= (t - c).abs() < 0.25);
        (visibility, truth)
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

/// The change of 99.9 % of all pixels of all frames, of 99.99 %, and of the worst stays within these bounds.
fn check(what: &str, scene_of: impl Fn(f32) -> Scene, bounds: [f32; 3]) {
    let jumps = jumps("backprojection:quality=balanced", &scene_of);
    let most = [jumps.at(0.999), jumps.at(0.9999), jumps.worst.0];
    let (_, frame, pixel) = jumps.worst;
    let text = format!("{what}: 99.9 %, 99.99 %, worst {most:.4?} (frame {frame}, pixel {pixel}), bounds {bounds:?}");
    println!("{text}");
    assert!(most.iter().zip(&bounds).all(|(most, bound)| most <= bound), "{text}");
}

/// Spheres under a light that drifts, seen by a camera that comes nearer: along the view, so that surfaces stay where
/// they are in the picture.
fn drifting(light: f32, camera: f32) -> Scene {
    let mut scene = builtin("spheres:segments=32");
    scene.light.center += light * Vec3::new(0.038, 0.005, 0.025);
    scene.camera.eye += camera * 0.007 * (scene.camera.target - scene.camera.eye);
    scene
}

#[test]
fn a_slow_camera_sees_no_jumps() {
    check("camera", |t| drifting(0.0, t), CAMERA);
}

#[test]
fn a_slow_light_makes_no_jumps() {
    check("light", |t| drifting(t, 0.0), LIGHT);
}
