//! Random refinement by the real shaders, held against a tree that is refined in plain Rust and weighed in double
//! precision, and against what has to hold for any tree.

mod twin;

use super::*;
use crate::pipeline::Binding;
use crate::recorder::Work;
use crate::resource::read_buffer;
use crate::scene::SceneRenderer;
use crate::techniques::uniform_sampling::Weights;
use crate::{AdapterChoice, bindings};
use glam::{DVec2, Vec2};
use pollster::block_on;
use proptest::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::RangeInclusive;
use std::sync::OnceLock;
use twin::{Cell, Tree};

/// A machine without an adapter fails the test.
fn gpu() -> &'static Gpu {
    static GPU: OnceLock<Gpu> = OnceLock::new();
    GPU.get_or_init(|| block_on(Gpu::new(&AdapterChoice::Best)).unwrap_or_else(|e| panic!("{e}")))
}

/// A light, its settings, and how much the corners of its cells disagree.
#[derive(Clone, Debug)]
struct Trial {
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

    /// What the corners of a cell disagree by, given its place in the list of cells: the threshold to the last bit where
    /// the disagreement is `limit`.
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

/// A technique whose maps are not drawn: its tree is refined by made-up measures.
struct Refinement {
    trial: Trial,
    technique: AdaptiveSampling,
    /// What the layers would hold.
    held: BTreeMap<usize, u32>,
}

/// What the GPU has made of a frame.
struct Outcome {
    /// Number of samples, and of maps drawn.
    count: u32,
    drawn: u32,
    split: BTreeSet<Cell>,
    layer_of: Vec<u32>,
    /// Sample and stage of each layer.
    slots: Vec<[u32; 2]>,
    entries: Vec<Weighed>,
}

#[derive(Debug)]
struct Weighed {
    sample: u32,
    layer: u32,
    weight: f32,
    reach: [Vec2; 2],
}

const NONE: u32 = u32::MAX;
const KEPT: u32 = u32::MAX - 1;

impl Refinement {
    fn new(trial: Trial) -> Refinement {
        Refinement::on(gpu(), trial)
    }

    fn on(gpu: &Gpu, trial: Trial) -> Refinement {
        let mut scene = antumbra_scene::builtin::build("square").unwrap_or_else(|e| panic!("{e}"));
        scene.light.size = trial.size;
        let renderer = SceneRenderer::new(gpu, &scene, [8, 8]).unwrap_or_else(|e| panic!("{e}"));
        let mut technique = AdaptiveSampling::make(gpu, trial.settings.clone()).unwrap_or_else(|e| panic!("{e}"));
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let prepared = technique.prepare(&renderer.frame, &mut Recorder::new(gpu, &mut encoder));
        prepared.unwrap_or_else(|e| panic!("{e}"));
        Refinement { trial, technique, held: BTreeMap::new() }
    }

    fn state(&self) -> &State {
        self.technique.state.as_ref().expect("prepared")
    }

    fn twin(&self) -> Tree {
        Tree::new(self.state().shape.axes, self.state().shape.depth)
    }

    /// Runs one workgroup of each shader: the plan that it is given, and nothing else but the tree.
    fn run(&self, steps: &[(&ComputePipeline, u32)]) {
        let s = self.state();
        let mut encoder = gpu().device.create_command_encoder(&Default::default());
        let mut recorder = Recorder::new(gpu(), &mut encoder);
        for (pipeline, plan) in steps {
            let step = s.plans.at(*plan);
            let set: &[Binding] = bindings! {
                adaptive: &s.uniform,
                tree: &s.tree,
                cells: &s.cells,
                grid: &s.grid,
                layer_of: &s.layer_of,
                slots: &s.slots,
                active_cells: &s.active_cells,
                fresh_layers: &s.fresh_layers,
                entry_list: &s.entries,
                plan_step: &step,
            };
            recorder.compute("refinement", pipeline, set, Work::Groups([1, 1, 1]));
        }
        gpu().queue.submit([encoder.finish()]);
    }

    fn words(&self, buffer: &wgpu::Buffer) -> Vec<u32> {
        bytemuck::pod_collect_to_vec(&block_on(read_buffer(gpu(), buffer)).unwrap_or_else(|e| panic!("{e}")))
    }

