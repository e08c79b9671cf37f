//! Drawing tiles into the pool: clusters are culled for all tiles of a round at once, and drawn once for each tile that
//! they touch [Shen 2011, section 5.2, step 7].

use super::plan::{LARGEST_NODE, MOST_OF_ROUND, MOST_ROUNDS, Plan, Tile};
use super::{PvssmSettings, PvssmUniform};
use crate::input::casters::{BatchLayout, CLUSTER_TRIANGLES, Casters};
use crate::input::frame::FrameUniform;
use crate::input::map_view::MapView;
use crate::gpu::pipeline::RenderTarget;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::{Texture, UniformArray, buffer_of, storage_buffer, uniform};
use crate::gpu::shader::{HostStruct, ShaderKey};
use crate::technique::{InnerPicture, Memory};
use crate::error::Error;
use crate::input::frame::Frame;
use crate::gpu::device::Gpu;
use crate::{bindings, gpu_struct};
use glam::Mat4;

gpu_struct! {
    /// Which filling of the pool a pass is for.
    pub(crate) struct RoundUniform {
        round: u32,
    }
}

/// Bytes of the arguments of an indirect draw.
const DRAW_BYTES: u64 = 16;
/// Clusters that a draw list can tell apart: the rest of its 32 bits says which tile.
const MOST_CLUSTERS: u32 = 1 << 26;

/// Levels of the pyramid; see `tiles.wesl`.
const LEVELS: usize = LARGEST_NODE.ilog2() as usize;

const CULLING: &str = "tile culling";
const TILES: &str = "tiles";
const PYRAMID: &str = "tile pyramid";

/// The pool and what is drawn into it.
pub(crate) struct Drawing {
    /// `Depth32Float`, `near / z`.
    pub pool: Texture,
    /// `Rg32Uint`, the pyramid over it from nodes of 2 x 2 texels on; see `tile_layers.wesl`.
    pub layers: Texture,
    /// One view a level.
    levels: [wgpu::TextureView; LEVELS],
    /// The number of each round.
    pub rounds: UniformArray<RoundUniform>,
    view: wgpu::Buffer,
    visible: wgpu::Buffer,
    draws: wgpu::Buffer,
    no_draws: wgpu::Buffer,
    size: u32,
}

