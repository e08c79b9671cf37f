//! Sparse shading: a coarse grid of penumbra pixels is shaded first; the others are interpolated, or shaded where their
//! neighbours do not determine them. A sixteenth of the pixels suffices in soft shadows [Guennebaud 2007, section 5].

use crate::error::Error;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::BufferDescription;
use crate::gpu::shader::ShaderKey;
use crate::input::frame::BoundFrame;
use crate::passes::pixels::classify::PenumbraList;
use crate::{bindings, gpu_struct};

gpu_struct! {
    /// The pixels of a stage.
    pub(crate) struct StageUniform {
        /// Pixels from one to its neighbours that are shaded before; for corners, from one to the next.
        step: u32,
        /// 0 corners of squares, 1 their centres, 2 the midpoints of their edges.
        kind: u32,
        /// Largest change of visibility over `step` pixels for interpolation.
        most_change: f32,
        /// Largest difference of the two interpolations between opposite neighbours.
        most_difference: f32,
    }
}

/// Largest change of visibility over the distance to the neighbours, and largest difference of the interpolations
/// between them, for a pixel to be interpolated.
const MOST_CHANGE: f32 = 0.5;
const MOST_DIFFERENCE: f32 = 0.01;

/// Fills the visibility of all pixels of a list. `spacing` is that of the coarse grid, in pixels, a power of two.
///
/// `shade` is called for each stage with the list of its pixels and with the buffer `sharpness`, an `f32` per pixel of
/// the image: an upper bound of the change of visibility per pixel. It records passes that write visibility and
/// sharpness (more than 0) of the listed pixels.
pub fn shade_sparsely(
    recorder: &mut Recorder,
    frame: &BoundFrame,
    all: &PenumbraList,
    spacing: u32,
    mut shade: impl FnMut(&mut Recorder, &wgpu::Buffer, &wgpu::Buffer) -> Result<(), Error>,
) -> Result<(), Error> {
    let key = ShaderKey::new("passes::pixels::sparse::split");
    let [begin, split, finish] = ["begin", "split", "finish"].map(|entry| recorder.gpu.compute_pipeline(&key, entry));
    let (begin, split, finish) = (begin?, split?, finish?);
    let pixels = u64::from(frame.size[0]) * u64::from(frame.size[1]);
    let chosen = recorder.buffer("chosen pixels", BufferDescription::new(16 + 8 * pixels));
    let sharpness = recorder.buffer("sharpness", BufferDescription::new(4 * pixels).cleared());
    let stage = |step, kind| StageUniform { step, kind, most_change: MOST_CHANGE, most_difference: MOST_DIFFERENCE };
    let halves = std::iter::successors(Some(spacing / 2), |step| Some(step / 2)).take_while(|step| *step > 0);
    let refinements = halves.flat_map(|step| [stage(step, 1), stage(step, 2)]);
    let stages: Vec<_> = std::iter::once(stage(spacing, 0)).chain(refinements).collect();
    let uniforms = recorder.uniforms("stages", stages.iter().copied());
    for i in 0..stages.len() as u32 {
        let stage = uniforms.at(i);
        let own = bindings! {
            penumbra_pixels: &all.buffer,
            chosen: &chosen,
            sharpness: &sharpness,
            stage: &stage,
        };
        let set: [&[_]; 2] = [&frame.bindings(), own];
        let one = Work::Groups([1, 1, 1]);
        recorder.compute("choice of pixels", &begin, &set, one)?;
        recorder.compute("choice of pixels", &split, &set, Work::Indirect(&all.buffer, 0))?;
        recorder.compute("choice of pixels", &finish, &set, one)?;
        shade(recorder, &chosen, &sharpness)?;
    }
    Ok(())
}
