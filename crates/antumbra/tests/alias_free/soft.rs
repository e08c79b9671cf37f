//! The soft shadow is that of the rays, to within the number of points.

use super::common::{builtin, camera, compared, cuboid, ground, light, quad, scene, truth, visibility};
use antumbra_scene::{Material, Mesh, Scene, Texture, Wrap};
use glam::Vec2;
use std::sync::Arc;

const SIZE: [u32; 2] = [64, 48];

/// Mean error against the truth.
fn error(scene: &Scene, spec: &str) -> f64 {
    error_at(scene, spec, SIZE)
}

fn error_at(scene: &Scene, spec: &str, size: [u32; 2]) -> f64 {
    let truth = truth(scene, size, 1024);
    let figures = compared(&visibility(scene, spec, size), &truth);
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

/// Small boards, scattered from the ground to the light: all of them stand between each pixel and some point of the
/// light, and none hides much.
fn scattered(count: u32, half: [f32; 2]) -> Mesh {
    let place = |i: u32, step: f64| ((f64::from(i) + 0.5) * step).fract() as f32;
    let mut mesh = Mesh::default();
    for i in 0..count {
        // The golden ratio's sequence in three dimensions [Roberts 2018].
        let [x, y, z] = [0.819_172_513_4, 0.671_043_607_0, 0.549_700_478_3].map(|step| place(i, step));
        let board = quad([0.5 * (x - 0.5), 0.5 + 2.0 * y, 0.5 * (z - 0.5)], half);
        let first = mesh.positions.len() as u32;
        mesh.indices.extend(board.indices.iter().map(|k| first + k));
        mesh.positions.extend(board.positions);
        mesh.uvs.extend([Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y]);
    }
    mesh
}

/// Few pixels, so that a tile of them is close together and everything is in its shaft.
fn few_pixels(boards: Mesh) -> Scene {
    let view = camera([0.0, 0.4, 1.2], [0.0; 3], 12.0);
    scene(vec![ground(3.0), boards], view, light([0.0, 3.0, 0.0], [0.0; 3], 0.5))
}

/// llvmpipe ends the loops of a thread after 65 535 rounds in all, and leaves undone what comes after them. The bound
/// is that of 256 points of which each is hidden or not by itself.
#[test]
fn a_tile_may_meet_more_triangles_than_a_thread_goes_round() {
    let scene = few_pixels(scattered(16_000, [0.00002, 0.6]));
    for points in ["256", "480"] {
        let found = error_at(&scene, &format!("alias-free-soft:samples={points}"), [16, 16]);
        assert!(found < 0.03, "{points} points: {found:.4}");
    }
}

/// The same for points that are looked up in a material with holes, one round a point: of 1024 texels one is no hole.
#[test]
fn a_tile_may_look_up_more_points_than_a_thread_goes_round() {
    let mut scene = few_pixels(scattered(300, [0.8; 2]));
    let alpha = (0..1024).flat_map(|texel| [255, 255, 255, if texel == 400 { 255 } else { 0 }]).collect();
    let texture = Texture { width: 32, height: 32, rgba: alpha, wrap: [Wrap::Repeat; 2], nearest: true };
    let holes = Material { texture: Some(Arc::new(texture)), alpha_cutoff: Some(0.5), ..Material::default() };
    scene.materials.push(holes);
    scene.meshes[1].material = 1;
    for points in ["256", "480"] {
        let found = error_at(&scene, &format!("alias-free-soft:samples={points}"), [16, 16]);
        assert!(found < 0.03, "{points} points: {found:.4}");
    }
}
