//! A pyramid of patches over the layers of a depth map: what lies below a node as one plane or as two surfaces.

use crate::passes::maps::depth_layers::DepthLayers;
use crate::gpu::recorder::{Recorder, Work, dispatch};
use crate::gpu::resources::{Texture, uniform};
use crate::gpu::shader::{HostStruct, ShaderKey};
use crate::technique::Memory;
use crate::error::Error;
use crate::gpu::device::Gpu;
use crate::{bindings, gpu_struct};

gpu_struct! {
    /// The unit of the maps.
    pub(crate) struct PatchUniform {
        /// Distance at which the maps begin, in metres.
        map_near: f32,
        /// Surfaces of a layer are closer together than this, as inverse distance; only the last layer may be thicker.
        gap: f32,
    }
}

/// Levels over the layers of a depth map, from half its size down to one texel; see `shaders/patches.wesl`.
pub struct PatchPyramid {
    /// `Rgba32Uint` array; its level 0 is half as wide as the map, a layer for each layer of the map.
    pub patches: Texture,
    levels: Vec<wgpu::TextureView>,
    uniform: wgpu::Buffer,
    map_size: u32,
}

impl PatchPyramid {
    /// A pyramid over `layers` maps of `size` texels a side.
    pub fn new(gpu: &Gpu, size: u32, layers: u32) -> PatchPyramid {
        let half = size.div_ceil(2).max(1);
        let mips = 32 - half.leading_zeros();
        let usage = wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::TEXTURE_BINDING;
        let patches = Texture::array(gpu, "patches", [half; 2], layers, mips, wgpu::TextureFormat::Rgba32Uint, usage);
        PatchPyramid {
            levels: (0..mips).map(|m| patches.array_mip(m)).collect(),
            uniform: uniform(gpu, "patches", &PatchUniform { map_near: 1.0, gap: 0.0 }),
            patches,
            map_size: size,
        }
    }

    /// Makes a pyramid in `slot` unless one for such maps is there.
    pub fn ensure<'a>(slot: &'a mut Option<PatchPyramid>, gpu: &Gpu, size: u32, layers: u32) -> &'a PatchPyramid {
        let fits = |p: &PatchPyramid| p.map_size == size && p.patches.texture.depth_or_array_layers() == layers;
        if !slot.as_ref().is_some_and(fits) {
            *slot = Some(PatchPyramid::new(gpu, size, layers));
        }
        slot.as_ref().expect("just made")
    }

    /// Reduces the first layers of maps whose frustum begins at `map_near` metres.
    pub fn record(&self, recorder: &mut Recorder, maps: &DepthLayers, map_near: f32, gap: f32) -> Result<(), Error> {
        recorder.gpu.queue.write_buffer(&self.uniform, 0, &PatchUniform { map_near, gap }.uniform_bytes());
        let key = ShaderKey::new("passes::maps::patch_pyramid");
        let first = recorder.gpu.compute_pipeline(&key.clone().feature("first", true), "reduce")?;
        let next = recorder.gpu.compute_pipeline(&key, "reduce")?;
        let [half, layers] = [self.patches.texture.width(), self.patches.texture.depth_or_array_layers()];
        recorder.compute_pass("patch pyramid", |gpu, pass| {
            for (m, level) in self.levels.iter().enumerate() {
                let pipeline = if m == 0 { &first } else { &next };
                let set = bindings! {
                    step: &self.uniform,
                    source_maps: &maps.texture,
                    source_patches: &self.levels[m.saturating_sub(1)],
                    level_patches: level,
                };
                let size = (half >> m).max(1);
                pass.set_pipeline(&pipeline.pipeline);
                pass.set_bind_group(0, &pipeline.bind_group(gpu, 0, set), &[]);
                dispatch(pass, pipeline, Work::Threads([size, size, layers]));
            }
        });
        Ok(())
    }

    /// GPU memory by pass.
    pub fn memory(&self) -> Memory {
        Memory::new("patch pyramid", self.patches.bytes())
    }
}
