//! Evaluation: each pixel adds up what the samples of a list see of it.

use super::{LightMaps, LightSample, LightSamples};
use crate::input::frame::FrameUniform;
use crate::gpu::pipeline::ComputePipeline;
use crate::gpu::recorder::{Recorder, Work, dispatch};
use crate::gpu::resources::UniformArray;
use crate::gpu::shader::ShaderKey;
use crate::error::Error;
use crate::input::frame::Frame;
use crate::gpu::device::Gpu;
use crate::{bindings, gpu_struct};
use glam::Vec2;
use std::sync::Arc;

gpu_struct! {
    /// A light sample in the sum.
    pub(crate) struct Entry {
        /// Place in the table of light samples.
        sample: u32,
        /// Layer of its map.
        layer: u32,
        weight: f32,
        /// How far the light that the sample stands for reaches around it along the light's edges: towards smaller and
        /// towards larger coordinates, metres.
        reach_low: Vec2,
        reach_high: Vec2,
    }
}

gpu_struct! {
    /// The run of the list that a dispatch adds up.
    pub(crate) struct EvaluationUniform {
        first: u32,
        end: u32,
        /// Texels a side of the filter.
        width: i32,
    }
}

/// Rounds of all loops in one invocation of a shader: some drivers stop at 65535.
const MOST_ROUNDS: u32 = 50_000;

/// Fills the visibility with a weighed sum over light samples.
pub struct Evaluation {
    pipeline: Arc<ComputePipeline>,
    runs: UniformArray<EvaluationUniform>,
    runs_per_part: u32,
}

impl Evaluation {
    /// For lists of at most `count` samples in parts of `part`, with a filter of `width` texels a side.
    pub fn new(gpu: &Gpu, width: u32, count: u32, part: u32) -> Result<Evaluation, Error> {
        let key = ShaderKey::new("passes::maps::light_maps::evaluate");
        let most = (MOST_ROUNDS / (1 + width * (width + 1))).max(1);
        let runs: Vec<EvaluationUniform> = (0..count.div_ceil(part))
            .flat_map(|p| {
                let (start, end) = (p * part, ((p + 1) * part).min(count));
                // Every part has as many runs, of which the last part may leave some empty.
                (0..part.div_ceil(most)).map(move |r| EvaluationUniform {
                    first: (start + r * most).min(end),
                    end: (start + (r + 1) * most).min(end),
                    width: width as i32,
                })
            })
            .collect();
        Ok(Evaluation {
            pipeline: gpu.compute_pipeline(&key, "evaluate")?,
            runs: UniformArray::new(gpu, "evaluation", &runs),
            runs_per_part: part.div_ceil(most),
        })
    }

    /// Adds a part of the list to the visibility; part 0 begins it.
    pub fn record(
        &self,
        recorder: &mut Recorder,
        frame: &Frame,
        samples: &LightSamples,
        maps: &LightMaps,
        entries: &wgpu::Buffer,
        part: u32,
    ) {
        let [width, height] = frame.size;
        recorder.compute_pass("visibility sum", |gpu, pass| {
            pass.set_pipeline(&self.pipeline.pipeline);
            for run in part * self.runs_per_part..(part + 1) * self.runs_per_part {
                let value = self.runs.value(run);
                if run > 0 && value.first >= value.end {
                    continue;
                }
                let evaluation = self.runs.at(run);
                let set = frame.bindings(bindings! {
                    light_samples: &samples.buffer,
                    light_maps: &maps.texture,
                    entry_list: entries,
                    evaluation: &evaluation,
                });
                pass.set_bind_group(0, &self.pipeline.bind_group(gpu, 0, &set), &[]);
                dispatch(pass, &self.pipeline, Work::Threads([width, height, 1]));
            }
        });
    }
}
