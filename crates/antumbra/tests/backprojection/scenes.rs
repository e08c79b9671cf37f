//! Built-in scenes: no light leaks, no false darkness, and packets find what single pixels find.

use crate::{Judged, largest_difference};

#[test]
fn four_layers_neither_leak_nor_darken() {
    let mut faults = Vec::new();
    for spec in ["fence", "bumpy", "grid", "spheres:segments=32"] {
        let judged = Judged::builtin(spec, [144, 144], 64);
        let f = judged.figures("backprojection:layers=4");
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
    for spec in ["backprojection:layers=1", "backprojection:layers=2", "backprojection:layers=4", "pcss"] {
        let f = judged.figures(spec);
        println!("{spec}: average {:.4}, max {:.3}, leak {:.4}, acne {:.5}", f.average_error, f.max, f.leak, f.acne);
        assert!(spec == "pcss" || f.average_error < 0.06, "{spec}: {f:?}");
    }
}

#[test]
fn packets_find_what_single_pixels_find() {
    let mut faults = Vec::new();
    for spec in ["fence:slats=9", "spheres:segments=16", "plant:leaves=8"] {
        let judged = Judged::builtin(spec, [96, 72], 16);
        for (settings, bits) in [("", 256.0), (",window=2", 256.0), (",bits=1024,layers=4,window=16", 1024.0)] {
            let [single, packet] =
                ["backprojection", "packet"].map(|name| judged.picture(&format!("{name}:map=512{settings}")));
            let differing = single.iter().zip(&packet).filter(|(a, b)| a != b).count();
            let most = largest_difference(&single, &packet);
            let mean = single.iter().zip(&packet).map(|(a, b)| (a - b).abs()).sum::<f32>() / single.len() as f32;
            println!(
                "{spec}{settings}: {differing} pixels differ, by {} points at most, by {mean:.6} in the mean",
                most * bits
            );
            if most > 0.03 || mean > 2e-4 {
                faults.push(format!("{spec}{settings}: by {most}, by {mean} in the mean"));
            }
        }
    }
    assert!(faults.is_empty(), "{faults:#?}");
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
