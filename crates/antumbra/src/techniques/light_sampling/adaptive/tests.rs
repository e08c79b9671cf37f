//! Random refinement by the real shaders, compared with a tree that is refined in plain Rust and weighted in double
//! precision, and with the invariants of any tree.

mod refinement;
mod twin;

use super::state::Shape;
use super::*;
use crate::techniques::light_sampling::uniform::Weights;
use crate::testing::gpu;
use glam::Vec2;
use proptest::prelude::*;
use refinement::{KEPT, Refinement, slots_of};
use std::collections::{BTreeMap, BTreeSet};
use twin::{Cell, Tree};

/// A light, its settings, and how much the corners of its cells disagree.
#[derive(Clone, Debug)]
pub struct Trial {
    size: Vec2,
    settings: AdaptiveSamplingSettings,
    /// Of 0 to 15, the disagreement from which on a cell is split.
    limit: u32,
    seed: u64,
}

fn trials() -> impl Strategy<Value = Trial> {
    let sizes = prop_oneof![
        4 => Just(Vec2::new(0.9, 0.7)),
        1 => Just(Vec2::new(1.1, 0.0)),
        1 => Just(Vec2::new(0.0, 0.8)),
        1 => Just(Vec2::ZERO),
    ];
    let budgets = prop_oneof![4u32..40, 40u32..200, Just(1089)];
    let rule = prop_oneof![Just(Criterion::Local), Just(Criterion::Relative)];
    let weights = prop_oneof![Just(Weights::Area), Just(Weights::Paper)];
    let all = (sizes, 0u32..=7, budgets, rule, weights, 1u32..16, any::<u64>());
    all.prop_map(|(size, depth, maps, criterion, weights, limit, seed)| {
        // Thresholds: a hundredth of the light, or 16 points, 1/16 of the texels.
        let few = AdaptiveSamplingSettings { map: 16, depth, maps, criterion, weights, ..Default::default() };
        Trial { size, settings: AdaptiveSamplingSettings { tolerance: 0.01, epsilon: 1.0 / 16.0, ..few }, limit, seed }
    })
}

impl Trial {
    fn is_local(&self) -> bool {
        self.settings.criterion == Criterion::Local
    }

    fn threshold(&self) -> f32 {
        if self.is_local() { self.settings.tolerance } else { 16.0 }
    }

