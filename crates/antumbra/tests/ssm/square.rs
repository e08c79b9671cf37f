//! A square parallel to the light over the ground, whose shadow has a closed form.

use crate::common::closed_form::{Occluder, ground_points};
use crate::common::{camera, drawn, light};
use crate::{SIZE, in_range};
use antumbra_scene::Scene;
use glam::DVec3;

/// Differences between the visibility of a square's scene and its closed form.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Difference {
    /// Mean absolute difference over shadow and penumbra.
    mean: f64,
    largest: f64,
    /// Fraction of the pixels in shadow or penumbra that are not counted.
    excluded: f64,
}

/// A square over the ground under a light with these edges, in metres.
fn square(occluder: &Occluder, light_size: [f32; 2]) -> Scene {
    let mut light = light([0.0, 3.0, 0.0], [0.0; 3], 0.0);
    light.size = light_size.into();
    occluder.scene(camera([1.2, 2.4, 2.6], [0.0, 0.0, 0.0], 50.0), light)
}

/// Where an edge of the light has no length, the shadow has a hard edge, which the map places up to a texel off. Pixels
/// within a texel of a hard edge are not counted.
fn error(occluder: &Occluder, light_size: [f32; 2], map: u32, rest: &str) -> Difference {
    let scene = square(occluder, light_size);
    let exact = occluder.image(&scene, SIZE);
    let points = ground_points(&scene.camera, SIZE);
    let visibility = in_range(&scene, &format!("ssm:map={map}{rest}"));
    let tan_half = drawn(&scene, SIZE).frame.frustum.tan_half.as_dvec2();
    let texel = 2.0 * tan_half / f64::from(map) * f64::from(scene.light.center.y);
    let (mut sum, mut largest, mut counted, mut excluded) = (0.0, 0.0f64, 0, 0);
    for ((exact, point), v) in exact.iter().zip(&points).zip(&visibility) {
        let (Some(exact), Some(p)) = (exact, point) else { continue };
        let in_shadow = *exact < 0.999;
        let beside = |axis: DVec3| [p - axis, p + axis].map(|p| occluder.visibility(&scene.light, p));
        let ends = |edge: f32, axis: DVec3| edge == 0.0 && beside(axis).iter().any(|v| v != exact);
        if ends(light_size[0], DVec3::X * texel.x) || ends(light_size[1], DVec3::Z * texel.y) {
            excluded += usize::from(in_shadow);
            continue;
        }
        let d = (f64::from(*v) - exact).abs();
        (sum, largest) = (sum + d, largest.max(d));
        counted += usize::from(in_shadow);
    }
    assert!(counted > 100, "only {counted} pixels of shadow, and {excluded} beside a hard edge");
    let excluded = excluded as f64 / (counted + excluded) as f64;
    Difference { mean: sum / counted as f64, largest, excluded }
}

const OCCLUDER: Occluder = Occluder { center: [0.1, 1.0, -0.05], half: [0.45, 0.35] };

#[test]
fn the_square_agrees_with_its_closed_form() {
    // The square's edges lie along the map's, so a texel's share of the square is all or nothing: up to half a texel.
    for (map, rest, mean, largest) in [
        (128, ",hierarchy=false,passes=1", 0.02, 0.06),
        (512, ",hierarchy=false,passes=1", 0.006, 0.02),
        (512, ",window=16", 0.01, 0.06),
        (512, "", 0.015, 0.09),
    ] {
        let found = error(&OCCLUDER, [0.8; 2], map, rest);
        assert!(found.mean < mean && found.largest < largest, "map={map}{rest}: {found:?}");
    }
}

#[test]
fn one_pass_and_two_give_the_same_of_a_square() {
    for rest in ["", ",hierarchy=false"] {
        let [one, two] = [1, 2].map(|passes| error(&OCCLUDER, [0.8; 2], 100, &format!(",passes={passes}{rest}")));
        assert_eq!(one, two, "{rest}");
    }
}

#[test]
fn a_line_and_a_point_of_light_are_lights() {
    for (light_size, mean, largest, excluded) in [
        ([0.0, 0.0], 1e-4, 0.002, 0.02),
        ([0.8, 0.0], 0.002, 0.01, 0.015),
        ([0.0, 0.8], 0.0035, 0.012, 0.01),
        ([1.6, 0.1], 0.0033, 0.033, 0.0),
    ] {
        for rest in ["", ",window=16"] {
            let found = error(&OCCLUDER, light_size, 512, rest);
            let holds = found.mean < mean && found.largest < largest && found.excluded <= excluded;
            assert!(holds, "light {light_size:?}, map=512{rest}: {found:?}");
        }
    }
}
