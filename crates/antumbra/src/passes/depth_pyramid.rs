//! A pyramid over a depth map: what lies below a node is bounded, and averaged, by one read.

use crate::passes::depth_map::DepthMap;
use crate::recorder::{Recorder, Work, dispatch};
use crate::resource::{Texture, uniform};
use crate::shader::{HostStruct, ShaderKey};
use crate::technique::{InnerPicture, Memory};
use crate::{Error, Gpu, bindings, gpu_struct};

gpu_struct! {
    /// What a level is made with.
    pub(crate) struct PyramidUniform {
        map_near: f32,
    }
}

/// Levels over a depth map, from half its size down to one texel. All values are inverse distances (1/metres; 0 for
/// nothing). What lies below a node is bounded, and it is told as two layers: an occluder and what is behind it.
pub struct DepthPyramid {
    /// `Rg32Float`, smallest and largest; its level 0 is half as wide as the map.
    pub bounds: Texture,
    /// `Rgba32Float`, of the same size: mean of the nearer layer, of the farther, share of the nearer; see
    /// `shaders/layers.wesl`.
    pub layers: Texture,
    /// One view a level.
    levels: Vec<[wgpu::TextureView; 2]>,
    uniform: wgpu::Buffer,
}

impl DepthPyramid {
    /// A pyramid over a map of `size` texels a side.
    pub fn new(gpu: &Gpu, size: u32) -> DepthPyramid {
        let half = size.div_ceil(2).max(1);
        let mips = 32 - half.leading_zeros();
        let usage = wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::TEXTURE_BINDING;
        let texture = |label, format| Texture::new(gpu, label, [half; 2], mips, format, usage);
        let bounds = texture("depth bounds", wgpu::TextureFormat::Rg32Float);
        let layers = texture("depth layers", wgpu::TextureFormat::Rgba32Float);
        DepthPyramid {
            levels: (0..mips).map(|m| [bounds.mip(m), layers.mip(m)]).collect(),
            uniform: uniform(gpu, "pyramid", &PyramidUniform { map_near: 1.0 }),
            bounds,
            layers,
        }
    }

    /// Makes a pyramid in `slot` unless one for a map of this size is there.
    pub fn ensure<'a>(slot: &'a mut Option<DepthPyramid>, gpu: &Gpu, size: u32) -> &'a DepthPyramid {
        let half = size.div_ceil(2).max(1);
        if slot.as_ref().is_none_or(|p| p.bounds.texture.width() != half) {
            *slot = Some(DepthPyramid::new(gpu, size));
        }
        slot.as_ref().expect("just made")
    }

    /// Reduces a map whose frustum begins at `map_near` metres.
    pub fn record(&self, recorder: &mut Recorder, map: &DepthMap, map_near: f32) -> Result<(), Error> {
        recorder.gpu.queue.write_buffer(&self.uniform, 0, &PyramidUniform { map_near }.uniform_bytes());
        let key = ShaderKey::new("passes::depth_pyramid").with::<PyramidUniform>();
        let first = recorder.gpu.compute_pipeline(&key.clone().feature("first", true), "reduce")?;
        let next = recorder.gpu.compute_pipeline(&key, "reduce")?;
        recorder.compute_pass("depth pyramid", |gpu, pass| {
            for (m, [bounds, layers]) in self.levels.iter().enumerate() {
                let below = &self.levels[m.saturating_sub(1)];
                let pipeline = if m == 0 { &first } else { &next };
                let set = bindings! {
                    step: &self.uniform,
                    source_map: &map.texture,
                    source_bounds: &below[0],
                    source_layers: &below[1],
                    level_bounds: bounds,
                    level_layers: layers,
                };
                let size = (self.bounds.texture.width() >> m).max(1);
                pass.set_pipeline(&pipeline.pipeline);
                pass.set_bind_group(0, &pipeline.bind_group(gpu, 0, set), &[]);
                dispatch(pass, pipeline, Work::Threads([size, size, 1]));
            }
        });
        Ok(())
    }

    /// For looking at.
    pub fn inner_pictures(&self) -> [InnerPicture; 2] {
        let bounds = "smallest and largest inverse distance below each node, 1/metres";
        let layers = "mean inverse distance of the nearer and of the farther layer, 1/metres; share of the nearer";
        [
            InnerPicture::of_texture("depth pyramid: bounds", bounds, &self.bounds),
            InnerPicture::of_texture("depth pyramid: layers", layers, &self.layers),
        ]
    }

    /// GPU memory by pass.
    pub fn memory(&self) -> Memory {
        Memory::new("depth pyramid", self.bounds.bytes() + self.layers.bytes())
    }
}
