//! The fitted frustum: it holds every caster that can hide the light from a visible receiver, and no more than it must.
//! Needs no GPU.

mod common;

use antumbra::{ShadowFrustum, View};
use antumbra_scene::{Instance, Mesh, Scene};
use common::{builtin, camera, cuboid, ground, light};
use glam::{Affine3A, Vec2, Vec3};
use proptest::prelude::*;

const SIZE: [u32; 2] = [96, 64];

fn fit(scene: &Scene) -> ShadowFrustum {
    ShadowFrustum::fit(scene, &View::of_camera(&scene.camera, SIZE))
}

/// Two boxes over a ground of some size, looked at from near.
fn boxes(ground_half: f32) -> Scene {
    let boxes = [cuboid([-0.5, 0.0, -0.3], [0.1, 0.8, 0.3]), cuboid([0.4, 0.6, -0.1], [0.9, 0.9, 0.4])];
    let [a, b] = boxes;
    let view = camera([1.6, 1.9, 2.6], [0.0, 0.2, 0.0], 45.0);
    common::scene(vec![ground(ground_half), a, b], view, light([1.5, 4.0, -1.0], [0.0; 3], 0.6))
}

/// The largest |tangent| / opening of points of casters that stand between a visible receiver and the light, found by
/// rays: over 1 if the frustum lacks one of them. And how many there are.
fn farthest_pair(scene: &Scene, frustum: &ShadowFrustum) -> (f32, usize) {
    let tracer = antumbra_reference::Tracer::new(scene);
    let (eye, mut worst, mut pairs) = (scene.camera.eye, 0f32, 0);
    let lights = [(-0.5, -0.5), (0.5, -0.5), (-0.5, 0.5), (0.5, 0.5), (0.0, 0.0)].map(|(u, v)| scene.light.point(u, v));
    let pixels = (0..SIZE[1]).step_by(2).flat_map(|y| (0..SIZE[0]).step_by(2).map(move |x| (x, y)));
    for (x, y) in pixels {
        let at = glam::DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
        let (_, d) = common::closed_form::pixel_ray(&scene.camera, SIZE, at);
        let Some(hit) = tracer.nearest(&antumbra_reference::Ray::new(eye, d.as_vec3())) else { continue };
        let receiver = tracer.off_surface(&hit);
        for to in lights {
            let mut ray = antumbra_reference::Ray::new(receiver, to - receiver);
            ray.t_max = 1.0 - 1e-5;
            let Some(caster) = tracer.nearest(&ray) else { continue };
            let l = scene.light.light_from_world(caster.position.as_vec3());
            let r = scene.light.light_from_world(receiver);
            // What is near its receiver by rounding hides itself, which needs no map.
            if scene.instances[caster.instance as usize].receiver_only || r.z - l.z < 0.01 * r.z || l.z <= 0.0 {
                continue;
            }
            pairs += 1;
            worst = worst.max((l.truncate().abs() / l.z / frustum.tan_half).max_element());
        }
    }
    (worst, pairs)
}

#[test]
fn every_caster_that_hides_the_light_from_what_is_seen_is_held() {
    for spec in ["square", "fence", "spheres:segments=32", "layers", "cage", "forest:trees=3", "plant", "atrium"] {
        let scene = builtin(spec);
        let frustum = fit(&scene);
        let (worst, pairs) = farthest_pair(&scene, &frustum);
        println!("{spec}: {:.3}, {pairs} pairs reach to {worst:.3} of it", frustum.tan_half);
        assert!(pairs > 20, "{spec}: only {pairs} pairs of caster and receiver found");
        assert!(worst <= 1.0, "{spec}: a caster lies at {worst:.4} of the frustum {frustum:?}");
        // The sibling: half the frustum lacks some of them, unless there is room to spare.
        assert!(2.0 * worst > 1.0, "{spec}: the frustum is over twice as wide as needed: {worst:.4} of {frustum:?}");
    }
}

#[test]
fn a_huge_ground_does_not_widen_the_frustum() {
    let small = fit(&boxes(4.0)).tan_half;
    for half in [40.0, 4000.0] {
        let large = fit(&boxes(half)).tan_half;
        assert!((large / small - 1.0).abs().max_element() < 0.05, "a ground of {half} m: {large} instead of {small}");
    }
    let around = ShadowFrustum::around(&boxes(40.0).light, &boxes(40.0).bounds()).tan_half;
    assert!((around / small).max_element() > 2.0, "the box around all would do as well: {around}, {small}");
}

