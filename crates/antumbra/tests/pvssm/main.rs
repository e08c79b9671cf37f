//! Predicted virtual soft shadow maps against the truth: accuracy at all distances of the camera, memory, and
//! fewer texels for softer shadows.

#[path = "../common/mod.rs"]
mod common;

use antumbra::Shadows;
use antumbra_metrics::Metrics;
use antumbra_reference::{Reference, Settings, trace};
use antumbra_scene::Scene;
use common::{builtin, compared, drawn, gpu, shadowed, technique};
use glam::{Vec2, Vec3};
use pollster::block_on;
use std::sync::atomic::AtomicBool;

const SIZE: [u32; 2] = [128, 128];

fn stat(shadows: &Shadows, name: &str) -> f64 {
    let stats = block_on(shadows.stats(gpu())).unwrap_or_else(|e| panic!("{e}"));
    stats.iter().find(|(n, _)| *n == name).unwrap_or_else(|| panic!("no count of {name}")).1
}

/// The truth averaged over pixels, because the technique filters over them.
fn truth(scene: &Scene, light_samples: u32) -> Reference {
    let settings = Settings { light_samples, pixel_samples: 16, ..Settings::of_size(SIZE[0], SIZE[1]) };
    trace(scene, &settings, &|_| (), &AtomicBool::new(false)).unwrap_or_else(|e| panic!("{}: {e}", scene.name))
}

/// The metrics of techniques against the truth, in their order.
fn metrics_of(scene: &Scene, specs: &[&str], light_samples: u32) -> Vec<Metrics> {
    let (renderer, truth) = (drawn(scene, SIZE), truth(scene, light_samples));
    let metrics = |spec: &&str| {
        let visibility =
            shadowed(&renderer, &mut technique(spec)).unwrap_or_else(|e| panic!("{}, {spec}: {e}", scene.name));
        compared(&visibility, &truth)
    };
    specs.iter().map(metrics).collect()
}

#[test]
fn errors_are_those_of_one_fine_map() {
    // Penumbrae are few pixels wide, so that the perceptual function permits larger errors than in larger images.
    for (name, bound) in [("fence", 0.022), ("layers", 0.06), ("plant", 0.05)] {
        let found = metrics_of(&builtin(name), &["pvssm", "smooth-pcss:map=4096"], 256);
        let [ours, fine] = [found[0].average_error, found[1].average_error];
        println!("{name}: {ours:.4}, one map of 4096 texels {fine:.4}, acne {:.5}", found[0].acne);
        assert!(ours < bound && ours < 1.1 * fine + 0.003, "{name}: {ours} (one fine map: {fine})");
        assert!(found[0].acne < 0.002, "{name}: acne {}", found[0].acne);
    }
}

#[test]
fn hard_shadows_are_those_of_the_point_at_the_lights_centre() {
    for name in ["fence", "plant"] {
        let mut scene = builtin(name);
        let soft = scene.light.size;
        scene.light.size = Vec2::ZERO;
        let (renderer, point) = (drawn(&scene, SIZE), truth(&scene, 16));
        let by_point = shadowed(&renderer, &mut technique("fvsm")).unwrap_or_else(|e| panic!("{e}"));
        let error = compared(&by_point, &point).average_error;
        let hard = shadowed(&renderer, &mut technique("hard")).unwrap_or_else(|e| panic!("{e}"));
        let of_hard = compared(&hard, &point).average_error;
        println!("{name}: {error:.4}, one map of 2048 texels {of_hard:.4}");
        assert!(error < of_hard, "{name}: {error} (hard: {of_hard})");
        // `fvsm` ignores the light's size.
        scene.light.size = soft;
        let wide = shadowed(&drawn(&scene, SIZE), &mut technique("fvsm")).unwrap_or_else(|e| panic!("{e}"));
        let far = wide.iter().zip(&by_point).filter(|(a, b)| (**a - **b).abs() > 0.5).count();
        assert!(far < 60, "{name}: {far} pixels change with the light's size");
    }
}

