//! Two ways to add up, two formats of the sums, levels and one map.

use crate::common::{bumpy_ball, camera, compared, drawn, gpu, ground, light, scene, shadowed, technique, truth};
use crate::{SIZE, difference, in_range};
use antumbra::techniques::ssm::largest_float16_q;
use antumbra_scene::Scene;
use pollster::block_on;

/// A bumpy ball that stands on the ground, under a wide light.
fn ball() -> Scene {
    let meshes = vec![ground(10.0), bumpy_ball([0.0, 0.6, 0.0], 0.5, 4)];
    scene(meshes, camera([1.2, 3.2, 2.6], [0.0, 0.0, 0.0], 50.0), light([0.5, 3.0, 0.3], [0.0; 3], 0.8))
}

#[test]
fn gathering_and_blending_add_up_the_same() {
    let scene = ball();
    for rest in ["map=64,hierarchy=false", "map=128", "map=100,passes=1"] {
        let [gather, blend] = ["gather", "blend"].map(|by| in_range(&scene, &format!("ssm:{rest},accumulate={by}")));
        let (_, largest) = difference(&gather, &blend);
        assert!(largest < 2e-4, "{rest}: they differ by {largest}");
    }
}

#[test]
fn levels_give_the_flat_map_s_picture() {
    let scene = ball();
    let flat = in_range(&scene, "ssm:map=256,hierarchy=false");
    for (window, mean, largest) in [(4, 0.006, 0.2), (8, 0.003, 0.12), (16, 0.0015, 0.08), (32, 0.0008, 0.05)] {
        let found = difference(&flat, &in_range(&scene, &format!("ssm:map=256,window={window}")));
        assert!(found.0 < mean && found.1 < largest, "window={window}: mean and largest difference {found:?}");
    }
}

#[test]
fn two_passes_are_never_lighter_and_nearer_to_the_truth() {
    let scene = ball();
    let [one, two] = [1, 2].map(|passes| in_range(&scene, &format!("ssm:map=128,hierarchy=false,passes={passes}")));
    for (i, (one, two)) in one.iter().zip(&two).enumerate() {
        assert!(*two <= one + 1e-6, "pixel {i}: {two} by two passes, {one} by one");
    }
    // The ball itself takes no shadow in either, so the difference is that of the ground.
    let truth = truth(&scene, SIZE, 256);
    let [one, two] = [one, two].map(|picture| compared(&picture, &truth).average_error);
    assert!(two < 0.9 * one, "errors: {one} of one pass, {two} of two");
}

#[test]
fn sixteen_bits_lose_small_patches_and_levels_keep_them() {
    let mut wide = ball();
    wide.light.size *= 2.5;
    let picture = |rest: &str| in_range(&wide, &format!("ssm:map=256,passes=1,{rest}"));
    let [full, half] = ["float32", "float16"].map(|f| picture(&format!("hierarchy=false,format={f}")));
    let [levels, half_levels] = ["float32", "float16"].map(|f| picture(&format!("format={f}")));
    let (flat, on_levels) = (difference(&full, &half), difference(&levels, &half_levels));
    assert!(flat.1 > 0.05, "the flat map loses nothing: {flat:?}");
    assert!(on_levels.1 < 0.02, "levels lose something: {on_levels:?}");
}

#[test]
fn equation_4_tells_which_patches_are_lost() {
    let mut wide = ball();
    wide.light.size *= 2.5;
    let renderer = drawn(&wide, SIZE);
    let frame = &renderer.frame;
    let lost = |map: u32| {
        let mut ssm = technique(&format!("ssm:map={map},passes=1,hierarchy=false"));
        shadowed(&renderer, &mut ssm).unwrap();
        let figures = block_on(ssm.stats(gpu())).unwrap();
        let (_, lost) = figures.iter().find(|(name, _)| *name == "float16 loses").unwrap();
        let limit = largest_float16_q(1.0 / frame.frustum.receivers[1], frame.frustum.tan_half.x, map as f32, 2.0);
        (*lost > 0.0, limit)
    };
    // The ball's top is 1.9 m from the light, its bottom 2.9 m.
    let nearest_q = 1.0 / 1.75;
    for map in [32, 64, 128, 256] {
        let (lost, limit) = lost(map);
        assert!(!lost || nearest_q > limit, "map={map}: patches are lost below the limit {limit}");
    }
    assert!(!lost(32).0 && lost(256).0);
}