impl Drawing {
    /// Makes it in `slot` unless one of this size for these casters is there.
    pub fn ensure<'a>(
        slot: &'a mut Option<Drawing>,
        gpu: &Gpu,
        casters: &Casters,
        settings: &PvssmSettings,
    ) -> Result<&'a Drawing, Error> {
        let visible = Self::visible_bytes(casters);
        let draws = casters.batches.len().max(1) as u64 * DRAW_BYTES;
        let fits = |d: &Drawing| d.size == settings.tile && d.visible.size() == visible && d.draws.size() == draws;
        if !slot.as_ref().is_some_and(fits) {
            *slot = None; // Frees the old pool before the new one is made.
            *slot = Some(Drawing::new(gpu, casters, settings)?);
        }
        Ok(slot.as_ref().expect("just made"))
    }

    fn visible_bytes(casters: &Casters) -> u64 {
        (u64::from(casters.cluster_count) * MOST_OF_ROUND as u64 * 4).max(16)
    }

    fn new(gpu: &Gpu, casters: &Casters, settings: &PvssmSettings) -> Result<Drawing, Error> {
        if casters.cluster_count >= MOST_CLUSTERS {
            let most = u64::from(MOST_CLUSTERS) * u64::from(CLUSTER_TRIANGLES);
            return Err(Error::Validation(format!("tiles can be drawn of {most} triangles at most")));
        }
        let none = [3 * CLUSTER_TRIANGLES, 0, 0, 0].repeat(casters.batches.len().max(1));
        let no_draws = buffer_of(gpu, "no draws", bytemuck::cast_slice(&none), wgpu::BufferUsages::COPY_SRC);
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
        let rounds: Vec<RoundUniform> = (0..MOST_ROUNDS as u32).map(|round| RoundUniform { round }).collect();
        let of_pyramid = wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::TEXTURE_BINDING;
        let half = [settings.tile.div_ceil(LARGEST_NODE) * LARGEST_NODE / 2; 2];
        let format = wgpu::TextureFormat::Rg32Uint;
        let layers = Texture::new(gpu, "pyramid of tiles", half, LEVELS as u32, format, of_pyramid);
        Ok(Drawing {
            levels: std::array::from_fn(|level| layers.mip(level as u32)),
            layers,
            pool: Texture::depth(gpu, "pool of tiles", [settings.tile; 2], 1, usage),
            rounds: UniformArray::new(gpu, "rounds", &rounds),
            view: uniform(gpu, "map view", &MapView::new(Mat4::IDENTITY)),
            visible: storage_buffer(gpu, "visible clusters of tiles", Self::visible_bytes(casters)),
            draws: storage_buffer(gpu, "cluster draws", no_draws.size()),
            no_draws,
            size: settings.tile,
        })
    }

    fn key(module: &'static str) -> ShaderKey {
        let key = ShaderKey::new(module);
        key
    }

    /// Draws the tiles of a round that are not kept.
    pub fn draw_tiles(&self, frame: &Frame, recorder: &mut Recorder, plan: &Plan, round: u32) -> Result<(), Error> {
        let casters = &frame.casters;
        if round == 0 {
            let view = MapView::new(frame.map_clip_from_world());
            recorder.gpu.queue.write_buffer(&self.view, 0, &view.uniform_bytes());
        }
        let number = self.rounds.at(round);
        let set = bindings! {
            pvssm: &plan.uniform,
            tile_plan: &plan.tiles,
            tile_round: &number,
            map_view: &self.view,
            boxes: &casters.cluster_bounds,
            visible: &self.visible,
            draws: &self.draws,
        };
        let cull = recorder.gpu.compute_pipeline(&Self::key("techniques::pvssm::cull_tiles"), "cull_for_tiles")?;
        recorder.encoder.copy_buffer_to_buffer(&self.no_draws, 0, &self.draws, 0, self.draws.size());
        recorder.compute_pass(CULLING, |gpu, pass| {
            pass.set_pipeline(&cull.pipeline);
            pass.set_bind_group(0, &cull.bind_group(gpu, 0, set), &[]);
            for (i, batch) in casters.batches.iter().enumerate().filter(|(_, b)| b.cluster_count > 0) {
                pass.set_bind_group(1, &cull.bind_group(gpu, 1, &batch.bindings(casters)), &[]);
                pass.dispatch_workgroups_indirect(&plan.arguments, plan.cull_offset(round, i));
            }
        });
        let target = RenderTarget { depth: Some(wgpu::CompareFunction::Greater), ..RenderTarget::default() };
        let clipped = recorder.gpu.capabilities.clip_distances;
        let key = Self::key("techniques::pvssm::draw_tiles").feature("clipped", clipped);
        let opaque = recorder.gpu.render_pipeline(&key, &target)?;
        let masked = recorder.gpu.render_pipeline(&key.feature("masked", true), &target)?;
        let always = RenderTarget { depth: Some(wgpu::CompareFunction::Always), ..target };
        let wipe = recorder.gpu.render_pipeline(&Self::key("techniques::pvssm::wipe_tiles"), &always)?;
        recorder.layered_depth_pass(TILES, &self.pool.view, 1, |gpu, pass| {
            pass.set_pipeline(&wipe.pipeline);
            pass.set_bind_group(0, &wipe.bind_group(gpu, 0, set), &[]);
            pass.draw_indirect(&plan.arguments, plan.wipe_offset(round));
            for (i, batch) in casters.batches.iter().enumerate() {
                let pipeline = if batch.masked { &masked } else { &opaque };
                pass.set_pipeline(&pipeline.pipeline);
                pass.set_bind_group(0, &pipeline.bind_group(gpu, 0, set), &[]);
                pass.set_bind_group(1, &pipeline.bind_group(gpu, 1, &batch.bindings(casters)), &[]);
                pass.draw_indirect(&self.draws, i as u64 * DRAW_BYTES);
            }
        });
        Ok(())
    }

    /// Makes the pyramid over the tiles of a round.
    pub fn reduce_tiles(&self, frame: &Frame, recorder: &mut Recorder, plan: &Plan, round: u32) -> Result<(), Error> {
        let key = ShaderKey::new("techniques::pvssm::reduce_tiles");
        for (step, levels) in self.levels.chunks_exact(2).enumerate() {
            let key = key.clone().feature("first", step == 0);
            let pipeline = recorder.gpu.compute_pipeline(&key, "reduce_tiles")?;
            let mut set = frame.bindings(bindings! { finer_level: &levels[0], coarser_level: &levels[1] });
            if step == 0 {
                set.extend_from_slice(bindings! { tile_pool: &self.pool });
            } else {
                set.extend_from_slice(bindings! { source_layers: &self.levels[2 * step - 1] });
            }
            let arguments = plan.reduce_offset(round, step as u64);
            recorder.compute(PYRAMID, &pipeline, &set, Work::Indirect(&plan.arguments, arguments));
        }
        Ok(())
    }

    /// For looking at.
    pub fn inner_picture(&self) -> InnerPicture {
        InnerPicture::of_texture(TILES, "pool of the tiles of the last round, near / z; 0 where nothing is", &self.pool)
    }

    /// GPU memory by pass.
    pub fn memory(&self) -> [Memory; 3] {
        let lists = self.visible.size() + 2 * self.draws.size();
        let bytes = [(CULLING, lists), (TILES, self.pool.bytes()), (PYRAMID, self.layers.bytes())];
        bytes.map(|(pass, bytes)| Memory::new(pass, bytes))
    }
}
