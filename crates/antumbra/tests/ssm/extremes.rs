//! Scenes in which a formula divides by nothing, and settings at their ends.

use crate::common::{camera, cuboid, ground, light, quad, scene, visibility};
use crate::in_range;
use antumbra_scene::{Mesh, RectLight, Scene};

fn over_ground(occluders: Vec<Mesh>, light: RectLight) -> Scene {
    let meshes = std::iter::once(ground(10.0)).chain(occluders).collect();
    scene(meshes, camera([1.2, 2.4, 2.6], [0.0; 3], 50.0), light)
}

fn above() -> RectLight {
    light([0.0, 3.0, 0.0], [0.0; 3], 0.5)
}

const SPECS: [&str; 4] =
    ["ssm:map=64", "ssm:map=64,hierarchy=false", "ssm:map=64,accumulate=blend", "ssm:map=64,passes=1,format=float16"];

#[test]
fn an_empty_scene_is_lit() {
    for spec in SPECS {
        let picture = in_range(&over_ground(Vec::new(), above()), spec);
        assert!(picture.iter().all(|v| *v == 1.0), "{spec}");
        let mut nothing = over_ground(Vec::new(), above());
        nothing.instances.clear();
        assert!(in_range(&nothing, spec).iter().all(|v| *v == 1.0), "{spec}: nothing at all");
    }
}

#[test]
fn an_occluder_that_touches_the_receiver_has_a_sharp_shadow() {
    for spec in SPECS {
        for height in [0.0, 1e-6, 1e-3] {
            in_range(&over_ground(vec![quad([0.0, height, 0.0], [0.4, 0.4])], above()), spec);
        }
        in_range(&over_ground(vec![cuboid([-0.3, 0.0, -0.3], [0.3, 0.5, 0.3])], above()), spec);
        // Half of it is below.
        in_range(&over_ground(vec![cuboid([-0.3, -0.5, -0.3], [0.3, 0.5, 0.3])], above()), spec);
    }
}

#[test]
fn an_occluder_that_touches_the_light_is_no_division_by_nothing() {
    for spec in SPECS {
        for height in [2.9, 2.9999, 3.0] {
            in_range(&over_ground(vec![quad([0.0, height, 0.0], [0.2, 0.2])], above()), spec);
        }
        // A pillar from the ground through the light.
        let picture = in_range(&over_ground(vec![cuboid([-0.1, 0.0, -0.1], [0.1, 4.0, 0.1])], above()), spec);
        assert!(picture.iter().any(|v| *v < 0.5), "{spec}: a pillar casts");
    }
}

#[test]
fn what_is_behind_the_light_casts_nothing() {
    for spec in SPECS {
        let picture = in_range(&over_ground(vec![quad([0.0, 3.5, 0.0], [0.4, 0.4])], above()), spec);
        assert!(picture.iter().all(|v| *v == 1.0), "{spec}");
    }
    // A light that faces away leaves all dark.
    let away = RectLight { target: [0.0, 6.0, 0.0].into(), ..above() };
    for spec in SPECS {
        let scene = over_ground(vec![quad([0.0, 1.0, 0.0], [0.4, 0.4])], away);
        let picture = in_range(&scene, spec);
        let truth = crate::common::truth(&scene, crate::SIZE, 16);
        let same = picture.iter().zip(&truth.visibility).zip(&truth.valid).all(|((a, b), valid)| !valid || a == b);
        assert!(same, "{spec}");
    }
}

#[test]
fn an_occluder_larger_than_the_map_is_dark_within_it() {
    let mut narrow = above();
    narrow.shadow_fov_deg = Some(20.0);
    let scene = over_ground(vec![quad([0.0, 1.0, 0.0], [2.0, 2.0])], narrow);
    let view = camera([0.0, 0.9, 0.0], [0.0; 3], 40.0);
    for spec in SPECS {
        let picture = visibility(&Scene { camera: view, ..scene.clone() }, spec, [32, 32]);
        let middle = picture[16 * 32 + 16];
        assert!(middle < 0.01, "{spec}: {middle} under the middle");
        assert!(picture.iter().all(|v| (0.0..=1.0).contains(v)), "{spec}");
    }
}

#[test]
fn maps_of_any_size_serve() {
    let scene = over_ground(vec![quad([0.0, 1.0, 0.0], [0.4, 0.3])], above());
    let fine = in_range(&scene, "ssm:map=256");
    for map in [1, 2, 7, 9, 63, 100, 129] {
        for rest in ["", ",hierarchy=false", ",accumulate=blend"] {
            let picture = in_range(&scene, &format!("ssm:map={map}{rest}"));
            let (mean, _) = crate::difference(&picture, &fine);
            assert!(map < 63 || mean < 0.012, "map={map}{rest}: mean difference {mean} to a map of 256");
        }
    }
}
