//! A technique whose tree is refined by made-up measures, and the invariants of every tree.

use super::twin::{Cell, Tree};
use super::{Trial, gpu};
use crate::bindings;
use crate::gpu::device::Gpu;
use crate::gpu::pipeline::ComputePipeline;
use crate::gpu::readback::read_buffer;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::Resources;
use crate::passes::maps::light_maps::MapStage;
use crate::scene::SceneRenderer;
use crate::technique::TechniqueFactory;
use crate::techniques::light_sampling::adaptive::AdaptiveSampling;
use crate::techniques::light_sampling::adaptive::state::{self, TreePlan};
use crate::techniques::light_sampling::uniform::Weights;
use crate::testing::submit;
use glam::{DVec2, Vec2};
use pollster::block_on;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::RangeInclusive;

/// A technique whose maps are not drawn: its tree is refined by made-up measures.
pub struct Refinement {
    pub trial: Trial,
    technique: AdaptiveSampling,
    tree: state::Tree,
    /// The map in each layer.
    pub held: BTreeMap<usize, u32>,
}

/// The result of a frame on the GPU.
pub struct Outcome {
    /// Number of samples, and of maps drawn.
    pub count: u32,
    pub drawn: u32,
    pub split: BTreeSet<Cell>,
    layer_of: Vec<u32>,
    /// Sample and stage of each layer.
    pub slots: Vec<[u32; 2]>,
    pub entries: Vec<Weighed>,
}

#[derive(Debug)]
pub struct Weighed {
    sample: u32,
    layer: u32,
    pub weight: f32,
    reach: [Vec2; 2],
}

const NONE: u32 = u32::MAX;
pub const KEPT: u32 = u32::MAX - 1;

impl Refinement {
    pub fn new(trial: Trial) -> Refinement {
        Refinement::on(gpu(), trial)
    }

    pub fn on(gpu: &Gpu, trial: Trial) -> Refinement {
        let mut scene = antumbra_scene::builtin::build("square").unwrap_or_else(|e| panic!("{e}"));
        scene.light.size = trial.size;
        let renderer = SceneRenderer::new(gpu, &scene, [8, 8]).unwrap_or_else(|e| panic!("{e}"));
        let mut technique = AdaptiveSampling::make(gpu, trial.settings.clone()).unwrap_or_else(|e| panic!("{e}"));
        let (mut encoder, mut resources) =
            (gpu.device.create_command_encoder(&Default::default()), Resources::default());
        let mut recorder = Recorder::new(gpu, &mut encoder, &mut resources);
        let frame = renderer.frame.bind(&mut recorder).unwrap_or_else(|e| panic!("{e}"));
        let tree = technique.prepare(&frame, &mut recorder).unwrap_or_else(|e| panic!("{e}")).tree;
        drop(recorder);
        Refinement { trial, technique, tree, held: BTreeMap::new() }
    }

    pub fn plan(&self) -> &TreePlan {
        self.technique.plan.as_ref().expect("prepared")
    }

    pub fn twin(&self) -> Tree {
        Tree::new(self.plan().shape.axes, self.plan().shape.depth)
    }

    /// Runs one workgroup of each shader with its round, on the tree alone.
    fn run(&self, steps: &[(&ComputePipeline, u32)]) {
        let weigh = &*self.technique.pipelines.weigh;
        submit(|recorder| {
            steps.iter().try_for_each(|(pipeline, round)| {
                let step = self.tree.rounds.at(*round);
                let entries = bindings! { entry_list: &self.tree.entries };
                let entries = if std::ptr::eq(*pipeline, weigh) { &entries[..] } else { &[] };
                let set = [&self.tree.bindings()[..], bindings! { plan_step: &step }, entries];
                recorder.compute("refinement", pipeline, &set, Work::Groups([1, 1, 1]))
            })
        });
    }

    fn words(&self, buffer: &wgpu::Buffer) -> Vec<u32> {
        bytemuck::pod_collect_to_vec(&block_on(read_buffer(gpu(), buffer)).unwrap_or_else(|e| panic!("{e}")))
    }

    /// Builds the tree from the measures of a frame; maps rest or not.
    pub fn refine(&mut self, frame: usize, rest: bool) -> Outcome {
        let (plan, weigh) = (&self.technique.pipelines.plan, &self.technique.pipelines.weigh);
        self.run(&[(plan, TreePlan::round(0, rest, true))]);
        let count = self.tree.cells.size() as usize / 12;
        let cells: Vec<u32> = (0..count).flat_map(|k| [0, self.trial.bits(self.trial.measure(frame, k)), 0]).collect();
        gpu().queue.write_buffer(&self.tree.cells, 0, bytemuck::cast_slice(&cells));
        let levels = 1..=self.plan().shape.depth;
        let mut steps: Vec<(&ComputePipeline, u32)> =
            levels.map(|level| (&**plan, TreePlan::round(level, rest, true))).collect();
        steps.push((weigh, TreePlan::round(0, false, true)));
        self.run(&steps);
        let outcome = self.outcome();
        self.draw(&outcome, 0..=self.plan().shape.depth, rest);
        outcome
    }

    fn outcome(&self) -> Outcome {
        let s = &self.tree;
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
            let ranges: Vec<_> = self.plan().chunks(level, rest).map(|c| slots_of(&c.stage)).collect();
            for slot in ranges.into_iter().flatten().filter(|s| *s < outcome.slots.len()) {
                if outcome.slots[slot][1] == level {
                    self.held.insert(slot, outcome.slots[slot][0]);
                    drawn += 1;
                }
            }
        }
        assert_eq!(drawn, outcome.drawn, "maps that passes draw, and maps that the tree counts as drawn");
    }

    /// Carries the tree over from frame to frame; `measure` is the last frame's.
    pub fn carry_over(&mut self, measure: impl Fn(usize) -> f32, rest: bool) -> Outcome {
        let mut cells = self.words(&self.tree.cells);
        for (k, words) in cells.chunks_exact_mut(3).enumerate() {
            words[1] = self.trial.bits(measure(k));
        }
        gpu().queue.write_buffer(&self.tree.cells, 0, bytemuck::cast_slice(&cells));
        let (steady, weigh) = (&self.technique.pipelines.steady, &self.technique.pipelines.weigh);
        self.run(&[(steady, TreePlan::round(0, rest, false)), (weigh, TreePlan::round(0, false, false))]);
        let outcome = self.outcome();
        self.draw(&outcome, 0..=0, true);
        outcome
    }

    /// The tree whose cells are split like this.
    pub fn tree_of(&self, outcome: &Outcome) -> Tree {
        Tree::of_splits(self.plan().shape.axes, self.plan().shape.depth, outcome.split.clone())
    }

    /// Invariants of every tree. Returns the samples that have a layer.
    pub fn check(&self, outcome: &Outcome) -> BTreeSet<u32> {
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
    pub fn check_weights(&self, outcome: &Outcome) {
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
pub fn slots_of(stage: &MapStage) -> std::ops::Range<usize> {
    let first = stage.first_slot + stage.first_group * stage.layers;
    first as usize..(first + stage.group_count * stage.layers) as usize
}
