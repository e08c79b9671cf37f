//! The rounds of a frame: plan, draw, reproject, compare; then weigh and evaluate.

use super::Pipelines;
use super::state::{Chunk, State};
use crate::passes::maps::light_maps::{LightMaps, LightSamples};
use crate::passes::pixels::classify::PenumbraList;
use crate::passes::maps::depth_map::DepthMap;
use crate::gpu::pipeline::{Binding, ComputePipeline};
use crate::gpu::recorder::{Recorder, Work};
use crate::error::Error;
use crate::input::frame::Frame;
use crate::bindings;

/// Bytes in the tree's buffer where the arguments of indirect dispatches lie; see `state.wesl`.
const REPROJECT_GROUPS: u64 = 0;
const COMPARE_GROUPS: u64 = 16;

/// Maps are added up as soon as they are drawn: at every pixel, or at those of a list for the cells of the light.
#[derive(Clone, Copy)]
pub(super) struct Sum<'a> {
    pub list: Option<&'a PenumbraList>,
}

/// All that the passes of a frame read and write.
pub(super) struct Rounds<'a> {
    pub frame: &'a Frame,
    pub pipelines: &'a Pipelines,
    pub state: &'a State,
    pub samples: &'a LightSamples,
    pub maps: &'a LightMaps,
    /// What the light's centre sees, where comparisons are made in its space.
    pub light_view: Option<&'a DepthMap>,
}

