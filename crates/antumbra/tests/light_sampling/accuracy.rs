//! Against the ray-traced truth. Every pixel counts: the box hovers, so that all penumbrae are many texels wide, and
//! texels of maps from many points meet an edge at many places of it, which leaves little of the raster in the sum.

use crate::common::{builtin, camera, compared, cuboid, ground, light, scene, technique, truth};
use crate::{SIZE, fresh, hovering, seen, stat, visibility};
use antumbra_metrics::Metrics;
use antumbra_reference::Reference;
use antumbra_scene::Scene;
use glam::Vec2;
use std::sync::OnceLock;

const LIGHT: Vec2 = Vec2::new(0.9, 0.7);

/// The hovering box with a truth that is good to 0.0005.
fn boxed() -> &'static (Scene, Reference) {
    static BOXED: OnceLock<(Scene, Reference)> = OnceLock::new();
    BOXED.get_or_init(|| {
        let scene = hovering(LIGHT);
        let truth = truth(&scene, SIZE, 4096);
        (scene, truth)
    })
}

/// Slope of the line that fits best through the logarithms.
fn log_slope(points: &[(f64, f64)]) -> f64 {
    let logs: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let n = logs.len() as f64;
    let (mx, my) = (logs.iter().map(|p| p.0).sum::<f64>() / n, logs.iter().map(|p| p.1).sum::<f64>() / n);
    let covariance: f64 = logs.iter().map(|(x, y)| (x - mx) * (y - my)).sum();
    covariance / logs.iter().map(|(x, _)| (x - mx).powi(2)).sum::<f64>()
}

#[test]
fn many_maps_tend_to_the_truth() {
    let (scene, truth) = boxed();
    let renderer = seen(scene);
    for pattern in ["low-discrepancy", "stratified"] {
        let error = |n: u32| {
            let spec = format!("uniform-sampling:map=256,pcf=1,pattern={pattern},samples={n}");
            compared(&fresh(&renderer, &spec), truth).rmse
        };
        let table = [4, 16, 64, 256, 1024].map(|n| (f64::from(n), error(n)));
        let slope = log_slope(&table);
        println!("{pattern}: (maps, RMSE) {table:.5?}, falls with maps to the power of {slope:.2}");
        assert!((-1.2..=-0.4).contains(&slope), "{pattern}: {table:?} falls with maps to the power of {slope}");
        assert!(table[4].1 < 0.002, "{pattern}: {table:?}");
    }
}

#[test]
fn what_many_maps_leave_is_their_resolution() {
    // The square's edges run along the rows of every map, so that all maps are off by the same part of a texel.
    let scene = builtin("square");
    let (renderer, truth) = (seen(&scene), truth(&scene, SIZE, 4096));
    let error = |map: u32| {
        let spec = format!("uniform-sampling:map={map},pcf=1,samples=256");
        compared(&fresh(&renderer, &spec), &truth).rmse
    };
    let errors = [64, 128, 256].map(error);
    println!("maps of 64, 128, 256 texels: RMSE {errors:.5?}");
    assert!(errors[2] < 0.004 && errors[1] < 0.75 * errors[0] && errors[2] < 0.75 * errors[1], "{errors:?}");
}

#[test]
fn a_light_that_is_a_tenth_larger_is_caught() {
    let (_, truth) = boxed();
    let wrong = fresh(&seen(&hovering(1.1 * LIGHT)), "uniform-sampling:map=256,samples=256");
    let error = compared(&wrong, truth).rmse;
    assert!(error > 0.004, "went through with an RMSE of {error}");
}

#[test]
fn a_refined_light_is_about_as_good_as_one_with_128_maps() {
    for (spec, truth_samples) in [("square", 1024), ("fence:slats=9", 1024), ("spheres:segments=16", 1024)] {
        let scene = builtin(spec);
        let (renderer, truth) = (seen(&scene), truth(&scene, SIZE, truth_samples));
        let uniform = compared(&fresh(&renderer, "uniform-sampling:map=256,samples=128"), &truth).average_error;
        let mut adaptive = technique("adaptive-sampling:map=256");
        let error = compared(&visibility(&renderer, &mut adaptive), &truth).average_error;
        let maps = stat(&adaptive, "maps");
        println!("{spec}: error {error:.4} by {maps} maps, {uniform:.4} by 128 of fixed places");
        assert!(error < uniform + 0.01, "{spec}: error {error} by {maps} maps, {uniform} by 128 of fixed places");
    }
}