    /// Builds the tree anew from the measures of a frame; maps rest or not.
    fn refine(&mut self, frame: usize, rest: bool) -> Outcome {
        let (plan, weigh) = (&self.technique.pipelines.plan, &self.technique.pipelines.weigh);
        self.run(&[(plan, State::plan(0, rest, true))]);
        let count = self.state().cells.size() as usize / 12;
        let cells: Vec<u32> =
            (0..count).flat_map(|k| [0, self.trial.bits(self.trial.measure(frame, k)), 0]).collect();
        gpu().queue.write_buffer(&self.state().cells, 0, bytemuck::cast_slice(&cells));
        let levels = 1..=self.state().shape.depth;
        let mut steps: Vec<(&ComputePipeline, u32)> =
            levels.map(|level| (&**plan, State::plan(level, rest, true))).collect();
        steps.push((weigh, State::plan(0, false, true)));
        self.run(&steps);
        let outcome = self.outcome();
        self.draw(&outcome, 0..=self.state().shape.depth, rest);
        outcome
    }

    fn outcome(&self) -> Outcome {
        let s = self.state();
        let tree = self.words(&s.tree);
        let cells = self.words(&s.cells);
        let list = self.words(&s.entries);
        let float = |i: usize| f32::from_bits(list[i]);
        let vector = |i: usize| Vec2::new(float(i), float(i + 1));
        Outcome {
            count: tree[3],
            drawn: tree[7],
            split: (self.twin().all_cells().into_iter().zip(cells.chunks_exact(3)))
                .filter_map(|(cell, words)| (words[0] == 1).then_some(cell))
                .collect(),
            layer_of: self.words(&s.layer_of),
            slots: self.words(&s.slots).chunks_exact(2).map(|w| [w[0], w[1]]).collect(),
            entries: (0..list[0] as usize)
                .map(|k| 2 + 8 * k)
                .map(|i| Weighed {
                    sample: list[i],
                    layer: list[i + 1],
                    weight: float(i + 2),
                    reach: [vector(i + 4), vector(i + 6)],
                })
                .collect(),
        }
    }

    /// Draws the layers that have a stage, as the passes of a frame would, and counts them.
    fn draw(&mut self, outcome: &Outcome, levels: RangeInclusive<u32>, rest: bool) {
        let mut drawn = 0;
        for level in levels {
            let ranges: Vec<_> = self.state().chunks(level, rest).map(|c| slots_of(&c.stage)).collect();
            for slot in ranges.into_iter().flatten().filter(|s| *s < outcome.slots.len()) {
                if outcome.slots[slot][1] == level {
                    self.held.insert(slot, outcome.slots[slot][0]);
                    drawn += 1;
                }
            }
        }
        assert_eq!(drawn, outcome.drawn, "maps that passes draw, and maps that the tree counts as drawn");
    }

    /// Carries the tree over from frame to frame; `measure` is what the frame before has found.
    fn carry_over(&mut self, measure: impl Fn(usize) -> f32, rest: bool) -> Outcome {
        let mut cells = self.words(&self.state().cells);
        for (k, words) in cells.chunks_exact_mut(3).enumerate() {
            words[1] = self.trial.bits(measure(k));
        }
        gpu().queue.write_buffer(&self.state().cells, 0, bytemuck::cast_slice(&cells));
        let (steady, weigh) = (&self.technique.pipelines.steady, &self.technique.pipelines.weigh);
        self.run(&[(steady, State::plan(0, rest, false)), (weigh, State::plan(0, false, false))]);
        let outcome = self.outcome();
        self.draw(&outcome, 0..=0, true);
        outcome
    }

    /// The tree whose cells are split like this.
    fn tree_of(&self, outcome: &Outcome) -> Tree {
        Tree::of_splits(self.state().shape.axes, self.state().shape.depth, outcome.split.clone())
    }

