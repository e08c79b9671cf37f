//! The filter: each pixel over the tiles that its kernel touches [Shen 2011, section 5.2, step 8].

use super::PvssmSettings;
use super::analysis::Analysis;
use super::drawing::Pool;
use super::plan::{MOST_ROUNDS, Plan};
use crate::bindings;
use crate::error::Error;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::BufferDescription;
use crate::gpu::shader::ShaderKey;
use crate::input::frame::BoundFrame;

/// The pixels of each round, and their sums.
pub(crate) struct Filtering {
    /// See `bin_pixels.wesl`.
    blocks: wgpu::Buffer,
    /// Visible area and area of each listed pixel.
    sums: wgpu::Buffer,
}

impl Filtering {
    /// Lists the blocks of pixels whose kernels touch tiles of each round.
    pub fn bin_pixels(
        recorder: &mut Recorder,
        frame: &BoundFrame,
        settings: &PvssmSettings,
        analysis: &Analysis,
        plan: &Plan,
    ) -> Result<Filtering, Error> {
        let [width, height] = frame.size.map(u64::from);
        let (arguments, blocks) = (16 * MOST_ROUNDS as u64, width.div_ceil(8) * height.div_ceil(8));
        let blocks = BufferDescription::new(arguments + 4 * blocks * u64::from(settings.rounds));
        let filtering = Filtering {
            blocks: recorder.buffer("blocks of rounds", blocks.cleared_head(arguments)),
            sums: recorder.buffer("visible area and area", BufferDescription::new(8 * width * height)),
        };
        let key = ShaderKey::new("techniques::pvssm::bin_pixels");
        let bin = recorder.gpu.compute_pipeline(&key, "bin_pixels")?;
        let finish = recorder.gpu.compute_pipeline(&key, "finish_bins")?;
        let own = bindings! { round_blocks: &filtering.blocks };
        let set = [&frame.bindings()[..], &analysis.bindings(), &plan.bindings(), own];
        recorder.compute("pixel bins", &bin, &set, Work::Indirect(&analysis.list.tiles, 0))?;
        recorder.compute("pixel bins", &finish, &set, Work::Groups([1, 1, 1]))?;
        Ok(filtering)
    }

    /// Filters over the tiles of a round.
    pub fn soften(
        &self,
        recorder: &mut Recorder,
        frame: &BoundFrame,
        analysis: &Analysis,
        plan: &Plan,
        pool: &Pool,
        round: u32,
    ) -> Result<(), Error> {
        let pipeline = recorder.gpu.compute_pipeline(&ShaderKey::new("techniques::pvssm::soften"), "soften")?;
        let number = plan.rounds.at(round);
        let own = bindings! {
            tile_round: &number,
            round_blocks: &self.blocks,
            tile_pool: &pool.depth,
            tile_layers: &pool.layers,
            sums: &self.sums,
        };
        let set = [&frame.bindings()[..], &analysis.bindings(), &plan.bindings(), own];
        recorder.compute("filter", &pipeline, &set, Work::Indirect(&self.blocks, 16 * u64::from(round)))
    }
}
