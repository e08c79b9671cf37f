//! The filter: each pixel over the tiles that its kernel touches [Shen 2011, section 5.2, step 8].

use super::drawing::{Drawing, RoundUniform};
use super::plan::{MOST_ROUNDS, Plan, Tile};
use super::{PvssmSettings, PvssmUniform, analysis::Analysis};
use crate::input::frame::FrameUniform;
use crate::gpu::recorder::{Recorder, Work, dispatch};
use crate::gpu::resources::storage_buffer;
use crate::gpu::shader::ShaderKey;
use crate::technique::Memory;
use crate::error::Error;
use crate::input::frame::Frame;
use crate::gpu::device::Gpu;
use crate::bindings;

const BINS: &str = "pixel bins";
const FILTER: &str = "filter";

/// Which pixels each round visits, and what they have added up.
pub(crate) struct Filtering {
    /// See `bin_pixels.wesl`.
    blocks: wgpu::Buffer,
    /// Visible area and area of each listed pixel.
    sums: wgpu::Buffer,
    size: [u32; 2],
}

impl Filtering {
    /// Makes it in `slot` unless one for pictures of this size is there.
    pub fn ensure<'a>(
        slot: &'a mut Option<Filtering>,
        gpu: &Gpu,
        size: [u32; 2],
        settings: &PvssmSettings,
    ) -> Result<&'a Filtering, Error> {
        if slot.as_ref().is_none_or(|f| f.size != size) {
            let pixels = u64::from(size[0]) * u64::from(size[1]);
            let blocks = u64::from(size[0].div_ceil(8)) * u64::from(size[1].div_ceil(8));
            let words = 4 * MOST_ROUNDS as u64 + blocks * u64::from(settings.rounds);
            *slot = Some(Filtering {
                blocks: storage_buffer(gpu, "blocks of rounds", 4 * words),
                sums: storage_buffer(gpu, "visible area and area", 8 * pixels),
                size,
            });
        }
        Ok(slot.as_ref().expect("just made"))
    }

    fn key(module: &'static str) -> ShaderKey {
        let key = ShaderKey::new(module);
        key
    }

    /// Lists the blocks of pixels that each round visits.
    pub fn bin_pixels(
        &self,
        frame: &Frame,
        recorder: &mut Recorder,
        analysis: &Analysis,
        plan: &Plan,
    ) -> Result<(), Error> {
        let key = Self::key("techniques::pvssm::bin_pixels");
        let bin = recorder.gpu.compute_pipeline(&key, "bin_pixels")?;
        let finish = recorder.gpu.compute_pipeline(&key, "finish_bins")?;
        recorder.encoder.clear_buffer(&self.blocks, 0, Some(16 * MOST_ROUNDS as u64));
        let set = frame.bindings(bindings! {
            penumbra_pixels: &analysis.list.buffer,
            penumbra_tiles: &analysis.list.tiles,
            pvssm: &plan.uniform,
            tile_plan: &plan.tiles,
            tile_of_cell: &plan.cells,
            kernels: &analysis.kernels,
            round_blocks: &self.blocks,
        });
        recorder.compute_pass(BINS, |gpu, pass| {
            pass.set_pipeline(&bin.pipeline);
            pass.set_bind_group(0, &bin.bind_group(gpu, 0, &set), &[]);
            dispatch(pass, &bin, Work::Indirect(&analysis.list.tiles, 0));
            pass.set_pipeline(&finish.pipeline);
            pass.set_bind_group(0, &finish.bind_group(gpu, 0, &set), &[]);
            pass.dispatch_workgroups(1, 1, 1);
        });
        Ok(())
    }

    /// Filters what lies in the tiles of a round.
    pub fn soften(
        &self,
        frame: &Frame,
        recorder: &mut Recorder,
        analysis: &Analysis,
        plan: &Plan,
        drawing: &Drawing,
        round: u32,
    ) -> Result<(), Error> {
        let pipeline = recorder.gpu.compute_pipeline(&Self::key("techniques::pvssm::soften"), "soften")?;
        let number = drawing.rounds.at(round);
        let set = frame.bindings(bindings! {
            penumbra_pixels: &analysis.list.buffer,
            penumbra_tiles: &analysis.list.tiles,
            pvssm: &plan.uniform,
            tile_plan: &plan.tiles,
            tile_of_cell: &plan.cells,
            kernels: &analysis.kernels,
            tile_round: &number,
            round_blocks: &self.blocks,
            tile_pool: &drawing.pool,
            tile_layers: &drawing.layers,
            sums: &self.sums,
        });
        recorder.compute(FILTER, &pipeline, &set, Work::Indirect(&self.blocks, 16 * u64::from(round)));
        Ok(())
    }

    /// GPU memory.
    pub fn memory(&self) -> Memory {
        Memory::new(FILTER, self.blocks.size() + self.sums.size())
    }
}
