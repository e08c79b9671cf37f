//! Frames with more pairs than the lists can hold.

use super::common::{camera, drawn, gpu, ground, light, scene, shadowed, technique, truth};
use super::differing;
use antumbra::Shadows;
use antumbra_scene::{Mesh, Scene};
use glam::Vec3;
use pollster::block_on;

const SIZE: [u32; 2] = [96, 96];

/// Slivers from rim to rim, one over another: each touches a row of texels across the whole map, and all lie before the
/// ground, so that none can be left out. The camera looks at the ground from below them: whether it sees one that is
/// thinner than a pixel is for the rasteriser to say.
fn slivers(count: u32) -> Scene {
    let mut mesh = Mesh::default();
    for i in 0..count {
        let angle = i as f32 * 2.399_963;
        let along = Vec3::new(angle.cos(), 0.0, angle.sin()) * 2.0;
        let across = Vec3::new(-along.z, 0.0, along.x) * 0.002;
        let middle =
            Vec3::new((i as f32 * 0.618).fract() - 0.5, 0.5 + 1e-4 * i as f32, (i as f32 * 0.445).fract() - 0.5);
        let first = mesh.positions.len() as u32;
        mesh.positions.extend([middle - along, middle + along + across, middle + along - across]);
        mesh.indices.extend([first, first + 1, first + 2]);
    }
    scene(
        vec![ground(1.0), mesh],
        camera([0.0, 0.45, 1.2], [0.0, 0.0, 0.2], 40.0),
        light([0.3, 4.0, 0.2], [0.0; 3], 0.0),
    )
}

/// The pairs of the last frame, and the capacity of the next.
fn pairs_and_capacity(shadows: &Shadows) -> [f64; 2] {
    let stats = block_on(shadows.stats(gpu())).unwrap_or_else(|e| panic!("{e}"));
    let of = |name| stats.iter().find(|(n, _)| *n == name).unwrap_or_else(|| panic!("no {name} in {stats:?}")).1;
    [of("triangle-texel pairs").max(of("triangle-block pairs")), of("room for pairs")]
}

#[test]
fn a_frame_without_room_has_the_same_picture() {
    let scene = slivers(700);
    let renderer = drawn(&scene, SIZE);
    let truth = truth(&scene, SIZE, 1);
    let roomy = shadowed(&renderer, &mut technique("alias-free:map=512")).expect("records");
    let dark = roomy.iter().filter(|v| **v == 0.0).count();
    assert!(dark > 200 && dark < 8900, "{dark} pixels are dark");
    let wrong = differing(&roomy, &truth.visibility, &truth.valid);
    assert!(wrong <= 3, "{wrong} pixels differ from the rays");
    for spec in ["alias-free:map=512,budget=0", "alias-free:map=512,budget=1"] {
        let mut small = technique(spec);
        for frame in 0..2 {
            let picture = shadowed(&renderer, &mut small).expect("records");
            assert!(picture == roomy, "{spec}, frame {frame}: the picture differs");
            let [needed, room] = pairs_and_capacity(&small);
            assert!(needed > room, "{spec} should break: {needed} pairs, room for {room}");
        }
    }
}

#[test]
fn room_grows_to_what_frames_need() {
    let renderer = drawn(&slivers(1600), SIZE);
    let mut one = technique("alias-free:map=512");
    // 65 536 at first.
    let mut rooms = Vec::new();
    let mut pictures = Vec::new();
    for _ in 0..4 {
        pictures.push(shadowed(&renderer, &mut one).expect("records"));
        rooms.push(pairs_and_capacity(&one));
    }
    assert!(rooms[0][0] > rooms[0][1], "the first frame should have too little room: {rooms:?}");
    assert!(rooms[3][0] <= rooms[3][1], "later frames should have enough: {rooms:?}");
    assert!(pictures.iter().all(|p| *p == pictures[0]), "pictures differ");
}
