//! `shaders/layers.wesl`: two layers of four nodes.

use crate::testing::{Random, Worst, evaluate};
use proptest::prelude::*;

#[derive(Clone, Copy, Debug)]
struct Layers {
    near: f64,
    far: f64,
    share: f64,
}

/// All eight layers, each with its part of the whole area, parted halfway between the nearest and the farthest.
fn merge_layers(nodes: [Layers; 4]) -> Layers {
    let all: Vec<(f64, f64)> =
        nodes.iter().flat_map(|n| [(n.near, n.share / 4.0), (n.far, (1.0 - n.share) / 4.0)]).collect();
    let there = || all.iter().filter(|(_, area)| *area > 0.0).map(|(q, _)| *q);
    let middle = 0.5 * (there().fold(f64::INFINITY, f64::min) + there().fold(0.0, f64::max));
    let sum = |keep: &dyn Fn(f64) -> bool| {
        let kept = all.iter().filter(|(q, _)| keep(*q));
        kept.fold((0.0, 0.0), |(q, area), (layer, part)| (q + layer * part, area + part))
    };
    let (near, far) = (sum(&|q| q >= middle), sum(&|q| q < middle));
    if far.1 <= 0.0 {
        return Layers { near: near.0 / near.1, far: near.0 / near.1, share: 1.0 };
    }
    Layers { near: near.0 / near.1, far: far.0 / far.1, share: near.1 }
}

/// Nodes of one layer and of two, empty ones, equal ones.
fn inputs(count: usize) -> Vec<[Layers; 4]> {
    let mut random = Random(11);
    let mut node = |i: usize, k: usize| {
        let scale = if i.is_multiple_of(2) { 1.0 } else { 1e3 };
        let mut q = || (random.unit() * scale).max(1e-6);
        let (a, b, share) = (q(), q(), (random.unit()).max(1e-3));
        match (i / 2 + k * (i / 7)) % 4 {
            0 => [a, a, 1.0],
            1 => [0.0, 0.0, 1.0],
            2 => [a.max(b), 0.0, share],
            _ => [a.max(b), a.min(b), share],
        }
    };
    let layers = |[near, far, share]: [f32; 3]| Layers { near: near.into(), far: far.into(), share: share.into() };
    (0..count).map(|i| std::array::from_fn(|k| layers(node(i, k)))).collect()
}

const KERNEL: &str = "
    import package::shaders::layers::{Layers, merge_layers, pack_layers, unpack_layers};
    fn evaluate(at: u32, to: u32) {
        var nodes: array<Layers, 4>;
        for (var k = 0u; k < 4u; k++) {
            nodes[k] = Layers(input[at + 3u * k], input[at + 3u * k + 1u], input[at + 3u * k + 2u]);
        }
        let merged = unpack_layers(pack_layers(merge_layers(nodes)));
        output[to] = merged.near;
        output[to + 1u] = merged.far;
        output[to + 2u] = merged.share;
    }";

fn worst_on_gpu(twin: impl Fn([Layers; 4]) -> Layers) -> Worst {
    let inputs = inputs(4096);
    let words = inputs.iter().flatten().flat_map(|l| [l.near as f32, l.far as f32, l.share as f32]);
    let got = evaluate(KERNEL, &words.collect::<Vec<f32>>(), 12, 3);
    let mut worst = Worst::default();
    for (got, nodes) in got.iter().zip(&inputs) {
        let exact = twin(*nodes);
        let off = |got: f32, exact: f64, scale: f64| (f64::from(got) - exact).abs() / scale.max(1e-30);
        let error = off(got[0], exact.near, exact.near.max(1e-6))
            .max(off(got[1], exact.far, exact.near.max(1e-6)))
            .max(off(got[2], exact.share, 1.0));
        worst.see(error, || format!("{nodes:?}: {got:?} instead of {exact:?}"));
    }
    worst
}

