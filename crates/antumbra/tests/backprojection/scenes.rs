//! Built-in scenes: no light leaks, no false darkness, and packets find what single pixels find.

use crate::{Judged, largest_difference};

#[test]
fn four_layers_neither_leak_nor_darken() {
    let mut faults = Vec::new();
    // The grid's frustum is three times as wide as high, and its shadows a few texels: any technique leaks there with
    // a map of 1024 texels (pcss 0.029, 64 maps over the light 0.020).
    for (spec, map) in [("fence", 1024), ("bumpy", 1024), ("grid", 2048), ("spheres:segments=32", 1024)] {
        let judged = Judged::builtin(spec, [144, 144], 64);
        let f = judged.metrics(&format!("backprojection:layers=4,map={map}"));
        println!(
            "{spec}: average {:.4}, max {:.3}, leak {:.5} of {}, acne {:.5} of {}",
            f.average_error, f.max, f.leak, f.counts.umbra, f.acne, f.counts.lit
        );
        if f.leak >= 0.01 || f.acne >= 0.002 {
            faults.push(format!("{spec}: {f:?}"));
        }
    }
    assert!(faults.is_empty(), "{faults:#?}");
}

#[test]
fn masked_foliage_casts_its_shadow() {
    let judged = Judged::builtin("plant:leaves=8", [96, 96], 128);
    // The leaves hide each other: what is behind the first layer counts.
    for (layers, bound) in [(1, 0.04), (2, 0.018), (4, 0.016)] {
        let spec = format!("backprojection:layers={layers},window=16,spacing=1");
        let f = judged.metrics(&spec);
        println!("{spec}: average {:.4}, max {:.3}, leak {:.4}, acne {:.5}", f.average_error, f.max, f.leak, f.acne);
        assert!(f.average_error < bound && f.acne < 0.001, "{spec}: {f:?}");
        assert!(layers == 1 || f.leak < 0.012, "{spec}: {f:?}");
    }
}

/// By how much pictures by packets and by single pixels differ: at most and in the mean.
fn packet_differences(settings: &str) -> Vec<(String, f32, f32)> {
    let each = |spec: &&str| {
        let judged = Judged::builtin(spec, [96, 72], 1);
        let [single, packet] = ["backprojection:spacing=1", "packet:spacing=1"]
            .map(|name| judged.picture(&format!("{name},map=512,{settings}")));
        let differing = single.iter().zip(&packet).filter(|(a, b)| a != b).count();
        let most = largest_difference(&single, &packet);
        let mean = single.iter().zip(&packet).map(|(a, b)| (a - b).abs()).sum::<f32>() / single.len() as f32;
        println!("{spec}, {settings}: {differing} pixels differ, by {most:.5} at most, by {mean:.6} in the mean");
        (format!("{spec}, {settings}"), most, mean)
    };
    ["fence:slats=9", "spheres:segments=16", "plant:leaves=8"].iter().map(each).collect()
}

/// A packet opens some nodes that a pixel leaves, which tells of some points of the light in some pixels. Where little
/// of the light is above the horizon a point counts for more than its share of all.
const FEW_POINTS: f32 = 0.04;

#[test]
fn packets_find_what_single_pixels_find() {
    for settings in ["window=8", "bits=1024,layers=4,window=16"] {
        for (what, most, mean) in packet_differences(settings) {
            assert!(most <= FEW_POINTS && mean < 1e-5, "{what}: by {most}, by {mean} in the mean");
        }
    }
}

#[test]
fn packets_find_what_single_pixels_find_by_few_patches() {
    for (what, most, mean) in ["window=1", "window=2", "window=4"].iter().flat_map(|s| packet_differences(s)) {
        assert!(most <= FEW_POINTS && mean < 1e-5, "{what}: by {most}, by {mean} in the mean");
    }
}

#[test]
fn packets_are_the_same_in_every_picture() {
    let mut faults = Vec::new();
    for spec in ["spheres:segments=8", "plant:leaves=8"] {
        let judged = Judged::builtin(spec, [160, 120], 1);
        let first = judged.picture("packet:map=256");
        for _ in 0..6 {
            let again = judged.picture("packet:map=256");
            let differing = first.iter().zip(&again).filter(|(a, b)| a != b).count();
            if differing > 0 {
                faults.push(format!("{spec}: {differing} pixels, by up to {}", largest_difference(&first, &again)));
            }
        }
    }
    assert!(faults.is_empty(), "{faults:#?}");
}
