//! Who casts and who receives, and the projection on receivers at several depths.

use crate::common::closed_form::pixel_ray;
use crate::common::{camera, compared, cuboid, ground, light, quad, scene, truth};
use crate::{SIZE, in_range};
use antumbra::input::casters::Role;
use antumbra::input::classification::roles;
use antumbra_scene::Scene;
use glam::DVec2;

/// A square over a step and the ground.
fn over_a_step() -> Scene {
    let meshes = vec![ground(10.0), cuboid([-2.0, 0.0, -2.0], [0.0, 0.5, 2.0]), quad([0.1, 1.4, 0.0], [0.5, 0.4])];
    scene(meshes, camera([1.6, 2.6, 2.2], [0.0, 0.2, 0.0], 50.0), light([0.4, 3.5, 0.2], [0.0; 3], 0.7))
}

#[test]
fn what_is_above_another_surface_casts_by_default() {
    let mut scene = over_a_step();
    assert_eq!(roles(&scene), [Role::Receiver, Role::Caster, Role::Caster]);
    // Nothing says that the ground only receives: it is above nothing.
    scene.instances[0].receiver_only = false;
    assert_eq!(roles(&scene), [Role::Ground, Role::Caster, Role::Caster]);
    // Without the ground the step is the lowest.
    scene.instances.remove(0);
    assert_eq!(roles(&scene), [Role::Ground, Role::Caster]);
    scene.instances.remove(0);
    assert_eq!(roles(&scene), [Role::Ground]);
}

#[test]
fn tiles_side_by_side_are_all_ground() {
    let tile = |x: f32| quad([x, 0.0, 0.0], [1.0, 2.0]);
    let meshes = vec![tile(-2.0), tile(0.0), tile(2.0), quad([0.3, 0.8, 0.2], [0.2, 0.2])];
    let mut scene = scene(meshes, camera([1.2, 2.4, 2.6], [0.0; 3], 50.0), light([1.5, 3.0, 0.7], [0.0; 3], 0.4));
    scene.instances[0].receiver_only = false;
    assert_eq!(roles(&scene), [Role::Ground, Role::Ground, Role::Ground, Role::Caster]);
}

#[test]
fn the_ground_receives_whether_it_says_so_or_not() {
    let mut scene = over_a_step();
    let said = in_range(&scene, "ssm:map=128");
    scene.instances[0].receiver_only = false;
    assert_eq!(said, in_range(&scene, "ssm:map=128"));
}

#[test]
fn nothing_bleeds_from_one_receiver_to_another() {
    let mut scene = over_a_step();
    scene.instances[1].receiver_only = true;
    for spec in ["ssm:map=256", "ssm:map=256,hierarchy=false", "ssm:map=128,accumulate=blend"] {
        let truth = truth(&scene, SIZE, 512);
        let picture = in_range(&scene, spec);
        let figures = compared(&picture, &truth);
        assert!(figures.average_error < 0.02, "{spec}: {figures:?}");
        // Beside the step's rim there is ground in deep shadow and lit step, one pixel from the other.
        assert!(figures.max < 0.2, "{spec}: {figures:?}");
    }
}

#[test]
fn a_lit_wall_is_lit_down_to_its_foot_and_its_shadow_starts_there() {
    let meshes = vec![ground(10.0), cuboid([-0.8, 0.0, -0.6], [0.4, 0.7, 0.0])];
    let scene = scene(meshes, camera([0.3, 1.0, 1.6], [0.0, 0.1, 0.0], 50.0), light([-2.0, 4.0, 1.5], [0.0; 3], 0.5));
    let truth = truth(&scene, SIZE, 256);
    // Where the rays of pixels meet the wall z = 0, which faces light and camera: the height, or nothing.
    let pixels =
        (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5)));
    let heights: Vec<Option<f64>> = pixels
        .map(|p| pixel_ray(&scene.camera, SIZE, p))
        .map(|(eye, d)| eye - d * (eye.z / d.z))
        .map(|at| (at.x > -0.79 && at.x < 0.39 && at.y > 0.002 && at.y < 0.69).then_some(at.y))
        .collect();
    for (map, rest, error, leak) in [
        (32, "", 0.08, 0.035),
        (128, "", 0.016, 0.006),
        (128, ",hierarchy=false", 0.016, 0.006),
        (128, ",accumulate=blend", 0.016, 0.006),
    ] {
        let spec = format!("ssm:map={map}{rest}");
        let picture = in_range(&scene, &spec);
        let wall: Vec<(f64, f32)> = heights.iter().zip(&picture).filter_map(|(h, v)| Some(((*h)?, *v))).collect();
        let (height, darkest) = wall.iter().fold((0.0, 1.0), |a, b| if b.1 < a.1 { *b } else { a });
        assert!(wall.len() > 500, "the wall is in the picture: {} pixels", wall.len());
        assert!(darkest > 0.99, "{spec}: {darkest} at a height of {height} m");
        let figures = compared(&picture, &truth);
        assert!(figures.average_error < error && figures.leak < leak, "{spec}: {figures:?}");
    }
}