#[test]
fn a_ground_that_casts_does_not_widen_the_frustum() {
    let mut scene = boxes(40.0);
    let alone = fit(&scene).tan_half;
    scene.instances[0].receiver_only = false;
    let casting = fit(&scene).tan_half;
    assert!((casting / alone - 1.0).abs().max_element() < 0.05, "{casting} instead of {alone}");
}

/// The same triangles as a single mesh.
fn merged(scene: &Scene) -> Scene {
    let mut all = Mesh::default();
    for instance in &scene.instances {
        let (mesh, base) = (&scene.meshes[instance.mesh], all.positions.len() as u32);
        all.positions.extend(mesh.positions.iter().map(|p| instance.world_from_object.transform_point3(*p)));
        all.indices.extend(mesh.indices.iter().map(|i| i + base));
    }
    let whole = Instance { mesh: 0, world_from_object: Affine3A::IDENTITY, receiver_only: false };
    Scene { meshes: vec![all], instances: vec![whole], ..scene.clone() }
}

#[test]
fn one_mesh_that_includes_the_ground_is_fitted_as_its_parts_are() {
    for scene in [boxes(40.0), builtin("fence")] {
        let (parts, whole) = (fit(&scene).tan_half, fit(&merged(&scene)).tan_half);
        assert!((whole / parts - 1.0).abs().max_element() < 0.05, "{}: {whole} instead of {parts}", scene.name);
    }
}

#[test]
fn the_lights_own_opening_counts() {
    let mut scene = boxes(4.0);
    scene.light.shadow_fov_deg = Some(50.0);
    let tan = 25f32.to_radians().tan();
    for frustum in [fit(&scene), ShadowFrustum::around(&scene.light, &scene.bounds())] {
        assert!((frustum.tan_half - Vec2::splat(tan)).abs().max_element() < 1e-6, "{frustum:?}");
    }
}

#[test]
fn texels_are_not_much_longer_than_wide() {
    // A wide picture of a strip far aside of the light's axis.
    let mut scene = boxes(20.0);
    scene.camera = camera([3.0, 0.9, 0.0], [3.0, 0.0, 0.0], 5.0);
    scene.light = light([0.0, 4.0, 0.0], [0.0; 3], 0.3);
    let tan = ShadowFrustum::fit(&scene, &View::of_camera(&scene.camera, [160, 16])).tan_half;
    assert!(tan.max_element() / tan.min_element() < 4.1, "{tan}");
}

#[test]
fn an_empty_picture_and_an_empty_scene_have_a_frustum() {
    let mut scene = boxes(4.0);
    scene.camera = camera([0.0, 5.0, 0.0], [0.0, 9.0, 0.1], 45.0);
    let empty = Scene { instances: Vec::new(), ..scene.clone() };
    for (scene, what) in [(scene, "looking away"), (empty, "empty")] {
        let f = fit(&scene);
        assert!(f.tan_half.is_finite() && f.tan_half.min_element() > 0.0 && f.near > 0.0, "{what}: {f:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(48) })]

    #[test]
    fn a_box_anywhere_under_a_light_anywhere_is_held(
        at in prop::array::uniform3(-1.0f32..1.0), size in prop::array::uniform3(0.05f32..0.8),
        lamp in prop::array::uniform3(-3.0f32..3.0), edge in 0.0f32..1.5,
    ) {
        let low = Vec3::new(at[0], at[1].abs(), at[2]);
        let view = camera([1.6, 1.9, 2.6], [0.0, 0.2, 0.0], 45.0);
        let lamp = light([lamp[0], 4.0 + lamp[1], lamp[2]], [0.0; 3], edge);
        prop_assume!(low.y + size[1] < lamp.center.y - 1.0);
        let high = (low + Vec3::from(size)).to_array();
        let scene = common::scene(vec![ground(20.0), cuboid(low.to_array(), high)], view, lamp);
        let frustum = fit(&scene);
        let (worst, pairs) = farthest_pair(&scene, &frustum);
        prop_assert!(worst <= 1.0, "{worst:.4} of {frustum:?} with {pairs} pairs; box {low} to {high:?}, {lamp:?}");
    }
}
