//! A square parallel to the light over the ground, whose shadow has a closed form.

use crate::common::closed_form::Over;
use crate::common::{camera, compared, light, truth};
use crate::{SIZE, in_range};

/// Mean absolute difference to the closed form over shadow and penumbra, and the largest one.
fn error(over: &Over, edge: f32, spec: &str) -> (f64, f64) {
    let scene = over.scene(camera([1.2, 2.4, 2.6], [0.0, 0.0, 0.0], 50.0), light([0.0, 3.0, 0.0], [0.0; 3], edge));
    let exact = over.picture(&scene, SIZE);
    let picture = in_range(&scene, spec);
    let (mut sum, mut largest, mut count) = (0.0, 0.0f64, 0);
    for (exact, v) in exact.iter().zip(&picture) {
        let Some(exact) = exact else { continue };
        let d = (f64::from(*v) - exact).abs();
        (sum, largest) = (sum + d, largest.max(d));
        count += usize::from(*exact < 0.999);
    }
    assert!(count > 100, "the shadow is in the picture");
    (sum / count as f64, largest)
}

const OVER: Over = Over { center: [0.1, 1.0, -0.05], half: [0.45, 0.35] };

#[test]
fn the_square_agrees_with_its_closed_form() {
    // The square's edges lie along the map's, so a texel's share of the square is all or nothing: up to half a texel.
    for (spec, mean, largest) in [
        ("ssm:map=128,hierarchy=false,passes=1", 0.02, 0.06),
        ("ssm:map=512,hierarchy=false,passes=1", 0.006, 0.02),
        ("ssm:map=512,window=16", 0.01, 0.06),
        ("ssm", 0.015, 0.09),
    ] {
        let found = error(&OVER, 0.8, spec);
        assert!(found.0 < mean && found.1 < largest, "{spec}: mean and largest error {found:?}");
    }
}

#[test]
fn one_pass_and_two_give_the_same_of_a_square() {
    for rest in ["", ",hierarchy=false"] {
        let [one, two] = [1, 2].map(|passes| error(&OVER, 0.8, &format!("ssm:map=100,passes={passes}{rest}")));
        assert_eq!(one, two, "{rest}");
    }
}

#[test]
fn a_line_and_a_point_of_light_are_lights() {
    let scene = |size: [f32; 2]| {
        let mut light = light([0.0, 3.0, 0.0], [0.0; 3], 0.0);
        light.size = size.into();
        OVER.scene(camera([1.2, 2.4, 2.6], [0.0, 0.0, 0.0], 50.0), light)
    };
    for size in [[0.0, 0.0], [0.8, 0.0], [0.0, 0.8], [1.6, 0.1]] {
        let scene = scene(size);
        let exact = truth(&scene, SIZE, 1024);
        for spec in ["ssm:map=512", "ssm:map=512,window=16"] {
            let figures = compared(&in_range(&scene, spec), &exact);
            assert!(figures.rmse < 0.05, "{spec}, light {size:?}: {figures:?}");
        }
    }
}
