//! Prefiltered shadows against the truth of a hard shadow that is filtered over the pixel, and soft ones against that
//! of an area light.

#[path = "../common/mod.rs"]
mod common;

use antumbra_reference::{Reference, Settings, trace};
use antumbra_scene::Scene;
use common::{builtin, camera, compared, drawn, ground, light, quad, scene, shadowed, technique, visibility};
use std::sync::atomic::AtomicBool;

/// The built-in scene with its light shrunk to a point.
fn hard(spec: &str) -> Scene {
    let mut scene = builtin(spec);
    scene.light.size = [0.0; 2].into();
    scene
}

/// The truth, filtered over the pixel by a box.
fn filtered_truth(scene: &Scene, size: [u32; 2], pixel_samples: u32) -> Reference {
    let rays = if scene.light.size == glam::Vec2::ZERO { 1 } else { 16 };
    let settings =
        Settings { light_samples: rays * pixel_samples, pixel_samples, ..Settings::of_size(size[0], size[1]) };
    trace(scene, &settings, &|_| (), &AtomicBool::new(false)).unwrap_or_else(|e| panic!("{}: {e}", scene.name))
}

/// Pixels all around which, `radius` pixels far, `is` holds of the truth.
fn inner(truth: &Reference, radius: i32, is: impl Fn(f32) -> bool) -> Vec<usize> {
    let (w, h) = (truth.width as i32, truth.height as i32);
    let holds = |x: i32, y: i32| {
        let i = (y.clamp(0, h - 1) * w + x.clamp(0, w - 1)) as usize;
        truth.valid[i] && is(truth.visibility[i])
    };
    let around = |x: i32, y: i32| (-radius..=radius).all(|dy| (-radius..=radius).all(|dx| holds(x + dx, y + dy)));
    (0..w * h).filter(|i| around(i % w, i / w)).map(|i| i as usize).collect()
}

fn mean(of: &[f32], at: &[usize]) -> f64 {
    at.iter().map(|i| f64::from(of[*i])).sum::<f64>() / at.len().max(1) as f64
}

/// Pixels of which the middle and all corners see the plane y = 0: the others show several surfaces, of which
/// techniques see the one at the middle.
fn on_the_plain(scene: &Scene, size: [u32; 2]) -> Vec<usize> {
    let tracer = antumbra_reference::Tracer::new(scene);
    let sees_plain = |x: f64, y: f64| {
        let (eye, d) = common::closed_form::pixel_ray(&scene.camera, size, glam::DVec2::new(x, y));
        let hit = tracer.nearest(&antumbra_reference::Ray::new(eye.as_vec3(), d.as_vec3()));
        hit.is_some_and(|h| h.position.y.abs() < 1e-3)
    };
    let corners = [(0.5, 0.5), (0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)];
    let pixel = |i: &usize| {
        let (x, y) = ((*i as u32 % size[0]) as f64, (*i as u32 / size[0]) as f64);
        corners.iter().all(|(dx, dy)| sees_plain(x + dx, y + dy))
    };
    (0..(size[0] * size[1]) as usize).filter(pixel).collect()
}

#[test]
fn anisotropic_filtering_is_near_the_truth_on_a_plane_at_a_grazing_angle() {
    let (scene, size) = (hard("grid"), [256, 192]);
    let truth = filtered_truth(&scene, size, 64);
    let renderer = drawn(&scene, size);
    let plain = on_the_plain(&scene, size);
    let rmse = |spec: &str| {
        let picture = shadowed(&renderer, &mut technique(spec)).unwrap_or_else(|e| panic!("{e}"));
        let square = |i: &usize| f64::from(picture[*i] - truth.visibility[*i]).powi(2);
        let valid = plain.iter().filter(|i| truth.valid[**i]);
        let rmse = (valid.clone().map(square).sum::<f64>() / valid.count().max(1) as f64).sqrt();
        println!(
            "{spec}: RMSE {rmse:.4} over {} pixels of the plain, all {:.4}",
            plain.len(),
            compared(&picture, &truth).rmse
        );
        rmse
    };
    let [full, isotropic, unfiltered] = ["vsm:blur=1", "vsm:blur=1,anisotropy=1", "vsm:blur=1,mips=false"].map(rmse);
    assert!(plain.len() > 5000 && full < 0.02, "{full} over {} pixels", plain.len());
    assert!(full < unfiltered / 3.0 && full < isotropic, "{full}, isotropic {isotropic}, none {unfiltered}");
}