#[test]
fn the_gpu_agrees_with_its_twin() {
    let worst = worst_on_gpu(merge_layers);
    println!("{worst:?}");
    assert!(worst.error < 2e-6, "{worst:?}");
}

#[test]
fn a_node_that_counts_twice_is_caught() {
    let worst = worst_on_gpu(|[a, b, c, _]| merge_layers([a, b, c, c]));
    assert!(worst.error > 0.05, "{worst:?}");
}

fn mean(nodes: &[Layers]) -> f64 {
    nodes.iter().map(|n| n.near * n.share + n.far * (1.0 - n.share)).sum::<f64>() / nodes.len() as f64
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(2048) })]

    #[test]
    fn two_layers_keep_the_mean_and_lie_within_the_bounds(
        values in prop::array::uniform4((0.0f64..10.0, 0.0f64..10.0, 0.01f64..1.0)),
    ) {
        let nodes = values.map(|(a, b, share)| Layers { near: a.max(b), far: a.min(b), share });
        let merged = merge_layers(nodes);
        prop_assert!(merged.share > 0.0 && merged.share <= 1.0 && merged.near >= merged.far, "{merged:?}");
        prop_assert!((mean(&[merged]) - mean(&nodes)).abs() < 1e-9, "{merged:?}");
        let (low, high) = nodes.iter().fold((f64::MAX, 0f64), |(l, h), n| (l.min(n.far), h.max(n.near)));
        prop_assert!(merged.far >= low - 1e-9 && merged.near <= high + 1e-9, "{merged:?} outside of {low} to {high}");
    }

    #[test]
    fn an_occluder_before_a_background_comes_out_as_it_is(
        near in 2.0f64..10.0, far in 0.0f64..1.0, covered in prop::array::uniform4(any::<bool>()),
    ) {
        prop_assume!(covered.contains(&true) && covered.contains(&false));
        let one = |q| Layers { near: q, far: q, share: 1.0 };
        let merged = merge_layers(covered.map(|c| one(if c { near } else { far })));
        let share = covered.iter().filter(|c| **c).count() as f64 / 4.0;
        let off = (merged.near - near).abs().max((merged.far - far).abs()).max((merged.share - share).abs());
        prop_assert!(off < 1e-12, "{merged:?}");
    }
}

#[test]
fn a_node_of_two_words_keeps_its_layers() {
    let text = "
        import package::shaders::layers::Layers;
        import package::techniques::pvssm::tile_layers::{pack_node, unpack_node};
        fn evaluate(at: u32, to: u32) {
            let kept = unpack_node(pack_node(Layers(input[at], input[at + 1u], input[at + 2u])));
            output[to] = kept.near;
            output[to + 1u] = kept.far;
            output[to + 2u] = kept.share;
        }";
    let mut random = Random(12);
    let mut input = vec![0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 3.0e38, 1.0e-30, 0.0];
    for _ in 0..4096 {
        input.extend([random.decades(-6.0, 6.0), random.decades(-6.0, 6.0), random.unit()]);
    }
    let (mut distance, mut share) = (Worst::default(), Worst::default());
    for (exact, kept) in input.chunks_exact(3).zip(evaluate(text, &input, 3, 3)) {
        for (a, b) in exact[..2].iter().zip(&kept) {
            distance.see(f64::from((a - b).abs()) / f64::from(*a).max(1e-30), || format!("{exact:?} kept as {kept:?}"));
        }
        share.see(f64::from((exact[2] - kept[2]).abs()), || format!("{exact:?} kept as {kept:?}"));
    }
    // 18 bits of mantissa, 12 of the share.
    assert!(distance.error <= 0.5f64.powi(18), "{distance:?}");
    assert!(share.error <= 0.5 / 4095.0 + 1e-7, "{share:?}");
    assert_eq!(evaluate(text, &[0.25, 0.25, 1.0], 3, 3), [[0.25, 0.25, 1.0]], "a node of one layer is that exactly");
}
