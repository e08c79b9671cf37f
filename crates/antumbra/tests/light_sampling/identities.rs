//! Settings and techniques that must give the same image, bit for bit.

use crate::common::builtin;
use crate::{assert_same, fresh, has_penumbra, hovering, largest_difference, seen};
use glam::Vec2;

/// A rectangle, and a line along either edge.
const LIGHTS: [Vec2; 3] = [Vec2::new(0.9, 0.7), Vec2::new(1.1, 0.0), Vec2::new(0.0, 0.8)];

#[test]
fn one_sample_with_one_lookup_is_a_hard_shadow() {
    // The plant has leaves that are cut out of a texture.
    for spec in ["square", "fence:slats=9", "disk:segments=16", "spheres:segments=16", "plant:leaves=8"] {
        let renderer = seen(&builtin(spec));
        let hard = fresh(&renderer, "hard:map=256");
        let one = fresh(&renderer, "uniform-sampling:samples=1,pcf=1,map=256");
        assert!(hard.contains(&0.0) && hard.contains(&1.0), "{spec}: no shadow");
        assert_same(&one, &hard, spec);
    }
}

#[test]
fn cut_out_leaves_are_the_same_in_an_array_and_one_after_the_other() {
    let renderer = seen(&builtin("plant:leaves=8"));
    let by = |way: &str| fresh(&renderer, &format!("uniform-sampling:map=128,samples=9,evaluation={way}"));
    assert!(has_penumbra(&by("array")));
    assert_same(&by("array"), &by("accumulate"), "plant");
}

#[test]
fn maps_in_an_array_and_one_after_the_other_give_the_same_sum() {
    for (size, patterns) in [
        (LIGHTS[0], ["pattern=regular,samples=12", "pattern=stratified,samples=16", "samples=23"]),
        (LIGHTS[1], ["pattern=regular,samples=5", "pattern=stratified,samples=7", "samples=9"]),
        (LIGHTS[2], ["pattern=regular,samples=5,weights=paper", "pattern=stratified,samples=7", "samples=2"]),
        (Vec2::ZERO, ["pattern=regular,samples=9", "pattern=stratified,samples=3", "samples=1"]),
    ] {
        let renderer = seen(&hovering(size));
        for pattern in patterns {
            let by = |way: &str| fresh(&renderer, &format!("uniform-sampling:map=128,{pattern},evaluation={way}"));
            let array = by("array");
            assert!(has_penumbra(&array) || size == Vec2::ZERO, "{size} {pattern}: no penumbra");
            assert_same(&array, &by("accumulate"), &format!("{size} {pattern}"));
        }
    }
}

/// The grid of samples that a tree of this depth has once it is refined everywhere.
fn samples(size: Vec2, depth: u32) -> u32 {
    [size.x, size.y].iter().map(|edge| if *edge > 0.0 { (1 << depth) + 1 } else { 1 }).product()
}

#[test]
fn a_tree_that_is_refined_everywhere_is_a_regular_grid() {
    for size in LIGHTS {
        let renderer = seen(&hovering(size));
        for depth in 0..=3 {
            let n = samples(size, depth);
            for (weights, pcf, criterion) in [
                ("area", 1, "tolerance=0"),
                ("area", 2, "criterion=relative,epsilon=0"),
                ("area", 3, "tolerance=0"),
                ("paper", 1, "criterion=relative,epsilon=0"),
                ("paper", 2, "tolerance=0"),
                ("paper", 3, "criterion=relative,epsilon=0"),
            ] {
                let common = format!("map=64,pcf={pcf},weights={weights}");
                let grid = fresh(&renderer, &format!("uniform-sampling:pattern=regular,samples={n},{common}"));
                assert!(has_penumbra(&grid) || depth == 0, "{size}: no penumbra");
                let spec = format!("adaptive-sampling:filter=pcf,depth={depth},{criterion},{common}");
                assert_same(&fresh(&renderer, &spec), &grid, &format!("light of {size} m, {n} samples, {spec}"));
            }
        }
    }
}

#[test]
fn a_tree_that_is_summed_up_as_it_grows_counts_all_samples_the_same() {
    for size in LIGHTS {
        let renderer = seen(&hovering(size));
        for depth in 0..=3 {
            let common = "weights=paper,map=64";
            let n = samples(size, depth);
            let grid = fresh(&renderer, &format!("uniform-sampling:pattern=regular,samples={n},{common}"));
            for criterion in ["tolerance=0", "criterion=relative,epsilon=0"] {
                let spec =
                    format!("adaptive-sampling:filter=pcf,evaluation=accumulate,depth={depth},{criterion},{common}");
                let off = largest_difference(&fresh(&renderer, &spec), &grid);
                println!("light of {size} m, {n} maps, {criterion}: {off:e}");
                assert!(off < 1e-5, "light of {size} m, {n} maps, {criterion}: off by {off}");
            }
        }
    }
}

#[test]
fn a_tree_whose_maps_do_not_fit_into_memory_gives_the_same_sum() {
    for size in LIGHTS {
        let renderer = seen(&hovering(size));
        for settings in ["filter=pcf", "filter=cell", "filter=pcf,criterion=relative,epsilon=0.05", "maps=23"] {
            let by = |way: &str| fresh(&renderer, &format!("adaptive-sampling:map=64,evaluation={way},{settings}"));
            let array = by("array");
            assert!(has_penumbra(&array), "{size}: no penumbra");
            let off = largest_difference(&array, &by("accumulate"));
            println!("light of {size} m, {settings}: {off:e}");
            assert!(off < 1e-5, "light of {size} m, {settings}: off by {off}");
        }
    }
}
