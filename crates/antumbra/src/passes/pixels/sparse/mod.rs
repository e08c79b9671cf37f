//! Looks at few of the pixels in penumbra first, and at the others only where their neighbours do not tell them: where
//! shadows are soft, a sixteenth of the pixels is enough [Guennebaud 2007, section 5].

use crate::input::frame::{Frame, FrameUniform};
use crate::passes::pixels::classify::PenumbraList;
use crate::gpu::recorder::{Recorder, Work, dispatch};
use crate::gpu::resources::{UniformArray, storage_buffer};
use crate::gpu::shader::ShaderKey;
use crate::technique::Memory;
use crate::error::Error;
use crate::gpu::device::Gpu;
use crate::{bindings, gpu_struct};

gpu_struct! {
    /// Which pixels are chosen.
    pub(crate) struct StageUniform {
        /// Pixels from the chosen ones to those that tell of them, or from one to the next for corners.
        step: u32,
        /// 0 corners of squares, 1 their middles, 2 the middles of their edges.
        kind: u32,
        /// Over the distance of `step` pixels the visibility must not be able to change by more.
        most_change: f32,
        /// What two pairs of opposite neighbours tell must not differ by more.
        most_difference: f32,
    }
}

/// The pixels that a stage looks at, and what is known of those before.
pub struct SparsePixels {
    list: PenumbraList,
    /// `f32` a pixel: how fast the visibility may change there for each pixel of distance; written with the visibility
    /// by who looks at a pixel, never 0 then.
    pub sharpness: wgpu::Buffer,
    stages: UniformArray<StageUniform>,
    spacing: u32,
}

/// Over the distance to its neighbours a pixel's visibility must not be able to change by more than this for them to
/// tell it, and what they tell must agree to within the second.
const MOST_CHANGE: f32 = 0.5;
const MOST_DIFFERENCE: f32 = 0.01;

impl SparsePixels {
    /// For pictures of this size; `spacing` is that of the pixels that are looked at first, a power of two.
    pub fn new(gpu: &Gpu, size: [u32; 2], spacing: u32) -> SparsePixels {
        let stage =
            |step, kind| StageUniform { step, kind, most_change: MOST_CHANGE, most_difference: MOST_DIFFERENCE };
        let halves = std::iter::successors(Some(spacing / 2), |step| Some(step / 2)).take_while(|step| *step > 0);
        let between = halves.flat_map(|step| [stage(step, 1), stage(step, 2)]);
        let stages: Vec<_> = std::iter::once(stage(spacing, 0)).chain(between).collect();
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        SparsePixels {
            list: PenumbraList::new(gpu, size),
            sharpness: storage_buffer(gpu, "sharpness", 4 * pixels),
            stages: UniformArray::new(gpu, "stages", &stages),
            spacing,
        }
    }

    /// Makes one in `slot` unless one for such a picture is there.
    pub fn ensure<'a>(slot: &'a mut Option<SparsePixels>, gpu: &Gpu, size: [u32; 2], spacing: u32) -> &'a SparsePixels {
        if !slot.as_ref().is_some_and(|s| s.list.size() == size && s.spacing == spacing) {
            *slot = Some(SparsePixels::new(gpu, size, spacing));
        }
        slot.as_ref().expect("just made")
    }

    /// Has `look` called with the list of each stage, until all pixels of `all` have a visibility. What it records
    /// writes visibility and sharpness of the pixels in the list.
    pub fn record(
        &self,
        recorder: &mut Recorder,
        frame: &Frame,
        all: &PenumbraList,
        mut look: impl FnMut(&mut Recorder, &PenumbraList),
    ) -> Result<(), Error> {
        let key = ShaderKey::new("passes::pixels::sparse::split");
        let split = recorder.gpu.compute_pipeline(&key, "split")?;
        let finish = recorder.gpu.compute_pipeline(&key, "finish")?;
        recorder.encoder.clear_buffer(&self.sharpness, 0, None);
        for i in 0..self.stages.len() {
            let stage = self.stages.at(i);
            recorder.encoder.clear_buffer(&self.list.buffer, 0, Some(16));
            let set = frame.bindings(bindings! {
                penumbra_pixels: &all.buffer,
                chosen: &self.list.buffer,
                sharpness: &self.sharpness,
                stage: &stage,
            });
            recorder.compute_pass("choice of pixels", |gpu, pass| {
                pass.set_pipeline(&split.pipeline);
                pass.set_bind_group(0, &split.bind_group(gpu, 0, &set), &[]);
                dispatch(pass, &split, Work::Indirect(&all.buffer, 0));
                pass.set_pipeline(&finish.pipeline);
                pass.set_bind_group(0, &finish.bind_group(gpu, 0, &set), &[]);
                pass.dispatch_workgroups(1, 1, 1);
            });
            look(recorder, &self.list);
        }
        Ok(())
    }

    /// GPU memory by pass.
    pub fn memory(&self) -> Memory {
        Memory::new("choice of pixels", self.list.buffer.size() + self.sharpness.size())
    }
}
