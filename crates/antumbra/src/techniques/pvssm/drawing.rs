//! Drawing tiles into the pool: clusters are culled for all tiles of a round at once, and drawn once for each tile that
//! they touch [Shen 2011, section 5.2, step 7].

use super::PvssmSettings;
use super::plan::{LARGEST_NODE, MOST_OF_ROUND, Plan};
use crate::bindings;
use crate::error::Error;
use crate::gpu::pipeline::RenderTarget;
use crate::gpu::recorder::{Recorder, Work, depth_target};
use crate::gpu::resources::BufferDescription;
use crate::gpu::shader::ShaderKey;
use crate::gpu::texture::{Texture, TextureDescription};
use crate::input::casters::{CLUSTER_TRIANGLES, Casters};
use crate::input::frame::BoundFrame;
use crate::input::map_view::MapView;

/// Bytes of the arguments of an indirect draw.
const DRAW_BYTES: u64 = 16;
/// Clusters that a draw list can hold: the other 6 of its 32 bits are the tile of the round.
const MOST_CLUSTERS: u32 = 1 << 26;
/// Levels of the pyramid over the pool; see `tiles.wesl`.
const LEVELS: u32 = LARGEST_NODE.ilog2();

/// The texels of the tiles. Tiles that are kept stay there from frame to frame.
pub(crate) struct Pool {
    /// `Depth32Float`, `near / z`.
    pub depth: Texture,
    /// `Rg32Uint`, the pyramid over it from nodes of 2 x 2 texels on; see `tile_layers.wesl`.
    pub layers: Texture,
}

impl Pool {
    /// A pool of `size` texels per side.
    pub fn ask(recorder: &mut Recorder, size: u32) -> Pool {
        let help = "pool of the tiles of the last round, near / z; 0 is infinitely far";
        let depth = TextureDescription::new([size; 2], wgpu::TextureFormat::Depth32Float, help);
        let help = "two layers of inverse distance below each node of the tiles, packed";
        let half = [size.next_multiple_of(LARGEST_NODE) / 2; 2];
        let layers = TextureDescription::new(half, wgpu::TextureFormat::Rg32Uint, help).mips(LEVELS);
        Pool { depth: recorder.texture("tiles", depth), layers: recorder.texture("tile pyramid", layers) }
    }

    /// Reduces the tiles of a round, two levels at a time.
    pub fn reduce_tiles(
        &self,
        recorder: &mut Recorder,
        frame: &BoundFrame,
        plan: &Plan,
        round: u32,
    ) -> Result<(), Error> {
        let key = ShaderKey::new("techniques::pvssm::reduce_tiles");
        for step in 0..LEVELS / 2 {
            let first = step == 0;
            let pipeline = recorder.gpu.compute_pipeline(&key.clone().feature("first", first), "reduce_tiles")?;
            let [source, finer, coarser] =
                [(2 * step).saturating_sub(1), 2 * step, 2 * step + 1].map(|level| self.layers.mip(level));
            let levels = bindings! { finer_level: &finer, coarser_level: &coarser };
            let (texels, nodes) = (bindings! { tile_pool: &self.depth }, bindings! { source_layers: &source });
            let set: &[&[_]] = if first { &[&frame.bindings(), texels, levels] } else { &[nodes, levels] };
            let work = Work::Indirect(&plan.arguments, plan.reduce_offset(round, step));
            recorder.compute("tile pyramid", &pipeline, set, work)?;
        }
        Ok(())
    }
}

/// The clusters of the tiles of a round.
pub(crate) struct Drawing {
    /// A `MapView` of the whole window.
    view: wgpu::Buffer,
    visible: wgpu::Buffer,
    /// Arguments of a draw per batch, for each round.
    draws: wgpu::Buffer,
}

impl Drawing {
    /// Lists with capacity for every cluster in every tile of a round.
    pub fn prepare(recorder: &mut Recorder, frame: &BoundFrame, settings: &PvssmSettings) -> Result<Drawing, Error> {
        let clusters = frame.casters.cluster_count;
        if clusters >= MOST_CLUSTERS {
            let most = u64::from(MOST_CLUSTERS) * u64::from(CLUSTER_TRIANGLES);
            return Err(Error::Validation(format!("tiles can be drawn of {most} triangles at most")));
        }
        let visible = BufferDescription::new(4 * u64::from(clusters) * MOST_OF_ROUND as u64);
        let draws = DRAW_BYTES * frame.casters.batches.len().max(1) as u64 * u64::from(settings.rounds);
        Ok(Drawing {
            view: recorder.uniform("map view", &MapView::new(frame.map_clip_from_world())),
            visible: recorder.buffer("visible clusters of tiles", visible),
            draws: recorder.buffer("cluster draws", BufferDescription::new(draws).cleared()),
        })
    }

    /// Lists the clusters of each tile of a round that is drawn.
    pub fn cull(&self, recorder: &mut Recorder, casters: &Casters, plan: &Plan, round: u32) -> Result<(), Error> {
        let key = ShaderKey::new("techniques::pvssm::cull_tiles");
        let pipeline = recorder.gpu.compute_pipeline(&key, "cull_for_tiles")?;
        let number = plan.rounds.at(round);
        let own = bindings! {
            tile_round: &number,
            map_view: &self.view,
            boxes: &casters.cluster_bounds,
            visible: &self.visible,
            draws: &self.draws,
        };
        for (i, batch) in casters.batches.iter().enumerate().filter(|(_, b)| b.cluster_count > 0) {
            let set = [&plan.bindings()[..], own, &batch.bindings(casters)];
            let work = Work::Indirect(&plan.arguments, plan.cull_offset(round, i));
            recorder.compute("tile culling", &pipeline, &set, work)?;
        }
        Ok(())
    }

    /// Draws the tiles of a round that are not kept.
    pub fn draw_tiles(
        &self,
        recorder: &mut Recorder,
        casters: &Casters,
        plan: &Plan,
        pool: &Pool,
        round: u32,
    ) -> Result<(), Error> {
        let target = RenderTarget { depth: Some(wgpu::CompareFunction::Greater), ..RenderTarget::default() };
        let clipped = recorder.gpu.capabilities.clip_distances;
        let key = ShaderKey::new("techniques::pvssm::draw_tiles").feature("clipped", clipped);
        let opaque = recorder.gpu.render_pipeline(&key, &target)?;
        let masked = recorder.gpu.render_pipeline(&key.feature("masked", true), &target)?;
        let always = RenderTarget { depth: Some(wgpu::CompareFunction::Always), ..target };
        let clear = recorder.gpu.render_pipeline(&ShaderKey::new("techniques::pvssm::clear_tiles"), &always)?;
        let number = plan.rounds.at(round);
        let tiles = bindings! { tile_round: &number };
        let clusters = bindings! { map_view: &self.view, visible: &self.visible };
        recorder.render("tiles", &[], depth_target(&pool.depth.view, None), 1, |draw| {
            draw.bind(&clear, &[&plan.bindings(), tiles])?;
            draw.pass.draw_indirect(&plan.arguments, plan.clear_offset(round));
            for (i, batch) in casters.batches.iter().enumerate() {
                let pipeline = if batch.masked { &masked } else { &opaque };
                draw.bind(pipeline, &[&plan.bindings(), tiles, clusters, &batch.bindings(casters)])?;
                let first = u64::from(round) * casters.batches.len() as u64;
                draw.pass.draw_indirect(&self.draws, (first + i as u64) * DRAW_BYTES);
            }
            Ok(())
        })
    }
}
