//! Who casts and who receives, and the projection on receivers at several depths.

use crate::common::{camera, compared, cuboid, ground, light, quad, scene, truth};
use crate::{SIZE, in_range};
use antumbra::casters::Role;
use antumbra::roles::roles;
use antumbra_scene::Scene;

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
