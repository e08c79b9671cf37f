//! The rounds of a frame: plan, draw, reproject, compare; then weigh and evaluate.

use super::state::{Chunk, Tree, TreePlan};
use super::{Pipelines, VISIBILITY_SUM};
use crate::bindings;
use crate::error::Error;
use crate::gpu::bindings::Binding;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::texture::Texture;
use crate::input::frame::BoundFrame;
use crate::passes::maps::light_maps::LightMaps;
use crate::passes::pixels::classify::PenumbraList;

/// Bytes in the tree's buffer where the arguments of indirect dispatches lie; see `state.wesl`.
const REPROJECT_GROUPS: u64 = 0;
const COMPARE_GROUPS: u64 = 16;

/// Maps are added up as soon as they are drawn: at every pixel, or at those of a list for the cells of the light.
#[derive(Clone, Copy)]
pub(super) struct Sum<'a> {
    pub list: Option<&'a PenumbraList>,
}

/// The resources of a frame's passes.
pub(super) struct Rounds<'a> {
    pub frame: &'a BoundFrame,
    pub pipelines: &'a Pipelines,
    pub plan: &'a TreePlan,
    pub tree: &'a Tree,
    pub maps: &'a LightMaps,
    /// The map from the light's centre, where comparisons are made in its space.
    pub light_view: Option<&'a Texture>,
}

