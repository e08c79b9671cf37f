//! What a surface does to its own rays: nothing.

mod common;

use antumbra_reference::{Settings, Tracer};
use antumbra_scene::{Material, Texture, Wrap};
use common::{camera, icosphere, light_above, quad, scene, traced};
use glam::{Vec2, Vec3};
use std::sync::Arc;

#[test]
fn a_convex_surface_never_shadows_itself() {
    for shift in [Vec3::ZERO, Vec3::new(25.0, 0.0, -25.0), Vec3::new(-600.0, 500.0, 624.0)] {
        let mut light = light_above(30.0, Vec2::splat(0.5));
        light.center += shift;
        light.target += shift;
        let look = camera(Vec3::new(1.0, 1.5, 3.5) + shift, shift);
        let s = scene(vec![icosphere(5, shift)], look, light);
        let r = traced(&s, &Settings { light_samples: 256, ..Settings::of_size(96, 96) });
        let valid = r.valid.iter().filter(|v| **v).count();
        assert!(valid > 600, "{valid} valid pixels at {shift}");
        for (i, (&v, &ok)) in r.visibility.iter().zip(&r.valid).enumerate() {
            assert!(!ok || v == 1.0, "pixel {i} at {shift}: {v}");
        }
    }
}

#[test]
fn behind_the_light_everything_is_dark_and_nothing_is_valid() {
    let mut light = light_above(3.0, Vec2::splat(0.5));
    light.target = Vec3::Y * 10.0;
    let s = scene(vec![quad(Vec3::ZERO, Vec2::splat(50.0))], camera(Vec3::new(0.0, 2.0, 3.0), Vec3::ZERO), light);
    let r = traced(&s, &Settings { light_samples: 16, ..Settings::of_size(16, 16) });
    assert_eq!(r.visibility[16 * 15..], [0.0; 16], "the floor");
    assert!(r.valid.iter().all(|v| !v));
}

#[test]
fn sky_is_lit_and_not_valid() {
    let s = scene(vec![], camera(Vec3::new(0.0, 2.0, 3.0), Vec3::ZERO), light_above(3.0, Vec2::ONE));
    let r = traced(&s, &Settings::of_size(4, 4));
    assert_eq!((r.visibility, r.valid, r.rays), (vec![1.0; 16], vec![false; 16], 0));
}

#[test]
fn near_and_far_planes_bound_what_is_seen() {
    let mut look = camera(Vec3::new(0.0, 4.0, 0.0), Vec3::ZERO);
    look.up = -Vec3::Z;
    let floor = || vec![quad(Vec3::ZERO, Vec2::splat(50.0))];
    let settings = Settings { light_samples: 16, ..Settings::of_size(8, 8) };
    for (near, far, seen) in [(0.1, 100.0, true), (0.1, 3.99, false), (4.01, 100.0, false), (3.99, 4.01, true)] {
        look.near = near;
        look.far = far;
        let r = traced(&scene(floor(), look, light_above(9.0, Vec2::ONE)), &settings);
        assert!(r.valid.iter().all(|v| *v == seen), "near {near}, far {far}");
    }
}

#[test]
fn a_receiver_only_instance_casts_nothing() {
    let meshes = vec![quad(Vec3::ZERO, Vec2::splat(9.0)), quad(Vec3::Y, Vec2::splat(9.0))];
    let mut s = scene(meshes, camera(Vec3::new(0.0, 0.5, 2.0), Vec3::ZERO), light_above(3.0, Vec2::ONE));
    let dark = Tracer::new(&s).occluded(Vec3::Y * 0.5, Vec3::Y * 3.0);
    s.instances[1].receiver_only = true;
    let lit = !Tracer::new(&s).occluded(Vec3::Y * 0.5, Vec3::Y * 3.0);
    assert!(dark && lit);
}

#[test]
fn a_lamp_modelled_at_the_light_hides_nothing() {
    for tilt in [Vec3::ZERO, Vec3::new(0.7, 0.0, 0.3)] {
        let mut light = light_above(3.1, Vec2::new(1.1, 0.7));
        light.target += tilt;
        let (u, v) = light.edges();
        let corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)].map(|(a, b)| light.center + u * a + v * b);
        let lamp = common::mesh(corners.to_vec(), vec![0, 1, 2, 0, 2, 3]);
        let s =
            scene(vec![quad(Vec3::ZERO, Vec2::splat(9.0)), lamp], camera(Vec3::new(0.0, 0.9, 2.2), Vec3::ZERO), light);
        let r = traced(&s, &Settings { light_samples: 256, ..Settings::of_size(32, 32) });
        assert!(r.visibility.iter().zip(&r.valid).all(|(v, ok)| !ok || *v == 1.0));
    }
}

/// A masked quad over a floor, the left half (u < 1/2) of its texture cut out, and a point light: lit where the
/// straight line to the light passes the left half.
#[test]
fn masked_materials_have_holes_for_camera_and_shadow_rays() {
    let rgba = [0u8, 255].iter().flat_map(|&a| [200, 200, 200, a]).collect();
    let texture = Texture { width: 2, height: 1, rgba, wrap: [Wrap::Clamp; 2], nearest: true };
    let mut masked = quad(Vec3::Y, Vec2::ONE);
    masked.uvs = vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
    masked.material = 1;
    let mut s = scene(
        vec![quad(Vec3::ZERO, Vec2::splat(9.0)), masked],
        camera(Vec3::new(0.0, 8.0, 0.1), Vec3::ZERO),
        light_above(4.0, Vec2::ZERO),
    );
    let mut material = Material { texture: Some(Arc::new(texture)), alpha_cutoff: Some(0.5), ..Material::default() };
    s.materials.push(material.clone());
    let tracer = Tracer::new(&s);
    let light = Vec3::Y * 4.0;
    assert!(!tracer.occluded(Vec3::new(-0.6, 0.0, 0.1), light), "through the hole");
    assert!(tracer.occluded(Vec3::new(0.6, 0.0, 0.1), light), "behind the solid half");
    let down = |x: f32| antumbra_reference::Ray::new(Vec3::new(x, 5.0, 0.3), -Vec3::Y);
    assert_eq!(tracer.nearest(&down(-0.5)).map(|h| h.instance), Some(0));
    assert_eq!(tracer.nearest(&down(0.5)).map(|h| h.instance), Some(1));

    // The factor's alpha counts too.
    material.base_color.w = 0.4;
    s.materials[1] = material;
    assert!(!Tracer::new(&s).occluded(Vec3::new(0.6, 0.0, 0.1), light));
}
