//! The hard shadow is that of the rays.

use super::common::{builtin, compared, drawn, shadowed, technique, truth, visibility};
use super::with_point_light;
use antumbra_reference::{Ray, Reference, Tracer};
use antumbra_scene::Scene;
use antumbra_scene::builtin::list;
use glam::Vec2;

const SIZE: [u32; 2] = [256, 160];

/// Built-in scenes with fewer triangles where they have very many.
fn small(name: &str) -> String {
    match name {
        "bumpy" => "bumpy:side=120".to_owned(),
        "forest" => "forest:trees=12".to_owned(),
        "pipes" => "pipes:triangles=300000".to_owned(),
        _ => name.to_owned(),
    }
}

/// Pixels where the two differ although the rays would say the same everywhere within a 64th of a pixel. Where they
/// would not, an edge passes: rasterisers move corners to a grid of 1/256 pixel, so which side is seen is for them to
/// say.
fn unexplained(scene: &Scene, found: &[f32], truth: &Reference) -> (usize, usize) {
    let tracer = Tracer::new(scene);
    let differs = |i: &usize| truth.valid[*i] && found[*i] != truth.visibility[*i];
    let wrong: Vec<usize> = (0..found.len()).filter(differs).collect();
    let by_rays = |i: usize, x: f32, y: f32| {
        let pixel = Vec2::new((i as u32 % SIZE[0]) as f32 + 0.5 + x, (i as u32 / SIZE[0]) as f32 + 0.5 + y);
        lit(scene, &tracer, pixel)
    };
    let is_edge = |i: usize| {
        let around = (0..16)
            .map(|k| Vec2::from_angle(k as f32 * std::f32::consts::FRAC_PI_8) / if k % 2 == 0 { 64.0 } else { 160.0 });
        around.map(|d| by_rays(i, d.x, d.y)).any(|lit| lit == found[i])
    };
    (wrong.len(), wrong.iter().filter(|&&i| !is_edge(i)).count())
}

/// What a ray through a place of the picture says of the light's centre.
fn lit(scene: &Scene, tracer: &Tracer, pixel: Vec2) -> f32 {
    let (right, up, forward) = scene.camera.basis();
    let ndc = pixel / Vec2::new(SIZE[0] as f32, SIZE[1] as f32) * 2.0 - 1.0;
    let tan = (0.5 * scene.camera.fov_y_deg).to_radians().tan();
    let aspect = SIZE[0] as f32 / SIZE[1] as f32;
    let direction = forward + right * (ndc.x * tan * aspect) - up * (ndc.y * tan);
    let Some(hit) = tracer.nearest(&Ray::new(scene.camera.eye, direction)) else { return 1.0 };
    let from = tracer.off_surface(&hit);
    let faces = hit.normal.as_vec3().dot(scene.light.center - from) > 0.0;
    if faces && !tracer.occluded(from, scene.light.center) { 1.0 } else { 0.0 }
}

#[test]
fn every_scene_has_the_shadow_of_the_rays_but_on_edges() {
    let mut faults = Vec::new();
    let (mut pixels, mut wrong_in_all) = (0, 0);
    for info in list() {
        let scene = with_point_light(builtin(&small(info.name)));
        let truth = truth(&scene, SIZE, 1);
        let found = visibility(&scene, "alias-free", SIZE);
        let valid = truth.valid.iter().filter(|v| **v).count();
        let (wrong, unexplained) = unexplained(&scene, &found, &truth);
        println!("{}: {wrong} of {valid} pixels, {unexplained} not on an edge", scene.name);
        (pixels, wrong_in_all) = (pixels + valid, wrong_in_all + wrong);
        if unexplained * 10_000 > valid {
            faults.push(format!("{}: {unexplained} of {valid} pixels differ where no edge is", scene.name));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(wrong_in_all * 10_000 <= pixels, "{wrong_in_all} of {pixels} pixels differ");
}

#[test]
fn the_picture_does_not_depend_on_the_map() {
    let renderer = drawn(&with_point_light(builtin("cage")), SIZE);
    let by = |spec: &str| shadowed(&renderer, &mut technique(spec)).unwrap_or_else(|e| panic!("{spec}: {e}"));
    let fine = by("alias-free:map=2048");
    for spec in ["alias-free", "alias-free:map=500", "alias-free:map=67", "alias-free:map=16"] {
        assert!(by(spec) == fine, "{spec} differs from 2048 texels");
    }
}

#[test]
fn more_points_a_pixel_tend_to_the_mean_over_the_pixel() {
    let scene = with_point_light(builtin("fence:slats=9"));
    let size = [96, 64];
    let settings = antumbra_reference::Settings {
        light_samples: 64,
        pixel_samples: 64,
        ..antumbra_reference::Settings::of_size(size[0], size[1])
    };
    let never = std::sync::atomic::AtomicBool::new(false);
    let mean = antumbra_reference::trace(&scene, &settings, &|_| (), &never).expect("traces");
    let errors = ["alias-free", "alias-free:samples=4", "alias-free:samples=16", "alias-free:samples=64"].map(|spec| {
        let figures = compared(&visibility(&scene, spec, size), &mean);
        println!("{spec}: {:.4}", figures.average_error);
        figures.average_error
    });
    assert!(errors.windows(2).all(|e| e[1] < 0.7 * e[0]), "{errors:?}");
    assert!(errors[3] < 0.016, "{errors:?}");
}
