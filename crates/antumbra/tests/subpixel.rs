//! `subpixel` against rays through the same samples of every pixel, and what its settings promise.

mod common;

use antumbra::techniques::alias_free::subpixel::SubpixelSettings;
use antumbra::{Error, Spec};
use antumbra_reference::{Reference, trace_centre};
use antumbra_scene::Scene;
use common::*;
use glam::Vec2;
use pollster::block_on;
use std::collections::BTreeMap;

const SIZE: [u32; 2] = [160, 120];

/// A built-in scene under a point light.
fn under_point(name: &str) -> Scene {
    let mut scene = builtin(name);
    scene.light.size = Vec2::ZERO;
    scene
}

/// The places of a SPEC's samples in a pixel.
fn places(spec: &str) -> Vec<Vec2> {
    let spec: Spec = spec.parse().unwrap_or_else(|e| panic!("{e}"));
    let settings: SubpixelSettings = serde_json::from_value(spec.settings).expect("its own settings");
    settings.pattern().expect("a pattern").samples().iter().map(|s| s.as_vec2() + 0.5).collect()
}

struct Drawn {
    visibility: Vec<f32>,
    stats: BTreeMap<&'static str, f64>,
}

/// The third frame, whose lists have the capacity that the first one needed.
fn drawn_by(scene: &Scene, spec: &str) -> Drawn {
    drawn_after(scene, spec, 2)
}

/// The frame after so many others.
fn drawn_after(scene: &Scene, spec: &str, frames: u32) -> Drawn {
    let renderer = drawn(scene, SIZE);
    let mut technique = technique(spec);
    for _ in 0..frames {
        shadowed(&renderer, &mut technique).unwrap_or_else(|e| panic!("{spec}: {e}"));
        gpu().wait().expect("the device is there");
    }
    let visibility = shadowed(&renderer, &mut technique).unwrap_or_else(|e| panic!("{spec}: {e}"));
    let stats = block_on(technique.stats(gpu())).expect("counts").into_iter().collect();
    Drawn { visibility, stats }
}

fn differences(drawn: &Drawn, rays: &Reference) -> Vec<f64> {
    let each = drawn.visibility.iter().zip(&rays.visibility).zip(&rays.valid);
    each.filter(|(_, valid)| **valid).map(|((a, b), _)| f64::from((a - b).abs())).collect()
}

/// Mean difference over silhouette pixels.
fn off(scene: &Scene, spec: &str) -> (f64, Drawn) {
    let rays = trace_centre(scene, SIZE, &places(spec)).unwrap_or_else(|e| panic!("{e}"));
    let drawn = drawn_by(scene, spec);
    let sum: f64 = differences(&drawn, &rays).iter().sum();
    (sum / drawn.stats["silhouette pixels"], drawn)
}

#[test]
fn on_planes_only_the_rounding_of_lines_differs_from_rays() {
    let square = |scene: &Scene, spec: &str| {
        let (mean, drawn) = off(scene, spec);
        let partial = drawn.visibility.iter().filter(|v| **v > 0.0 && **v < 1.0).count();
        println!(
            "{spec}: {mean:.5} over {} silhouette pixels, {partial} partly in shadow",
            drawn.stats["silhouette pixels"]
        );
        assert!(mean < 0.005 && partial > 50, "{spec}: {mean} over silhouettes, {partial} partly in shadow");
    };
    let plate = scene(
        vec![ground(20.0), quad([0.1, 1.0, -0.05], [0.83, 0.61])],
        camera([2.6, 2.2, 3.1], [0.3, 0.0, 0.2], 40.0),
        light([1.3, 5.0, 1.1], [0.0, 0.0, 0.0], 0.0),
    );
    for samples in [8, 16, 32, 64, 128] {
        square(&plate, &format!("subpixel:statistics=true,samples={samples}"));
    }
    square(&plate, "subpixel:statistics=true,pattern=grid");
    square(&plate, "subpixel:statistics=true,points=0.5 0.5;0.125 0.25;0.75 0.0625;0.3 0.8;0.9 0.7");
    square(&under_point("fence"), "subpixel:statistics=true");
}

#[test]
fn one_sample_is_the_hard_shadow_of_the_middle() {
    for name in ["fence", "plant", "cage"] {
        let scene = under_point(name);
        let [one, exact] = ["subpixel:samples=1", "alias-free"].map(|spec| drawn_by(&scene, spec).visibility);
        let differing = one.iter().zip(&exact).filter(|(a, b)| a != b).count();
        println!("{name}: {differing} of {} pixels differ", one.len());
        assert!(differing * 2000 <= one.len(), "{name}: {differing} of {} pixels", one.len());
    }
}

