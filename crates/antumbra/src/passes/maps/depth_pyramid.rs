//! A pyramid over a depth map: the texels below a node are bounded, and averaged, by one read.

use crate::error::Error;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::shader::ShaderKey;
use crate::gpu::texture::{Texture, TextureDescription};
use crate::passes::maps::depth_map::DepthMap;
use crate::{bindings, gpu_struct};

gpu_struct! {
    /// Constants of a pyramid's reduction.
    pub(crate) struct PyramidUniform {
        map_near: f32,
    }
}

/// Levels over a depth map, from half its size down to one texel. All values are inverse distances (1/metres; 0 for
/// nothing). A node has bounds of the texels below it, and two layers: an occluder and the surface behind it.
pub struct DepthPyramid {
    /// `Rg32Float`, smallest and largest; its level 0 is half as wide as the map.
    pub bounds: Texture,
    /// `Rgba32Float`, of the same size: mean of the nearer layer, of the farther, share of the nearer; see
    /// `shaders/layers.wesl`.
    pub layers: Texture,
}

/// Nodes per side of a pyramid's finest level over a map of `size` texels per side. A power of two: the side of a mip
/// level is rounded down, so any other side would lose the last nodes of a level with an odd number of them.
pub(crate) fn finest_level(size: u32) -> u32 {
    size.div_ceil(2).next_power_of_two()
}

impl DepthPyramid {
    /// Reduces a map whose frustum begins at `map_near` metres.
    pub fn record(recorder: &mut Recorder, map: &DepthMap, map_near: f32) -> Result<DepthPyramid, Error> {
        let half = finest_level(map.size);
        let mips = half.ilog2() + 1;
        let texture = |format, help| TextureDescription::new([half; 2], format, help).mips(mips);
        let bounds =
            texture(wgpu::TextureFormat::Rg32Float, "smallest and largest inverse distance below each node, 1/metres");
        let layers = texture(
            wgpu::TextureFormat::Rgba32Float,
            "mean inverse distance of the nearer and of the farther layer, 1/metres; share of the nearer",
        );
        let bounds = recorder.texture("depth pyramid: bounds", bounds);
        let layers = recorder.texture("depth pyramid: layers", layers);
        let uniform = recorder.uniform("pyramid", &PyramidUniform { map_near });
        let key = ShaderKey::new("passes::maps::depth_pyramid");
        let first = recorder.gpu.compute_pipeline(&key.clone().feature("first", true), "reduce")?;
        let next = recorder.gpu.compute_pipeline(&key, "reduce")?;
        for level in 0..mips {
            let pipeline = if level == 0 { &first } else { &next };
            let finer = level.saturating_sub(1);
            let [finer_bounds, finer_layers] = [&bounds, &layers].map(|texture| texture.mip(finer));
            let [level_bounds, level_layers] = [&bounds, &layers].map(|texture| texture.mip(level));
            let set = bindings! {
                step: &uniform,
                source_map: &map.texture,
                source_bounds: &finer_bounds,
                source_layers: &finer_layers,
                level_bounds: &level_bounds,
                level_layers: &level_layers,
            };
            let side = half >> level;
            recorder.compute("depth pyramid", pipeline, &[set], Work::Threads([side, side, 1]))?;
        }
        Ok(DepthPyramid { bounds, layers })
    }
}