impl Rounds<'_> {
    /// Builds the tree from its root, level by level [Schwärzler 2009, section 3.3].
    pub fn refine(&self, recorder: &mut Recorder, maps_valid: bool, at_once: Option<Sum>) -> Result<(), Error> {
        let depth = self.plan.shape.depth;
        for level in 0..=depth {
            self.plan_level(recorder, level, maps_valid)?;
            for chunk in self.plan.chunks(level, maps_valid) {
                self.draw_maps(recorder, chunk)?;
                if level < depth {
                    self.reproject(recorder, chunk)?;
                }
                if let Some(sum) = at_once {
                    self.accumulate(recorder, chunk, sum)?;
                }
            }
            if level < depth {
                self.compare(recorder)?;
            }
        }
        Ok(())
    }

    /// Draws all maps of the finished tree again, chunk by chunk, and adds them up by their weights.
    pub fn accumulate_again(&self, recorder: &mut Recorder, sum: Sum) -> Result<(), Error> {
        for chunk in (0..=self.plan.shape.depth).flat_map(|level| self.plan.chunks(level, false)) {
            self.draw_maps(recorder, chunk)?;
            self.accumulate(recorder, chunk, sum)?;
        }
        Ok(())
    }

    /// Changes the tree of the last frame by the measures of that frame, and measures again.
    pub fn change(
        &self,
        recorder: &mut Recorder,
        maps_valid: bool,
        jump: bool,
        at_once: Option<Sum>,
    ) -> Result<(), Error> {
        self.steady(recorder, maps_valid)?;
        self.weigh(recorder, jump)?;
        // New maps lie in any free layer.
        for chunk in self.plan.chunks(0, true) {
            self.draw_maps(recorder, chunk)?;
            self.reproject(recorder, chunk)?;
            if let Some(sum) = at_once {
                self.accumulate(recorder, chunk, sum)?;
            }
        }
        self.compare(recorder)
    }

    /// Splits the cells of the level before whose corners disagree, and gives layers to their samples.
    fn plan_level(&self, recorder: &mut Recorder, level: u32, maps_valid: bool) -> Result<(), Error> {
        let step = self.tree.rounds.at(TreePlan::round(level, maps_valid, true));
        let set = [&self.tree.bindings()[..], bindings! { plan_step: &step }];
        recorder.compute("refinement", &self.pipelines.plan, &set, Work::Groups([1, 1, 1]))
    }

    /// Stores the values of a chunk's new maps at the points that are compared.
    fn reproject(&self, recorder: &mut Recorder, chunk: Chunk) -> Result<(), Error> {
        let stage = self.tree.stages.at(chunk.index);
        let values = bindings! { values: &self.tree.values };
        let view = self.light_view.map(|texture| crate::binding_array! { depth_map: texture });
        let work = match self.plan.is_chunked {
            true => Work::Groups([self.plan.tiles, chunk.stage.group_count * chunk.stage.layers, 1]),
            false => Work::Indirect(&self.tree.tree, REPROJECT_GROUPS),
        };
        let view = view.as_ref().map_or(&[][..], |view| &view[..]);
        let maps = self.map_bindings(&stage);
        let set = [&self.frame.bindings()[..], &self.tree.bindings(), &maps, values, view];
        recorder.compute("reprojection", &self.pipelines.reproject, &set, work)
    }

    /// Draws the new maps of a chunk.
    fn draw_maps(&self, recorder: &mut Recorder, chunk: Chunk) -> Result<(), Error> {
        let (slots, binding) = (&self.tree.slots, self.tree.stages.at(chunk.index));
        self.maps.record(recorder, &self.frame.casters, slots, &chunk.stage, &binding)
    }

    /// Measures the disagreement of the new cells' corners.
    fn compare(&self, recorder: &mut Recorder) -> Result<(), Error> {
        let set = [&self.tree.bindings()[..], bindings! { values: &self.tree.values }];
        recorder.compute("comparison", &self.pipelines.compare, &set, Work::Indirect(&self.tree.tree, COMPARE_GROUPS))
    }

    /// Adds the visibility through a chunk's maps.
    fn accumulate(&self, recorder: &mut Recorder, chunk: Chunk, sum: Sum) -> Result<(), Error> {
        let stage = self.tree.stages.at(chunk.index);
        let maps = self.map_bindings(&stage);
        let set = [&self.frame.bindings()[..], &self.tree.bindings(), &maps];
        let Some((pipeline, list)) = self.pipelines.accumulate_cells.as_ref().zip(sum.list) else {
            let work = Work::Pixels(self.frame.size);
            return recorder.compute(VISIBILITY_SUM, &self.pipelines.accumulate, &set, work);
        };
        let [frame, tree, maps] = set;
        let set = [frame, tree, maps, bindings! { penumbra_pixels: &list.buffer }];
        recorder.compute(VISIBILITY_SUM, pipeline, &set, Work::Indirect(&list.buffer, 0))
    }

    /// Ends the sum that chunks were added to.
    pub fn finish_sum(&self, recorder: &mut Recorder, sum: Sum) -> Result<(), Error> {
        if sum.list.is_some() {
            return Ok(()); // Sums over cells are complete.
        }
        let set = [&self.frame.bindings()[..], &self.tree.bindings()];
        recorder.compute(VISIBILITY_SUM, &self.pipelines.finish_sum, &set, Work::Pixels(self.frame.size))
    }

    /// Makes this frame's changes to a tree that is carried over.
    fn steady(&self, recorder: &mut Recorder, maps_valid: bool) -> Result<(), Error> {
        let step = self.tree.rounds.at(TreePlan::round(0, maps_valid, false));
        let set = [&self.tree.bindings()[..], bindings! { plan_step: &step }];
        recorder.compute("refinement", &self.pipelines.steady, &set, Work::Groups([1, 1, 1]))
    }

    /// Finds the weights of the tree, and changes to them at once or gradually.
    pub fn weigh(&self, recorder: &mut Recorder, jump: bool) -> Result<(), Error> {
        let step = self.tree.rounds.at(TreePlan::round(0, false, jump));
        let own = bindings! { entry_list: &self.tree.entries, plan_step: &step };
        let set = [&self.tree.bindings()[..], own];
        recorder.compute("refinement", &self.pipelines.weigh, &set, Work::Groups([1, 1, 1]))
    }

    /// Adds up all maps of the tree.
    pub fn evaluate(&self, recorder: &mut Recorder) -> Result<(), Error> {
        self.plan.evaluation.record(recorder, self.frame, self.maps, &self.tree.entries, 0)
    }

    /// Adds up the visibility of the pixels in penumbra through the tree's maps, each for its cell.
    pub fn evaluate_cells(&self, recorder: &mut Recorder, list: &PenumbraList) -> Result<(), Error> {
        let own = bindings! {
            adaptive: &self.tree.uniform,
            light_samples: &self.maps.samples,
            light_maps: &self.maps.texture,
            entry_list: &self.tree.entries,
            penumbra_pixels: &list.buffer,
        };
        let set = [&self.frame.bindings()[..], own];
        recorder.compute(VISIBILITY_SUM, &self.pipelines.evaluate_cells, &set, Work::Indirect(&list.buffer, 0))
    }

    fn map_bindings<'b>(&'b self, stage: &'b wgpu::BindingResource<'b>) -> [Binding<'b>; 4] {
        crate::binding_array! {
            light_samples: &self.maps.samples,
            light_maps: &self.maps.texture,
            map_stage: stage,
            map_slots: &self.tree.slots,
        }
    }
}
