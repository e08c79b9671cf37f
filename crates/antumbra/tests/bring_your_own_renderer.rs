//! The example runs, and what it shows agrees with the ray-traced truth of the same boxes.

#[path = "../examples/bring_your_own_renderer.rs"]
mod host;

use antumbra_reference::{Settings, trace};
use antumbra_scene::{Instance, Material, Mesh, Scene};
use glam::{Affine3A, Vec3};
use std::sync::atomic::AtomicBool;

/// The host's boxes, told again in the scene's terms.
fn scene() -> Scene {
    let (vertices, indices) = host::cube();
    let mesh = Mesh {
        name: "cube".to_owned(),
        positions: vertices.iter().map(|v| Vec3::new(v[0], v[1], v[2])).collect(),
        uvs: Vec::new(),
        indices: indices.iter().map(|i| u32::from(*i)).collect(),
        material: 0,
    };
    let placed =
        |m: &glam::Mat4| Instance { mesh: 0, world_from_object: Affine3A::from_mat4(*m), receiver_only: false };
    Scene {
        name: "boxes".to_owned(),
        meshes: vec![mesh],
        materials: vec![Material::default()],
        instances: host::instances().iter().map(placed).collect(),
        camera: host::camera(),
        light: host::light(),
        size: None,
    }
}

fn average_error(visibility: &[f32], truth: &antumbra_reference::Reference) -> f64 {
    use antumbra_metrics::{Image, metrics};
    let image = |data| Image::new(host::SIZE, host::SIZE, data).expect("the sizes agree");
    metrics(image(visibility), image(&truth.visibility), &truth.valid).expect("comparable").average_error
}

#[test]
fn a_foreign_renderer_gets_shadows_that_agree_with_the_truth() {
    let settings = Settings { light_samples: 256, pixel_samples: 4, ..Settings::of_size(host::SIZE, host::SIZE) };
    let truth = trace(&scene(), &settings, &|_| {}, &AtomicBool::new(false)).expect("traces");
    let (visibility, picture) = pollster::block_on(host::render("pcss")).expect("renders");
    let error = average_error(&visibility, &truth);
    assert!(error < 0.03, "average error of pcss over shadow and penumbra: {error:.4}");
    let (hard, _) = pollster::block_on(host::render("hard")).expect("renders");
    let hard = average_error(&hard, &truth);
    assert!(error < 0.5 * hard, "pcss {error:.4} against hard {hard:.4}");
    // The host's shading used it: dark where the truth is dark.
    let luminance = |i: usize| picture[4 * i..4 * i + 3].iter().map(|c| f64::from(*c)).sum::<f64>();
    let mean = |keep: &dyn Fn(f32) -> bool| {
        let kept: Vec<usize> =
            (0..truth.valid.len()).filter(|i| truth.valid[*i] && keep(truth.visibility[*i])).collect();
        kept.iter().map(|i| luminance(*i)).sum::<f64>() / kept.len() as f64
    };
    let (dark, lit) = (mean(&|v| v < 0.01), mean(&|v| v > 0.99));
    assert!(dark < 0.6 * lit, "umbra {dark:.0}, lit {lit:.0} of 765");
}

#[test]
fn a_foreign_renderer_is_told_of_an_unknown_technique() {
    let error = pollster::block_on(host::render("pcs")).expect_err("must be refused").to_string();
    assert!(error.contains("pcss") || error.contains("pcf"), "{error}");
}