    /// Disagreement of a cell's corners, by its index: the threshold to the last bit where the disagreement is `limit`.
    fn measure(&self, frame: usize, cell: usize) -> f32 {
        let mixed = (self.seed ^ (frame as u64) << 32 ^ cell as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let mixed = (mixed ^ mixed >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let share = (mixed >> 60) as f32 / self.limit as f32;
        if self.is_local() { self.threshold() * share } else { (self.threshold() * share).floor() }
    }

    /// As the GPU has it.
    fn bits(&self, measure: f32) -> u32 {
        if self.is_local() { measure.to_bits() } else { measure as u32 }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn a_random_tree_is_refined_and_weighed_like_its_twin(trial in trials()) {
        let mut refinement = Refinement::new(trial.clone());
        let outcome = refinement.refine(0, false);
        let samples = refinement.check(&outcome);
        refinement.check_weights(&outcome);
        prop_assert_eq!(outcome.drawn, outcome.count);
        let mut twin = refinement.twin();
        let place: BTreeMap<Cell, usize> = twin.all_cells().into_iter().zip(0..).collect();
        let capacity = refinement.plan().capacity as usize;
        twin.refine(|c| trial.measure(0, place[&c]), trial.threshold(), capacity);
        prop_assert_eq!(&outcome.split, &twin.split);
        prop_assert_eq!(&samples, &twin.samples);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    #[test]
    fn resting_maps_stay_in_their_layers_and_no_other_is_taken_for_them(trial in trials()) {
        let mut refinement = Refinement::new(trial);
        for frame in 0..4 {
            let before = refinement.held.clone();
            let outcome = refinement.refine(frame, frame > 0);
            let samples = refinement.check(&outcome);
            refinement.check_weights(&outcome);
            prop_assert_eq!(&samples, &refinement.tree_of(&outcome).samples);
            for (slot, [sample, stage]) in outcome.slots.iter().enumerate() {
                prop_assert!(*stage != KEPT || before.get(&slot) == Some(sample), "layer {} was never drawn", slot);
            }
            // The same measures once more.
            prop_assert_eq!(refinement.refine(frame, true).drawn, 0);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    #[test]
    fn a_tree_that_is_carried_over_changes_by_two_maps_a_frame_and_settles(trial in trials(), rest in any::<bool>()) {
        let depth = trial.settings.depth.min(2);
        let trial = Trial { settings: AdaptiveSamplingSettings { depth, steady: true, ..trial.settings }, ..trial };
        let mut refinement = Refinement::new(trial.clone());
        let first = refinement.refine(0, false);
        let mut samples = refinement.check(&first);
        let mut frame = |measure: &dyn Fn(usize) -> f32| {
            let outcome = refinement.carry_over(measure, rest);
            let now = refinement.check(&outcome);
            assert!(now.difference(&samples).count() <= 2, "from {samples:?} to {now:?}");
            assert!(samples.difference(&now).count() <= 2, "from {samples:?} to {now:?}");
            let sum: f64 = outcome.entries.iter().map(|e| f64::from(e.weight)).sum();
            assert!((sum - 1.0).abs() < 1e-5, "weights add up to {sum}");
            samples = now;
            outcome
        };
        for k in 0..20 {
            frame(&|cell| trial.measure(1 + k / 8, cell));
        }
        // Nothing disagrees any more: the light's corners are left, with their final weights.
        let corners = Tree::new(Shape::new(trial.size, 0).axes, 0).samples.len();
        let last = (0..1000).map(|_| frame(&|_| 0.0)).find(|outcome| outcome.count as usize == corners);
        refinement.check_weights(&last.expect("never settles"));
    }
}

#[test]
fn every_layer_is_drawn_by_one_stage_whatever_the_layers_a_pass_can_draw() {
    for (evaluation, layers_per_pass) in
        [Evaluate::Array, Evaluate::Accumulate].into_iter().flat_map(|e| [1, 2, 3, 6, 8, 32].map(|n| (e, n)))
    {
        for (size, maps) in [(Vec2::ONE, 4), (Vec2::ONE, 21), (Vec2::ONE, 100), (Vec2::X, 4), (Vec2::X, 17)] {
            let settings = AdaptiveSamplingSettings { map: 16, maps, evaluation, tolerance: 0.0, ..Default::default() };
            let mut gpu = gpu().clone();
            gpu.capabilities.layers_per_pass = layers_per_pass;
            let refinement = Refinement::on(&gpu, Trial { size, settings, limit: 1, seed: 0 });
            let state = refinement.plan();
            for (level, rest) in (0..=state.shape.depth).flat_map(|level| [(level, false), (level, true)]) {
                let what = format!("{evaluation:?}, {layers_per_pass} a pass, {maps} maps, level {level}, {rest}");
                let drawn: Vec<usize> = state.chunks(level, rest).flat_map(|c| slots_of(&c.stage)).collect();
                let distinct: BTreeSet<usize> = drawn.iter().copied().collect();
                assert_eq!(drawn.len(), distinct.len(), "{what}: a layer is drawn twice");
                // Samples of this level may lie in any free layer, or behind those of the levels before: the corners of
                // the light, and at least five or one for each level with a split.
                let step = if size.y > 0.0 { 5 } else { 1 };
                let first = if rest || level == 0 { 0 } else { state.shape.samples_at(0) + step * (level - 1) };
                let end = if rest { state.capacity } else { state.shape.samples_at(level).min(state.capacity) };
                assert!(
                    (first..end).all(|s| distinct.contains(&(s as usize))),
                    "{what}: layers of {drawn:?} are left out"
                );
            }
        }
    }
}