#[test]
fn four_moments_leak_less_than_a_fifth_of_what_two_do() {
    let scene = hard("layers");
    let truth = filtered_truth(&scene, [256, 256], 16);
    let umbra = inner(&truth, 2, |v| v < 0.001);
    let renderer = drawn(&scene, [256, 256]);
    let leak = |spec: &str| {
        let picture = shadowed(&renderer, &mut technique(spec)).unwrap_or_else(|e| panic!("{e}"));
        let leak = mean(&picture, &umbra);
        println!("{spec}: leak {leak:.5} over {} pixels", umbra.len());
        leak
    };
    let [vsm, evsm, msm] = ["vsm", "evsm", "msm"].map(leak);
    assert!(umbra.len() > 1000 && vsm > 0.001, "{vsm} over {} pixels", umbra.len());
    assert!(msm < 0.2 * vsm && evsm < vsm, "vsm {vsm}, evsm {evsm}, msm {msm}");
}

#[test]
fn the_border_of_the_map_does_not_bleed() {
    // An occluder that goes on beyond the map on one side.
    let occluder = quad([-3.0, 1.0, 0.0], [3.0, 0.3]);
    let mut narrow = scene(
        vec![ground(20.0), occluder],
        camera([0.0, 2.5, 3.0], [0.0; 3], 60.0),
        light([0.0, 4.0, 0.0], [0.0; 3], 0.0),
    );
    let mut wide = narrow.clone();
    narrow.light.shadow_fov_deg = Some(30.0);
    wide.light.shadow_fov_deg = Some(110.0);
    // Half the map's side on the ground: receivers beyond are lit.
    let half = 4.0 * 15f64.to_radians().tan();
    let size = [128, 128];
    let points = common::closed_form::ground_points(&narrow.camera, size);
    for name in ["vsm", "evsm", "msm", "esm", "csm"] {
        let [inside, beyond] = [("map=128", &narrow), ("map=1024", &wide)]
            .map(|(map, scene)| visibility(scene, &format!("{name}:{map},blur=9"), size));
        let (mut outside, mut worst) = (0, 0f32);
        for (i, p) in points.iter().enumerate().filter_map(|(i, p)| Some((i, (*p)?))) {
            // Neither the occluder itself, nor what is beside the shadow's straight edges.
            let by_edge = (p.z.abs() - 0.4).abs() < 0.15 || p.x.abs() < 0.15;
            if p.x.abs() > 1.01 * half || p.z.abs() > 1.01 * half {
                outside += 1;
                assert!(inside[i] == 1.0, "{name}: {p} is outside of the map and sees {}", inside[i]);
            } else if p.x.abs() < 0.99 * half && p.z.abs() < 0.99 * half && !by_edge {
                worst = worst.max((inside[i] - beyond[i]).abs());
            }
        }
        println!("{name}: {outside} pixels outside, largest difference inside {worst}");
        assert!(outside > 1000 && worst < 0.05, "{name}: differs by {worst} from a map that is wider");
    }
}

#[test]
fn the_split_format_is_as_good_as_32_bits_in_a_picture_and_16_bits_are_not() {
    let scene = hard("bumpy:side=96");
    let renderer = drawn(&scene, [128, 96]);
    let picture = |spec: &str| shadowed(&renderer, &mut technique(spec)).unwrap_or_else(|e| panic!("{e}"));
    let full = picture("vsm:format=rg32float");
    let off = |spec: &str| {
        let other = picture(spec);
        let sum: f64 = other.iter().zip(&full).map(|(a, b)| f64::from((a - b).abs())).sum();
        println!("{spec}: {:.5} off 32 bits in the mean", sum / full.len() as f64);
        sum / full.len() as f64
    };
    let [split, half] = ["vsm:format=split", "vsm:format=rg16float"].map(off);
    assert!(split < 5e-4 && half > 4.0 * split, "split {split}, 16 bits {half}");
}

#[test]
fn soft_shadows_of_moments_follow_the_lights_size() {
    let scene = builtin("fence");
    let renderer = drawn(&scene, [160, 160]);
    let truth = filtered_truth(&scene, [160, 160], 4);
    let error = |spec: &str| {
        let picture = shadowed(&renderer, &mut technique(spec)).unwrap_or_else(|e| panic!("{e}"));
        let f = compared(&picture, &truth);
        println!("{spec}: average {:.4}, leak {:.4}, acne {:.4}", f.average_error, f.leak, f.acne);
        f.average_error
    };
    let hard = error("hard");
    for (spec, share) in [("savsm", 0.1), ("vssm", 0.1), ("cssm", 0.5)] {
        let soft = error(spec);
        assert!(soft < share * hard, "{spec}: {soft}, hard {hard}");
    }
}