impl Rounds<'_> {
    /// Builds the tree from its root, level by level [Schwärzler 2009, section 3.3].
    pub fn refine(&self, recorder: &mut Recorder, maps_rest: bool, at_once: Option<Sum>) -> Result<(), Error> {
        let depth = self.state.shape.depth;
        for level in 0..=depth {
            self.plan(recorder, level, maps_rest);
            for chunk in self.state.chunks(level, maps_rest) {
                self.draw_maps(recorder, chunk)?;
                if level < depth {
                    self.reproject(recorder, chunk);
                }
                if let Some(sum) = at_once {
                    self.accumulate(recorder, chunk, sum);
                }
            }
            if level < depth {
                self.compare(recorder);
            }
        }
        Ok(())
    }

    /// Draws all maps of the finished tree again, chunk by chunk, and adds them up by their weights.
    pub fn accumulate_again(&self, recorder: &mut Recorder, sum: Sum) -> Result<(), Error> {
        for chunk in (0..=self.state.shape.depth).flat_map(|level| self.state.chunks(level, false)) {
            self.draw_maps(recorder, chunk)?;
            self.accumulate(recorder, chunk, sum);
        }
        Ok(())
    }

    /// Changes the tree of the last frame by what that frame has measured, and measures again.
    pub fn change(
        &self,
        recorder: &mut Recorder,
        maps_rest: bool,
        jump: bool,
        at_once: Option<Sum>,
    ) -> Result<(), Error> {
        self.steady(recorder, maps_rest);
        self.weigh(recorder, jump);
        // New maps lie wherever there was room.
        for chunk in self.state.chunks(0, true) {
            self.draw_maps(recorder, chunk)?;
            self.reproject(recorder, chunk);
            if let Some(sum) = at_once {
                self.accumulate(recorder, chunk, sum);
            }
        }
        self.compare(recorder);
        Ok(())
    }

    /// Splits the cells of the level before whose corners disagree, and gives layers to their samples.
    fn plan(&self, recorder: &mut Recorder, level: u32, maps_rest: bool) {
        let step = self.state.plans.at(State::plan(level, maps_rest, true));
        let set = self.tree_bindings(bindings! { plan_step: &step });
        recorder.compute("refinement", &self.pipelines.plan, &set, Work::Groups([1, 1, 1]));
    }

    /// Notes what the new maps of a chunk hold at the points that are compared.
    fn reproject(&self, recorder: &mut Recorder, chunk: Chunk) {
        let state = self.state;
        let stage = state.stages.at(chunk.index);
        let mut more = bindings! {
            light_samples: &self.samples.buffer,
            light_maps: &self.maps.texture,
            map_stage: &stage,
            map_slots: &state.slots,
            values: &state.values,
        }
        .to_vec();
        if let Some(view) = self.light_view {
            more.extend_from_slice(bindings! { depth_map: &view.texture });
        }
        let set = self.frame.bindings(&self.tree_bindings(&more));
        let work = match state.is_chunked {
            true => Work::Groups([state.tiles, chunk.stage.group_count * chunk.stage.layers, 1]),
            false => Work::Indirect(&state.tree, REPROJECT_GROUPS),
        };
        recorder.compute("reprojection", &self.pipelines.reproject, &set, work);
    }

    /// Draws the new maps of a chunk.
    fn draw_maps(&self, recorder: &mut Recorder, chunk: Chunk) -> Result<(), Error> {
        let (slots, stages) = (&self.state.slots, &self.state.stages);
        self.maps.record(recorder, &self.frame.casters, self.samples, slots, stages, chunk.index)
    }

    /// Measures how much the corners of the new cells disagree.
    fn compare(&self, recorder: &mut Recorder) {
        let set = self.tree_bindings(bindings! { values: &self.state.values });
        recorder.compute("comparison", &self.pipelines.compare, &set, Work::Indirect(&self.state.tree, COMPARE_GROUPS));
    }

    /// Adds what the maps of a chunk see to the visibility.
    fn accumulate(&self, recorder: &mut Recorder, chunk: Chunk, sum: Sum) {
        let stage = self.state.stages.at(chunk.index);
        let mut more = bindings! {
            light_samples: &self.samples.buffer,
            light_maps: &self.maps.texture,
            map_stage: &stage,
            map_slots: &self.state.slots,
        }
        .to_vec();
        let Some((pipeline, list)) = self.pipelines.accumulate_cells.as_ref().zip(sum.list) else {
            let set = self.frame.bindings(&self.tree_bindings(&more));
            return self.for_each_pixel(recorder, &self.pipelines.accumulate, &set);
        };
        more.extend_from_slice(bindings! { penumbra_pixels: &list.buffer });
        let set = self.frame.bindings(&self.tree_bindings(&more));
        recorder.compute("visibility sum", pipeline, &set, Work::Indirect(&list.buffer, 0));
    }

    /// Ends the sum that chunks were added to.
    pub fn finish_sum(&self, recorder: &mut Recorder, sum: Sum) {
        if sum.list.is_some() {
            return; // Nothing is left to be done.
        }
        let set = self.frame.bindings(&self.tree_bindings(&[]));
        self.for_each_pixel(recorder, &self.pipelines.finish_sum, &set);
    }

    /// Makes this frame's changes to a tree that is carried over.
    fn steady(&self, recorder: &mut Recorder, maps_rest: bool) {
        let step = self.state.plans.at(State::plan(0, maps_rest, false));
        let set = self.tree_bindings(bindings! { plan_step: &step });
        recorder.compute("refinement", &self.pipelines.steady, &set, Work::Groups([1, 1, 1]));
    }

    /// Finds the weights of the tree, and goes there at once or a little of the way.
    pub fn weigh(&self, recorder: &mut Recorder, jump: bool) {
        let step = self.state.plans.at(State::plan(0, false, jump));
        let set = self.tree_bindings(bindings! { entry_list: &self.state.entries, plan_step: &step });
        recorder.compute("refinement", &self.pipelines.weigh, &set, Work::Groups([1, 1, 1]));
    }

    /// Adds up all maps of the tree.
    pub fn evaluate(&self, recorder: &mut Recorder) {
        self.state.evaluation.record(recorder, self.frame, self.samples, self.maps, &self.state.entries, 0);
    }

    /// Adds up what the maps of the tree see of the pixels in penumbra, each for its cell.
    pub fn evaluate_cells(&self, recorder: &mut Recorder, list: &PenumbraList) {
        let set = self.frame.bindings(&self.tree_bindings(bindings! {
            light_samples: &self.samples.buffer,
            light_maps: &self.maps.texture,
            entry_list: &self.state.entries,
            penumbra_pixels: &list.buffer,
        }));
        recorder.compute("visibility sum", &self.pipelines.evaluate_cells, &set, Work::Indirect(&list.buffer, 0));
    }

    fn for_each_pixel(&self, recorder: &mut Recorder, pipeline: &ComputePipeline, set: &[Binding]) {
        let [width, height] = self.frame.size;
        recorder.compute("visibility sum", pipeline, set, Work::Threads([width, height, 1]));
    }

    fn tree_bindings<'b>(&'b self, more: &[Binding<'b>]) -> Vec<Binding<'b>> {
        let s = self.state;
        let own = bindings! {
            adaptive: &s.uniform,
            tree: &s.tree,
            cells: &s.cells,
            grid: &s.grid,
            layer_of: &s.layer_of,
            slots: &s.slots,
            active_cells: &s.active_cells,
            fresh_layers: &s.fresh_layers,
        };
        [&own[..], more].concat()
    }
}