#[test]
fn no_discretisation_shows_from_ten_centimetres_to_a_hundred_metres() {
    let mut scene = builtin("fence");
    // Where the shadow of a slat begins and the penumbra opens.
    let target = Vec3::new(0.4, 0.0, 0.3);
    let direction = (scene.camera.eye - scene.camera.target).normalize();
    (scene.camera.near, scene.camera.far, scene.camera.target) = (0.01, 1000.0, target);
    let (mut worst, mut coarse) = ((0.0, 0.0), (0.0, 0.0));
    for distance in [0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0] {
        scene.camera.eye = target + direction * distance;
        let (renderer, exact) = (drawn(&scene, SIZE), truth(&scene, 256));
        let mut one = technique("pvssm");
        let visibility = shadowed(&renderer, &mut one).unwrap_or_else(|e| panic!("{e}"));
        let fine = shadowed(&renderer, &mut technique("pvssm:detail=6,rounds=16")).unwrap_or_else(|e| panic!("{e}"));
        let (of_truth, of_fine) = (compared(&visibility, &exact), {
            let mut finer = exact.clone();
            finer.visibility.clone_from(&fine);
            compared(&visibility, &finer)
        });
        println!(
            "{distance} m: FLIP {:.4}, average error {:.4}; against six times the texels FLIP {:.4}; {} tiles, {:.2} megatexels",
            of_truth.flip,
            of_truth.average_error,
            of_fine.flip,
            stat(&one, "tiles"),
            stat(&one, "megatexels"),
        );
        worst = if of_truth.flip > worst.0 { (of_truth.flip, distance) } else { worst };
        coarse = if of_fine.flip > coarse.0 { (of_fine.flip, distance) } else { coarse };
    }
    println!("worst FLIP {:.4} at {} m, of discretisation {:.4} at {} m", worst.0, worst.1, coarse.0, coarse.1);
    assert!(worst.0 < 0.09, "FLIP {} at {} m", worst.0, worst.1);
    assert!(coarse.0 < 0.04, "the discretisation has a FLIP of {} at {} m", coarse.0, coarse.1);
}

#[test]
fn memory_of_maps_is_within_the_budget_whatever_is_drawn() {
    let maps = ["low-resolution map", "depth pyramid", "tile grid", "tile decision", "tiles", "tile pyramid"];
    for spec in ["pvssm", "pvssm:detail=8", "fvsm"] {
        let mut one = technique(spec);
        shadowed(&drawn(&builtin("plant"), SIZE), &mut one).unwrap_or_else(|e| panic!("{e}"));
        let bytes: u64 = one.memory().iter().filter(|m| maps.contains(&m.pass)).map(|m| m.bytes).sum();
        println!("{spec}: {:.1} MB of maps, {} tiles", bytes as f64 * 1e-6, stat(&one, "tiles"));
        assert!(bytes > 16_000_000 && bytes < 48_000_000, "{spec}: {bytes} bytes");
    }
}

#[test]
fn soft_shadows_need_fewer_texels_than_hard_ones() {
    let renderer = drawn(&builtin("square"), SIZE);
    let [soft, hard] = ["pvssm", "fvsm"].map(|spec| {
        let mut one = technique(spec);
        shadowed(&renderer, &mut one).unwrap_or_else(|e| panic!("{e}"));
        stat(&one, "megatexels")
    });
    println!("megatexels: soft {soft}, hard {hard}");
    assert!(soft > 0.0 && soft < 0.5 * hard, "soft {soft}, hard {hard}");
}

#[test]
fn a_grid_that_is_no_power_of_two_is_refused() {
    let spec: antumbra::Spec = "pvssm:grid=48".parse().expect("within its range");
    let message = spec.make(gpu()).err().expect("refused").to_string();
    assert!(message.contains("grid") && message.contains("16, 32, 64 or 128"), "{message}");
}
