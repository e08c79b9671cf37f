//! The micro-patches, on one level or on several.

use super::SsmSettings;
use super::maps::Maps;
use crate::input::frame::FrameUniform;
use crate::passes::maps::depth_map::DepthMap;
use crate::passes::maps::depth_pyramid::DepthPyramid;
use crate::gpu::bindings::Binding;
use crate::gpu::recorder::{Recorder, Work, dispatch};
use crate::gpu::resources::{Texture, UniformArray, read_buffer, storage_buffer, uniform};
use crate::gpu::shader::{HostStruct, ShaderKey};
use crate::technique::{InnerPicture, Memory};
use crate::error::Error;
use crate::input::frame::Frame;
use crate::gpu::device::Gpu;
use crate::{bindings, gpu_struct};

gpu_struct! {
    /// What is the same for all levels.
    pub(crate) struct SsmUniform {
        /// Inverse distance of the farthest receiver.
        farthest_receiver_q: f32,
        /// Texels of a level that a penumbra is wide at least.
        window: f32,
        levels: u32,
        /// Occluder maps.
        layers: u32,
        /// Texels a side of the maps.
        size: u32,
        /// The same, rounded up so that the tiles of every level are whole.
        padded: u32,
    }
}

gpu_struct! {
    /// A level of a layer.
    pub(crate) struct SsmLevel {
        level: u32,
        layer: u32,
    }
}

/// Patches a side of a tile, and of the coarsest level at least.
const TILE: u32 = 8;
/// Bytes of `Totals` in `levels.wesl`: 32 largest depths, three figures, rounded up.
const TOTALS: u64 = 4 * 36;

/// Every level of the patches of one or two occluder maps.
pub(super) struct Patches {
    pub shape: SsmUniform,
    /// `Rg32Float`, a layer an occluder map, a mip a level: covered part and inverse distance.
    patches: Texture,
    /// `R32Float`: the largest inverse distance of each tile.
    tile_tops: Texture,
    /// `Rgba32Float`: what goes up from each level.
    rising: Texture,
    totals: wgpu::Buffer,
    uniform: wgpu::Buffer,
    /// Two a level: its layers.
    pub levels: UniformArray<SsmLevel>,
    /// Each level of patches, of tiles' tops and of what rises.
    level_views: Vec<[wgpu::TextureView; 3]>,
    receiver_bounds: Option<DepthPyramid>,
}

impl Patches {
    /// Room for all levels.
    pub fn new(gpu: &Gpu, settings: &SsmSettings) -> Patches {
        let levels = if settings.hierarchy { (settings.map / TILE).max(1).ilog2() + 1 } else { 1 };
        let padded = settings.map.next_multiple_of(TILE << (levels - 1));
        let shape = SsmUniform {
            farthest_receiver_q: 0.0,
            window: settings.window as f32,
            levels,
            layers: settings.passes,
            size: settings.map,
            padded,
        };
        let usage = wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::TEXTURE_BINDING;
        let texture =
            |label, side, format| Texture::array(gpu, label, [side; 2], settings.passes, levels, format, usage);
        let of_level = |i| SsmLevel { level: i / 2, layer: i % 2 };
        let patches = texture("micro-patches", padded, wgpu::TextureFormat::Rg32Float);
        let tile_tops = texture("nearest patches", padded / TILE, wgpu::TextureFormat::R32Float);
        let rising = texture("rising patches", padded, wgpu::TextureFormat::Rgba32Float);
        Patches {
            level_views: (0..levels).map(|i| [&patches, &tile_tops, &rising].map(|t| t.array_mip(i))).collect(),
            patches,
            tile_tops,
            rising,
            totals: storage_buffer(gpu, "patch totals", TOTALS),
            uniform: uniform(gpu, "soft shadow map", &shape),
            levels: UniformArray::new(gpu, "patch levels", &(0..2 * levels).map(of_level).collect::<Vec<_>>()),
            receiver_bounds: settings.hierarchy.then(|| DepthPyramid::new(gpu, settings.map)),
            shape,
        }
    }

