//! The soft shadow is that of the rays, to within the number of points.

use super::common::{builtin, camera, compared, cuboid, ground, light, quad, scene, truth, visibility};
use antumbra_scene::Scene;

const SIZE: [u32; 2] = [64, 48];

/// Mean error against the truth.
fn error(scene: &Scene, spec: &str) -> f64 {
    let truth = truth(scene, SIZE, 1024);
    let figures = compared(&visibility(scene, spec, SIZE), &truth);
    println!("{} by {spec}: {figures:?}", scene.name);
    figures.average_error
}

#[test]
fn penumbrae_are_those_of_the_rays() {
    // With holes in leaves (plant), so that parts of the triangles are looked at one after the other.
    let scenes = [("fence", 0.007), ("layers", 0.007), ("cage", 0.009), ("plant:leaves=4", 0.008)];
    for (name, most) in scenes {
        for points in ["same", "moved"] {
            let found = error(&builtin(name), &format!("alias-free-soft:points={points}"));
            assert!(found < most, "{name}, {points} points: {found:.4} is over {most}");
        }
    }
}

#[test]
fn more_points_are_better() {
    let scene = builtin("fence");
    let errors = [32, 64, 128, 256].map(|n| error(&scene, &format!("alias-free-soft:samples={n}")));
    assert!(errors.windows(2).all(|e| e[1] < 0.85 * e[0]), "{errors:.4?}");
}

/// A board that the light's centre does not see, behind a smaller one, hides part of its rim.
#[test]
fn what_is_hidden_from_the_center_counts() {
    let near = quad([0.0, 2.5, 0.0], [0.25, 0.25]);
    let hidden = quad([0.0, 1.6, 0.0], [0.38, 0.38]);
    let light = light([0.0, 4.0, 0.0], [0.0; 3], 1.6);
    let view = camera([0.0, 3.9, 0.9], [0.0, 0.0, 0.0], 50.0);
    let both = scene(vec![ground(3.0), near.clone(), hidden], view, light);
    let alone = scene(vec![ground(3.0), near], view, light);
    let with = truth(&both, SIZE, 1024);
    let without = truth(&alone, SIZE, 1024);
    let changed = compared(&without.visibility, &with).average_error;
    assert!(changed > 0.02, "the hidden board should matter: {changed:.4}");
    let found = error(&both, "alias-free-soft");
    assert!(found < 0.006, "{found:.4}");
}

/// Walls through the light's plane and behind the light, and one through the ground.
#[test]
fn triangles_through_the_light_and_the_ground_hide_what_they_should() {
    let wall = cuboid([0.15, -1.0, -0.6], [0.25, 4.0, 0.5]);
    let roof = cuboid([-1.0, 2.4, -1.0], [1.0, 2.5, 1.0]);
    let scene = scene(
        vec![ground(4.0), wall, roof],
        camera([-2.2, 1.6, 2.4], [0.0, 0.2, 0.0], 50.0),
        light([-0.2, 2.0, 0.1], [-0.1, 0.0, 0.0], 0.8),
    );
    let found = error(&scene, "alias-free-soft");
    assert!(found < 0.006, "{found:.4}");
}
