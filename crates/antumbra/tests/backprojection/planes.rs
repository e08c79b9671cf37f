//! A single plane over the ground: its patches touch each other on the light at every tilt.

use crate::Judged;
use crate::common::{camera, ground, light, quad, scene};
use antumbra_metrics::UMBRA_BELOW;
use antumbra_scene::Scene;
use glam::{Mat3, Vec3};

const SIZE: [u32; 2] = [64, 64];

/// A square of 1.6 m that is tilted about an axis askew to the map's. Only the ground is seen.
fn tilted(degrees: f32) -> Scene {
    let mut square = quad([0.0; 3], [0.8, 1.6]);
    let turn = Mat3::from_rotation_y(0.4) * Mat3::from_rotation_z(degrees.to_radians());
    square.positions.iter_mut().for_each(|p| *p = turn * *p + Vec3::new(0.0, 1.1, 0.0));
    let (eye, target) = ([1.1, 0.9, 1.5], [-0.4, 0.0, 0.1]);
    // From aside, so that it still casts an umbra where it stands nearly upright.
    let light = light([2.2, 4.0, 0.5], [0.0, 1.0, 0.0], 0.5);
    let name = format!("a plane tilted by {degrees} degrees");
    Scene { name, ..scene(vec![ground(20.0), square], camera(eye, target, 60.0), light) }
}

/// The umbra's brightest pixel, its mean, and its number of pixels. A pixel beside its edge does not count.
fn umbra(judged: &Judged, spec: &str) -> (f32, f32, usize) {
    let (picture, inside) = (judged.picture(spec), judged.all_around(1, |v| v < UMBRA_BELOW));
    let values = || inside.iter().map(|i| picture[*i]);
    (values().fold(0.0, f32::max), values().sum::<f32>() / inside.len().max(1) as f32, inside.len())
}

#[test]
fn an_umbra_of_a_plane_at_any_tilt_has_no_gaps() {
    let mut faults = Vec::new();
    for degrees in [0.0, 20.0, 45.0, 70.0, 85.0] {
        let judged = Judged::new(&tilted(degrees), SIZE, 256);
        for layers in [1, 2] {
            let by = |settings: &str| umbra(&judged, &format!("backprojection:map=512,layers={layers}{settings}"));
            let (brightest, _, count) = by("");
            let open = by(",gaps_filled=false");
            println!(
                "{}, {layers} layers: brightest of {count} pixels {brightest}; with gaps {:.4}, mean {:.4}",
                judged.name, open.0, open.1
            );
            if brightest > 0.0 || count < 50 {
                faults.push(format!("{}, {layers} layers: {brightest} in {count} pixels", judged.name));
            }
        }
    }
    assert!(faults.is_empty(), "{faults:#?}");
}