#[test]
fn curved_receivers_are_within_what_cannot_be_seen() {
    let (mean, _) = off(&under_point("spheres:segments=48"), "subpixel:statistics=true");
    println!("spheres: {mean:.5} over silhouette pixels");
    // The paper's figure 8 shows differences that are faint ten times enlarged: a twentieth of the range.
    assert!(mean < 0.02, "{mean} over silhouette pixels");
}

#[test]
fn invalid_samples_are_those_that_would_darken_a_bumpy_receiver() {
    let scene = under_point("bumpy");
    let rays = trace_centre(&scene, SIZE, &places("subpixel")).unwrap_or_else(|e| panic!("{e}"));
    let [masked, all] = [true, false].map(|on| drawn_by(&scene, &format!("subpixel:statistics=true,validity={on}")));
    let [with, without] = [&masked, &all].map(|d| differences(d, &rays).iter().sum::<f64>());
    let valid = masked.stats["valid samples partly in shadow"];
    println!(
        "bumpy: {valid:.1} of 32 samples valid; differences {with:.1} with the validity mask, {without:.1} without"
    );
    // The paper's bumpy receiver: 18.5 of 32, of pixels at a shadow's boundary.
    assert!((15.0..25.0).contains(&valid), "{valid} of 32 samples are valid");
    assert!(with < 0.25 * without, "{with} with the mask, {without} without");
    assert_eq!(all.stats["valid samples"], 32.0);
}

#[test]
fn the_map_only_groups_the_work() {
    // In `atrium` walls that the light would see at a grazing angle lie in the shadow of a roof far above.
    for (name, most_mean, most_pixels) in [("fence", 1e-4, 0.001), ("atrium", 2e-3, 0.003)] {
        let scene = under_point(name);
        let [coarse, fine] = [128, 1024].map(|map| drawn_by(&scene, &format!("subpixel:map={map}")).visibility);
        let off: Vec<f64> = coarse.iter().zip(&fine).map(|(a, b)| f64::from((a - b).abs())).collect();
        let (mean, many) = (off.iter().sum::<f64>() / off.len() as f64, off.iter().filter(|d| **d > 0.1).count());
        println!("{name}: mean {mean:.6}, {many} of {} pixels by over a tenth", off.len());
        assert!(
            mean < most_mean && (many as f64) < most_pixels * off.len() as f64,
            "{name}: mean {mean}, {many} pixels"
        );
    }
}

#[test]
fn lists_that_exceed_the_budget_are_made_strip_by_strip() {
    // A plain seen at a grazing angle: a pixel covers many texels of a fine map.
    let scene = under_point("fence");
    for filter in ["box", "gaussian"] {
        let spec = |budget| format!("subpixel:filter={filter},map=2048,statistics=true,budget={budget}");
        let [small, large] = [1, 256].map(|budget| drawn_after(&scene, &spec(budget), 8));
        assert!(small.stats["strips"] > 1.0, "{:?}", small.stats);
        assert_eq!(large.stats["strips"], 1.0);
        let differing = small.visibility.iter().zip(&large.visibility).filter(|(a, b)| a != b).count();
        assert_eq!(differing, 0, "{filter}: pixels differ between {} strips and one", small.stats["strips"]);
    }
}

#[test]
fn a_gaussian_is_smoother_than_a_box_and_as_bright() {
    let scene = under_point("fence");
    let [sharp, soft] = ["box", "gaussian"].map(|f| drawn_by(&scene, &format!("subpixel:filter={f}")).visibility);
    let mean = |v: &[f32]| v.iter().map(|v| f64::from(*v)).sum::<f64>() / v.len() as f64;
    let steps = |v: &[f32]| {
        let row = SIZE[0] as usize;
        v.chunks_exact(row).flat_map(|r| r.windows(2)).map(|w| f64::from((w[0] - w[1]).powi(2))).sum::<f64>()
    };
    println!("means {:.4} {:.4}, squared steps {:.0} {:.0}", mean(&sharp), mean(&soft), steps(&sharp), steps(&soft));
    assert!((mean(&sharp) - mean(&soft)).abs() < 0.01, "{} {}", mean(&sharp), mean(&soft));
    assert!(steps(&soft) < 0.95 * steps(&sharp), "{} {}", steps(&soft), steps(&sharp));
}

#[test]
fn a_pattern_without_a_middle_is_refused() {
    let spec: Spec = "subpixel:points=0.25 0.25;0.75 0.75".parse().expect("is two points");
    let error = spec.make(gpu()).err().expect("must be refused");
    assert!(matches!(error, Error::Pattern { .. }) && error.to_string().contains("middle"), "{error}");
}
