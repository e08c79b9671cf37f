//! Scenes of public bug reports, each made for one fault, against the truth.

mod common;

use antumbra_metrics::Metrics;
use antumbra_scene::{Camera, Mesh, RectLight, Scene};
use common::{camera, compared, cuboid, ground, light, quad, truth, visibility};
use glam::{Vec2, Vec3};

const SIZE: [u32; 2] = [128, 128];

fn error(scene: &Scene, spec: &str) -> Metrics {
    let found = compared(&visibility(scene, spec, SIZE), &truth(scene, SIZE, 256));
    println!("{spec}: error {:.4}, leak {:.4}, acne {:.5}", found.average_error, found.leak, found.acne);
    found
}

/// A vertical rectangle in the plane x = `x`.
fn wall(x: f32, z: [f32; 2], height: f32) -> Mesh {
    let positions = [[z[0], 0.0], [z[1], 0.0], [z[1], height], [z[0], height]].map(|[z, y]| Vec3::new(x, y, z));
    Mesh { positions: positions.to_vec(), indices: vec![0, 1, 2, 0, 2, 3], ..Mesh::default() }
}

/// A box on a ground that reaches to the horizon.
fn on_ground(half: f32) -> Scene {
    let meshes = vec![ground(half), cuboid([-0.3, 0.0, -0.3], [0.3, 0.6, 0.3])];
    let view = Camera { far: 2.0 * half, ..camera([1.5, 1.8, 2.0], [0.0, 0.2, 0.0], 35.0) };
    common::scene(meshes, view, light([-1.5, 4.0, 1.0], [0.0, 0.3, 0.0], 0.8))
}

#[test]
fn casters_in_the_last_third_of_a_map_are_not_lost() {
    let meshes = vec![ground(10.0), cuboid([0.05, 0.0, -0.65], [0.55, 0.5, -0.15])];
    let scene = common::scene(
        meshes,
        camera([0.0, 1.6, 1.9], [0.3, 0.1, -0.4], 35.0),
        light([0.1, 3.36, 0.2], [0.1, 0.0, 0.2], 0.2),
    );
    for spec in ["backprojection:map=768", "packet:map=1536", "backprojection:map=1024"] {
        let found = error(&scene, spec);
        assert!(found.average_error < 0.02 && found.leak < 0.01, "{spec}: {found:?}");
    }
}

#[test]
fn a_huge_ground_is_as_good_as_a_small_one() {
    for technique in [
        "hard",
        "pcss",
        "vsm",
        "evsm",
        "msm",
        "csm",
        "savsm",
        "cssm",
        "uniform-sampling",
        "alias-free",
        "alias-free-soft",
    ] {
        let spec = if technique == "alias-free-soft" { technique.to_owned() } else { format!("{technique}:map=512") };
        for casts in [false, true] {
            let [small, huge] = [10.0, 500.0].map(|half| {
                let mut scene = on_ground(half);
                scene.instances[0].receiver_only = !casts;
                error(&scene, &spec).average_error
            });
            assert!(huge < 1.2 * small + 0.005, "{spec}, casts {casts}: {huge:.4} on 500 m where 10 m has {small:.4}");
        }
    }
}

#[test]
fn a_wall_that_the_lights_middle_sees_edge_on_is_found() {
    let meshes = vec![ground(10.0), wall(0.0, [-0.5, 0.5], 1.0)];
    let scene =
        common::scene(meshes, camera([2.2, 2.4, 3.2], [0.0, 0.4, 0.0], 40.0), light([0.0, 3.0, 0.0], [0.0; 3], 1.0));
    let found = error(&scene, "adaptive-sampling");
    assert!(found.average_error < 0.03, "{found:?}");
}

#[test]
fn exponential_moments_of_a_caster_close_to_the_light_do_not_leak() {
    let at = |y: f32, half: f32| quad([0.0, y, 0.0], [half; 2]);
    let point = RectLight { size: Vec2::ZERO, ..light([0.0, 4.0, 0.0], [0.0; 3], 0.0) };
    let meshes = vec![ground(6.0), at(2.5, 0.25), at(2.2, 1.0)];
    let scene = common::scene(meshes, camera([0.6, 3.1, 1.6], [0.0, 2.2, 0.0], 45.0), point);
    for spec in ["evsm:format=rg32float", "evsm"] {
        let found = error(&scene, spec);
        assert!(found.leak < 0.03, "{spec}: {found:?}");
    }
}

#[test]
fn a_receiver_whose_horizon_cuts_the_light_is_as_dark_as_the_truth() {
    let wide = RectLight { size: Vec2::new(2.4, 0.8), up: Vec3::Z, ..light([0.7, 3.0, 0.0], [0.7, 0.0, 0.0], 1.0) };
    let meshes = vec![wall(0.0, [-2.0, 2.0], 4.0), quad([0.35, 1.2, 0.0], [0.3; 2])];
    let scene = common::scene(meshes, camera([4.0, 0.6, 0.6], [0.0, 0.3, 0.0], 40.0), wide);
    for spec in ["ssm", "adaptive-sampling", "uniform-sampling"] {
        let found = error(&scene, spec);
        assert!(found.average_error < 0.01, "{spec}: {found:?}");
    }
}

#[test]
fn an_occluder_under_a_surface_that_only_receives_casts() {
    let meshes = vec![ground(4.0), quad([0.0, 2.0, 0.0], [1.0; 2]), quad([0.0, 1.0, 0.0], [0.5; 2])];
    let view = camera([0.0, 1.6, 5.0], [0.0, 0.3, 0.0], 50.0);
    let mut scene = common::scene(meshes, view, light([0.0, 3.0, 0.0], [0.0; 3], 0.6));
    scene.instances[1].receiver_only = true;
    let found = error(&scene, "ssm");
    assert!(found.average_error < 0.01 && found.leak < 0.01, "{found:?}");
}
