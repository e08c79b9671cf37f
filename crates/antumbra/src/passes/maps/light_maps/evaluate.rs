//! Evaluation: each pixel adds up the visibility of the samples in a list.

use super::LightMaps;
use crate::error::Error;
use crate::gpu::device::Gpu;
use crate::gpu::pipeline::ComputePipeline;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::storage_bytes;
use crate::gpu::shader::ShaderKey;
use crate::input::frame::BoundFrame;
use crate::{bindings, gpu_struct};
use glam::Vec2;
use std::sync::Arc;

gpu_struct! {
    /// A light sample in the sum.
    pub(crate) struct Entry {
        /// Index in the table of light samples.
        sample: u32,
        /// Layer of its map.
        layer: u32,
        weight: f32,
        /// Extent of the sample's part of the light along the light's edges: towards smaller and towards larger
        /// coordinates, metres.
        reach_low: Vec2,
        reach_high: Vec2,
    }
}

gpu_struct! {
    /// The run of the list that a dispatch adds up.
    pub(crate) struct EvaluationUniform {
        first: u32,
        end: u32,
        /// Texels per side of the filter.
        width: i32,
    }
}

/// The bytes of a list of samples; see `entries.wesl`.
pub(crate) fn entry_list(entries: &[Entry]) -> Vec<u8> {
    [&(entries.len() as u32).to_le_bytes()[..], &[0; 4], &storage_bytes(entries)].concat()
}

/// Rounds of all loops in one invocation of a shader: some drivers stop at 65535.
const MOST_ROUNDS: u32 = 50_000;

/// Fills the visibility with a weighted sum over light samples.
pub struct Evaluation {
    pipeline: Arc<ComputePipeline>,
    runs: Vec<EvaluationUniform>,
    runs_per_part: u32,
}

impl Evaluation {
    /// For lists of at most `count` samples in parts of `part`, with a filter of `width` texels per side.
    pub fn new(gpu: &Gpu, width: u32, count: u32, part: u32) -> Result<Evaluation, Error> {
        let most = (MOST_ROUNDS / (1 + width * (width + 1))).max(1);
        let runs = (0..count.div_ceil(part)).flat_map(|p| {
            let (start, end) = (p * part, ((p + 1) * part).min(count));
            // Every part has as many runs, of which the last part may leave some empty.
            (0..part.div_ceil(most)).map(move |r| EvaluationUniform {
                first: (start + r * most).min(end),
                end: (start + (r + 1) * most).min(end),
                width: width as i32,
            })
        });
        let key = ShaderKey::new("passes::maps::light_maps::evaluate");
        let pipeline = gpu.compute_pipeline(&key, "evaluate")?;
        Ok(Evaluation { pipeline, runs: runs.collect(), runs_per_part: part.div_ceil(most) })
    }

    /// Adds a part of the list to the visibility; part 0 begins it.
    pub fn record(
        &self,
        recorder: &mut Recorder,
        frame: &BoundFrame,
        maps: &LightMaps,
        entries: &wgpu::Buffer,
        part: u32,
    ) -> Result<(), Error> {
        for run in part * self.runs_per_part..(part + 1) * self.runs_per_part {
            let value = self.runs[run as usize];
            if run > 0 && value.first >= value.end {
                continue;
            }
            let evaluation = recorder.uniform("evaluation", &value);
            let own = bindings! {
                light_samples: &maps.samples,
                light_maps: &maps.texture,
                entry_list: entries,
                evaluation: &evaluation,
            };
            let set: [&[_]; 2] = [&frame.bindings(), own];
            recorder.compute("visibility sum", &self.pipeline, &set, Work::Pixels(frame.size))?;
        }
        Ok(())
    }
}