    /// What holds for every tree. Returns the samples that have a layer.
    fn check(&self, outcome: &Outcome) -> BTreeSet<u32> {
        let has_map = |slot: &[u32; 2]| slot[0] != NONE && slot[1] != NONE;
        let list: Vec<u32> = outcome.slots.iter().filter(|s| has_map(s)).map(|s| s[0]).collect();
        let samples: BTreeSet<u32> = list.iter().copied().collect();
        assert_eq!(samples.len(), list.len(), "two layers have the same sample");
        assert_eq!(outcome.count as usize, list.len(), "number of samples");
        assert!(outcome.count <= self.trial.settings.maps, "{} samples", outcome.count);
        for leaf in self.tree_of(outcome).leaves() {
            let corners = self.tree_of(outcome).corners(leaf);
            assert!(corners.iter().all(|s| samples.contains(s)), "a corner of {leaf:?} is missing");
        }
        for &sample in &samples {
            let layer = outcome.layer_of[sample as usize] as usize;
            assert!(outcome.slots[layer][0] == sample, "sample {sample} in layer {layer}: {:?}", outcome.slots[layer]);
            assert_eq!(self.held.get(&layer), Some(&sample), "layer {layer} holds another map");
        }
        for entry in &outcome.entries {
            assert!(samples.contains(&entry.sample), "{entry:?} has no map");
            assert_eq!(entry.layer, outcome.layer_of[entry.sample as usize], "{entry:?}");
        }
        assert!(outcome.entries.windows(2).all(|w| w[0].sample < w[1].sample), "entries are not in order");
        samples
    }

    /// Weights and reaches of a tree that is not carried over.
    fn check_weights(&self, outcome: &Outcome) {
        let tree = self.tree_of(outcome);
        let by_area = self.trial.settings.weights == Weights::Area;
        let exact = if by_area { tree.area_weights() } else { tree.paper_weights() };
        assert_eq!(outcome.entries.len(), exact.len(), "number of weights");
        let mut sum = 0.0;
        for entry in &outcome.entries {
            let (weight, exact) = (f64::from(entry.weight), exact[&entry.sample]);
            sum += weight;
            let bound = if by_area { 0.0 } else { 1e-5 * exact };
            assert!((weight - exact).abs() <= bound, "sample {}: {weight} instead of {exact}", entry.sample);
            for (reach, exact) in entry.reach.iter().zip(tree.reach(entry.sample)) {
                let off = (reach.as_dvec2() - exact * DVec2::from(self.trial.size)).abs().max_element();
                assert!(off < 1e-6, "sample {}: {reach} instead of {exact} of the light", entry.sample);
            }
        }
        let bound = if by_area { 0.0 } else { 1e-6 };
        assert!((sum - 1.0).abs() <= bound, "weights add up to {sum}");
    }
}

/// The slots that a stage draws.
fn slots_of(stage: &MapStage) -> std::ops::Range<usize> {
    let first = stage.first_slot + stage.first_group * stage.layers;
    first as usize..(first + stage.group_count * stage.layers) as usize
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
        let capacity = refinement.state().capacity as usize;
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
        // Nothing disagrees any more: the light's corners are left, with what they count in the end.
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
            let settings = AdaptiveSamplingSettings { map: 16, maps, evaluation, ..Default::default() };
            let mut gpu = gpu().clone();
            gpu.capabilities.layers_per_pass = layers_per_pass;
            let refinement = Refinement::on(&gpu, Trial { size, settings, limit: 1, seed: 0 });
            let state = refinement.state();
            for (level, rest) in (0..=state.shape.depth).flat_map(|level| [(level, false), (level, true)]) {
                let what = format!("{evaluation:?}, {layers_per_pass} a pass, {maps} maps, level {level}, {rest}");
                let drawn: Vec<usize> = state.chunks(level, rest).flat_map(|c| slots_of(&c.stage)).collect();
                let distinct: BTreeSet<usize> = drawn.iter().copied().collect();
                assert_eq!(drawn.len(), distinct.len(), "{what}: a layer is drawn twice");
                // Samples of this level may lie anywhere where there was room, or behind those of the levels before: the
                // corners of the light, and at least five or one for each level with a split.
                let step = if size.y > 0.0 { 5 } else { 1 };
                let first = if rest || level == 0 { 0 } else { state.shape.samples_at(0) + step * (level - 1) };
                let end = if rest { state.capacity } else { state.shape.samples_at(level).min(state.capacity) };
                assert!((first..end).all(|s| distinct.contains(&(s as usize))), "{what}: layers of {drawn:?} are left out");
            }
        }
    }
}
