//! Occluders that overlap on the light: joined they are right, summed up they are too dark.

use crate::Judged;
use crate::common::closed_form::Occluder;
use crate::common::{camera, compared, ground, light, quad, scene};
use antumbra_metrics::Metrics;
use antumbra_reference::Reference;
use antumbra_scene::{RectLight, Scene};
use glam::DVec3;

const SIZE: [u32; 2] = [96, 96];

/// Two squares of equal shadows from the light's centre, at two heights: one hides what the other does, and more.
const PAIR: [Occluder; 2] = [
    Occluder { center: [0.15, 1.5, 0.0], half: [0.25, 0.5] },
    Occluder { center: [-0.2, 0.75, 0.1], half: [0.4, 0.55] },
];

fn lamp() -> RectLight {
    light([0.0, 3.0, 0.0], [0.0; 3], 0.8)
}

fn pair() -> Scene {
    let quads = PAIR.iter().map(|o| quad(o.center, o.half));
    let view = camera([1.9, 0.7, 2.5], [0.0, 0.0, 0.0], 38.0);
    scene([ground(20.0)].into_iter().chain(quads).collect(), view, lamp())
}

/// The hidden part of the light by each of the two alone, and by both together, from a point of the ground.
fn hidden(p: DVec3) -> ([f64; 2], f64) {
    let light = lamp();
    let each = PAIR.map(|o| 1.0 - o.visibility(&light, p));
    // What both hide is a rectangle too: of a plate at the height of either that is in both projections.
    let grow = |o: &Occluder| f64::from(light.center.y) / f64::from(o.center[1]);
    let edge = |o: &Occluder, axis: usize, sign: f64| {
        let (p, c) = (p[2 * axis], f64::from(o.center[2 * axis]));
        p + (c + sign * f64::from(o.half[axis]) - p) * grow(o)
    };
    let overlap = |axis: usize| {
        let half = f64::from(light.size[axis]) / 2.0;
        let low = PAIR.iter().map(|o| edge(o, axis, -1.0)).fold(-half, f64::max);
        let high = PAIR.iter().map(|o| edge(o, axis, 1.0)).fold(half, f64::min);
        (high - low).max(0.0) / (2.0 * half)
    };
    (each, each[0] + each[1] - overlap(0) * overlap(1))
}

/// The closed form of a picture: of the union, and of the sum. Pixels off the ground are those of no value.
fn closed_forms(judged: &Judged) -> [Reference; 2] {
    let points = crate::common::closed_form::ground_points(&pair().camera, SIZE);
    let value = |i: usize, sum: bool| {
        let (each, both) = points[i].map_or(([0.0; 2], 0.0), hidden);
        if sum { (1.0 - each[0] - each[1]).max(0.0) as f32 } else { (1.0 - both) as f32 }
    };
    // The truth tells where the ground is: the closed form holds there and nowhere else.
    let on_ground = |i: usize| judged.truth.valid[i] && (value(i, false) - judged.truth.visibility[i]).abs() < 0.02;
    [false, true].map(|sum| Reference {
        visibility: (0..points.len()).map(|i| value(i, sum)).collect(),
        valid: (0..points.len()).map(on_ground).collect(),
        ..judged.truth.clone()
    })
}

#[test]
fn overlapping_occluders_are_joined_or_summed_up() {
    let judged = Judged::new(&pair(), SIZE, 256);
    let [union, sum] = closed_forms(&judged);
    let ground = union.valid.iter().filter(|v| **v).count();
    let both: Vec<bool> =
        (0..union.visibility.len()).map(|i| union.valid[i] && union.visibility[i] > sum.visibility[i] + 0.1).collect();
    let overlap = both.iter().filter(|b| **b).count();
    assert!(ground > 5000 && overlap > 150, "{ground} pixels of ground, {overlap} where the squares overlap");
    // Where the squares overlap on the light.
    let union_there = Reference { valid: both, ..union.clone() };
    let show = |what: &str, f: &Metrics| {
        println!("{what}: average {:.4}, max {:.4}, leak {:.4}, acne {:.5}", f.average_error, f.max, f.leak, f.acne);
    };
    for bits in [64, 256, 1024] {
        let spec = |join: &str| format!("backprojection:map=1024,layers=2,window=32,bits={bits},join={join}");
        let (joined, added) = (judged.picture(&spec("union")), judged.picture(&spec("sum")));
        let (by_union, by_sum) = (compared(&joined, &union), compared(&added, &sum));
        let [right, wrong] = [&joined, &added].map(|picture| compared(picture, &union_there));
        show(&format!("{bits} bits, union"), &by_union);
        show("sum, against the sum of both", &by_sum);
        show("union, where they overlap", &right);
        show("sum, where they overlap, against the union", &wrong);
        assert!(by_union.average_error < 0.5 / f64::from(bits) + 0.002, "{bits} bits: {by_union:?}");
        assert!(by_sum.average_error < 0.001, "{by_sum:?}");
        assert!(wrong.average_error > 10.0 * right.average_error, "{bits} bits: {right:?}, {wrong:?}");
        let darker = (0..joined.len()).filter(|i| union.valid[*i]).all(|i| added[i] <= joined[i] + 4.0 / bits as f32);
        assert!(darker, "{bits} bits: the sum is nowhere lighter");
    }
}
