//! Percentage-closer soft shadows with smooth, antialiased windows [Shen 2011, section 4].

mod common;

use antumbra_scene::{Mesh, Scene};
use common::{camera, ground, light, quad, scene, visibility};
use glam::Vec3;

/// Mean over squares of `side` x `side` pixels.
fn shrunk(picture: &[f32], size: [u32; 2], side: u32) -> Vec<f32> {
    let [width, height] = size;
    let mut small = vec![0.0; (width * height) as usize];
    for (i, v) in picture.iter().enumerate() {
        let (x, y) = (i as u32 % (width * side), i as u32 / (width * side));
        small[(y / side * width + x / side) as usize] += v / (side * side) as f32;
    }
    small
}

fn rmse(a: &[f32], b: &[f32]) -> f64 {
    let sum: f64 = a.iter().zip(b).map(|(a, b)| f64::from(a - b).powi(2)).sum();
    (sum / a.len() as f64).sqrt()
}

/// A large grid of bars parallel to the floor, over a camera that sees the floor up to the horizon [Shen 2011, figure
/// 11].
fn grid() -> Scene {
    let bars = (-50..=50).map(|i| 4.0 * i as f32);
    let mut grid = Mesh::default();
    for at in bars {
        for bar in [quad([at, 8.0, 0.0], [0.8, 200.0]), quad([0.0, 8.0, at], [200.0, 0.8])] {
            let first = grid.positions.len() as u32;
            grid.positions.extend(bar.positions);
            grid.indices.extend(bar.indices.iter().map(|i| i + first));
        }
    }
    let mut scene = scene(
        vec![ground(400.0), grid],
        camera([0.5, 3.0, 90.0], [1.5, 0.32, 78.0], 24.0),
        light([5.0, 60.0, 8.0], [5.0, 0.0, 7.9], 0.05),
    );
    scene.camera.far = 1000.0;
    scene
}

#[test]
fn analytic_antialiasing_is_better_than_64_samples_a_pixel() {
    const SIZE: [u32; 2] = [64, 48];
    let scene = grid();
    let by = |side: u32| shrunk(&visibility(&scene, "pcss:map=1024", SIZE.map(|s| side * s)), SIZE, side);
    let best = by(32);
    let ours = visibility(&scene, "smooth-pcss:map=1024", SIZE);
    let [plain, ours, few] = [by(1), ours, by(8)].map(|picture| rmse(&picture, &best));
    let text = format!("RMSE against 32 x 32 samples: 1 sample {plain:.4}, 8 x 8 {few:.4}, analytic {ours:.4}");
    println!("{text}");
    assert!(ours <= 0.02 && ours < few, "{text}");
}

/// A board that rises from the ground, so that its penumbra widens from nothing [Shen 2011, figure 4].
fn rising_board() -> Scene {
    let positions = [[-1.5, 0.0, -2.0], [0.0, 0.0, -2.0], [0.0, 1.6, 2.0], [-1.5, 1.6, 2.0]].map(Vec3::from).to_vec();
    let board = Mesh { positions, indices: vec![0, 1, 2, 0, 2, 3], ..Mesh::default() };
    scene(
        vec![ground(6.0), board],
        camera([0.6, 0.9, 3.4], [0.3, 0.0, 0.6], 40.0),
        light([0.5, 5.0, 0.0], [0.5, 0.0, 0.0], 0.8),
    )
}

#[test]
fn a_widening_penumbra_has_no_steps() {
    const SIZE: [u32; 2] = [256, 192];
    let scene = rising_board();
    let truth = common::truth(&scene, SIZE, 1024);
    for spec in ["pcss", "smooth-pcss:map=1024", "smooth-pcss", "smooth-pcss:map=4096"] {
        let ours = visibility(&scene, spec, SIZE);
        let mut worst = (0.0, 0, 0);
        let width = SIZE[0] as usize;
        for y in 2..SIZE[1] as usize - 2 {
            for x in 2..width - 2 {
                let step = |v: &[f32], i: usize| (v[i + 1] - v[i]).abs().max((v[i + width] - v[i]).abs());
                let around = (y - 2..=y + 2).flat_map(|y| (x - 2..=x + 2).map(move |x| y * width + x));
                if around.clone().any(|i| !truth.valid[i]) {
                    continue;
                }
                let steepest =
                    around.filter(|i| i + width < ours.len()).map(|i| step(&truth.visibility, i)).fold(0.0, f32::max);
                let beyond = step(&ours, y * width + x) - steepest;
                if beyond > worst.0 {
                    worst = (beyond, x, y);
                }
            }
        }
        let text = format!("{spec}: steepest step beyond the truth's near it, where: {worst:?}");
        println!("{text}");
        assert!(worst.0 <= 0.01, "{text}");
    }
}

/// A wall in a plane through the middle of the light, of which it sees half, and a roof over all of it.
fn wall_under_a_roof() -> Scene {
    let positions = [[0.0, 0.0, -1.0], [0.0, 0.0, 1.0], [0.0, 3.0, 1.0], [0.0, 3.0, -1.0]].map(Vec3::from).to_vec();
    let wall = Mesh { positions, indices: vec![0, 1, 2, 0, 2, 3], ..Mesh::default() };
    scene(
        vec![ground(6.0), wall, quad([0.0, 4.0, 0.0], [5.0, 5.0])],
        camera([4.0, 1.5, 0.0], [0.0, 1.5, 0.0], 20.0),
        light([0.0, 6.0, 0.0], [0.0, 0.0, 0.0], 1.0),
    )
}

#[test]
fn occluders_are_held_against_the_part_of_the_light_that_the_receiver_sees() {
    let scene = wall_under_a_roof();
    for spec in ["pcss", "smooth-pcss", "pvssm", "backprojection"] {
        let seen = visibility(&scene, spec, [32, 32]);
        let mean = seen.iter().map(|v| f64::from(*v)).sum::<f64>() / seen.len() as f64;
        println!("{spec}: {mean:.4} of the light on a wall in the dark");
        // All but what the map's texels leave open at the roof's rim. Without that part it is a quarter.
        assert!(mean < 0.02, "{spec}: {mean}");
    }
}