    /// A key of a module that reads patches.
    pub fn key(module: &'static str) -> ShaderKey {
        ShaderKey::new(module)
    }

    /// Texels a side of a level.
    pub fn side(&self, level: u32) -> u32 {
        self.shape.padded >> level
    }

    /// Turns texels of the occluder maps into patches, and merges those that go up.
    pub fn record(&self, recorder: &mut Recorder, frame: &Frame, maps: &Maps) -> Result<(), Error> {
        let shape = SsmUniform { farthest_receiver_q: 1.0 / frame.frustum.receivers[1], ..self.shape };
        recorder.gpu.queue.write_buffer(&self.uniform, 0, &shape.uniform_bytes());
        recorder.encoder.clear_buffer(&self.totals, 0, None);
        if let Some(bounds) = &self.receiver_bounds {
            bounds.record(recorder, &maps.receivers, frame.frustum.near)?;
        }
        let key = Self::key("techniques::ssm::patches").feature("flat", self.receiver_bounds.is_none());
        let first = recorder.gpu.compute_pipeline(&key.clone().feature("first", true), "raise")?;
        let next = recorder.gpu.compute_pipeline(&key, "raise")?;
        recorder.compute_pass("micro-patches", |gpu, pass| {
            for level in 0..shape.levels {
                let pipeline = if level == 0 { &first } else { &next };
                let step = self.levels.at(2 * level);
                let views = &self.level_views[level as usize];
                let [_, _, below] = &self.level_views[level.saturating_sub(1) as usize];
                let mut set = bindings! {
                    step: &step,
                    ssm: &self.uniform,
                    totals: &self.totals,
                    depth_map: &maps.receivers.texture,
                    nearest_occluders: &maps.nearest.texture,
                    farthest_occluders: &maps.farthest,
                    level_patches: &views[0],
                    level_tops: &views[1],
                    level_rising: &views[2],
                    rising: below,
                    frame: &frame.uniform,
                }
                .to_vec();
                if let Some(bounds) = &self.receiver_bounds {
                    set.extend_from_slice(bindings! { pyramid_bounds: &bounds.bounds });
                }
                pass.set_pipeline(&pipeline.pipeline);
                pass.set_bind_group(0, &pipeline.bind_group(gpu, 0, &set), &[]);
                dispatch(pass, pipeline, Work::Threads([self.side(level), self.side(level), shape.layers]));
            }
        });
        Ok(())
    }

    /// What shaders import from `levels.wesl`.
    pub fn bindings<'a>(&'a self, frame: &'a Frame, receivers: &'a DepthMap) -> Vec<Binding<'a>> {
        bindings! {
            frame: &frame.uniform,
            depth_map: &receivers.texture,
            patches: &self.patches,
            tile_tops: &self.tile_tops,
            ssm: &self.uniform,
            totals: &self.totals,
        }
        .to_vec()
    }

    /// Patches of the last frame, those that float16 loses, and the widest penumbra in texels of its level.
    pub async fn stats(&self, gpu: &Gpu) -> Result<Vec<(&'static str, f64)>, Error> {
        let bytes = read_buffer(gpu, &self.totals).await?;
        let words: Vec<u32> = bytemuck::pod_collect_to_vec(&bytes);
        let (patches, lost, widest) = (words[32], words[33], f32::from_bits(words[34]));
        Ok(vec![("patches", patches.into()), ("float16 loses", lost.into()), ("widest penumbra", widest.into())])
    }

    /// For looking at.
    pub fn inner_picture(&self) -> InnerPicture {
        let help = "covered part of each micro-patch and its inverse distance, 1/metres; a level of the map a level";
        InnerPicture::of_texture("micro-patches", help, &self.patches)
    }

    /// GPU memory by pass.
    pub fn memory(&self) -> Vec<Memory> {
        let own = self.patches.bytes() + self.tile_tops.bytes() + self.rising.bytes() + self.totals.size();
        let bounds = self.receiver_bounds.iter().map(DepthPyramid::memory);
        bounds.chain([Memory::new("micro-patches", own)]).collect()
    }
}