/// Metrics and number of maps of a light of `size`.
fn refined(size: Vec2, settings: &str) -> (Metrics, u32) {
    let scene = hovering(size);
    let mut adaptive = technique(&format!("adaptive-sampling:map=256{settings}"));
    let found = visibility(&seen(&scene), &mut adaptive);
    (compared(&found, &truth(&scene, SIZE, 1024)), stat(&adaptive, "maps"))
}

#[test]
fn a_line_is_refined_along_its_only_edge() {
    for size in [Vec2::new(1.1, 0.0), Vec2::new(0.0, 0.8)] {
        for settings in ["", ",filter=pcf,tolerance=0.01"] {
            let (figures, maps) = refined(size, settings);
            println!("{size}{settings}: {maps} maps, error {:.4}, at most {:.3}", figures.average_error, figures.max);
            assert!((5..=17).contains(&maps), "{size}{settings}: {maps} maps");
            assert!(figures.counts.penumbra > 300, "{size}: {:?}", figures.counts);
            let good = figures.average_error < 0.01 && figures.max < 0.05;
            assert!(good, "{size}{settings}: error {}, at most {}", figures.average_error, figures.max);
        }
    }
}

#[test]
fn a_point_takes_one_map() {
    let scene = hovering(Vec2::ZERO);
    let (renderer, truth) = (seen(&scene), truth(&scene, SIZE, 4));
    for settings in ["", ",filter=pcf", ",criterion=relative,filter=pcf"] {
        let mut adaptive = technique(&format!("adaptive-sampling:map=512{settings}"));
        let found = visibility(&renderer, &mut adaptive);
        assert_eq!(stat(&adaptive, "maps"), 1, "{settings}");
        // A pixel whose middle is within a texel of the shadow's edge may be wrong.
        let wrong = found.iter().zip(&truth.visibility).filter(|(a, b)| (*a - *b).abs() > 0.01).count();
        let figures = compared(&found, &truth);
        println!("{settings}: {wrong} pixels are wrong, RMSE {:.4}, {:?}", figures.rmse, figures.counts);
        assert!(figures.counts.umbra > 300, "{:?}", figures.counts);
        assert!(wrong < SIZE[0] as usize / 4, "{settings}: {wrong} pixels are wrong");
    }
}

/// The largest error under two plates of different heights. Seen from the light's centre the edge of one lies behind
/// the edge of the other; from its rim there is a gap, and up to a third of the light shines through it.
fn error_behind_a_gap(spec: &str) -> f64 {
    static GAP: OnceLock<(Scene, Reference)> = OnceLock::new();
    let (scene, truth) = GAP.get_or_init(|| {
        let plates = [cuboid([-1.5, 1.5, -1.0], [0.0, 1.51, 1.0]), cuboid([0.0, 0.7, -1.0], [1.5, 0.71, 1.0])];
        let meshes = [vec![ground(20.0)], plates.into()].concat();
        let view = camera([0.0, 0.6, 3.0], [0.0; 3], 30.0);
        let scene = scene(meshes, view, light([0.0, 3.0, 0.0], [0.0; 3], 0.8));
        let truth = truth(&scene, SIZE, 1024);
        (scene, truth)
    });
    let error = compared(&fresh(&seen(scene), spec), truth).max;
    println!("{spec}: at most {error:.3}");
    error
}

#[test]
fn light_that_only_the_rim_of_the_light_sends_through_a_gap_is_seen() {
    let adaptive = "adaptive-sampling:map=256,tolerance=0,maps=289,filter=pcf";
    for spec in ["uniform-sampling:map=256,samples=128", adaptive] {
        let error = error_behind_a_gap(spec);
        assert!(error < 0.1, "{spec}: at most {error}");
    }
    let error = error_behind_a_gap("hard:map=256");
    assert!(error > 0.3, "a hard shadow went through: at most {error}");
}

#[test]
fn light_through_a_gap_is_seen_by_cells_of_the_light() {
    let error = error_behind_a_gap("adaptive-sampling:map=256,tolerance=0,maps=289");
    assert!(error < 0.1, "at most {error}");
}
