//! A pyramid of patches over depth layers: each node describes the surfaces below it as one plane or as two surfaces.

use crate::error::Error;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::shader::ShaderKey;
use crate::gpu::texture::{Texture, TextureDescription};
use crate::passes::maps::depth_layers::DepthLayers;
use crate::passes::maps::depth_pyramid::finest_level;
use crate::{bindings, gpu_struct};

gpu_struct! {
    /// The unit of the maps.
    pub(crate) struct PatchUniform {
        /// Distance of the maps' near plane, metres.
        map_near: f32,
        /// Largest extent of all layers but the last, as a difference of inverse distances.
        gap: f32,
    }
}

/// Reduces maps whose frustum begins at `map_near` metres: levels from half their size down to one texel, an array
/// layer for each of theirs. `Rgba32Uint`; see `shaders/patches.wesl`.
pub fn patch_pyramid(recorder: &mut Recorder, maps: &DepthLayers, map_near: f32) -> Result<Texture, Error> {
    let half = finest_level(maps.nearest.size);
    let (layers, mips) = (maps.texture.texture.depth_or_array_layers(), half.ilog2() + 1);
    let help = "packed patches: inverse distance of the nearer surface, of the farther, slopes, residual and shares";
    let description =
        TextureDescription::new([half; 2], wgpu::TextureFormat::Rgba32Uint, help).layers(layers).mips(mips);
    let patches = recorder.texture("patches", description);
    let uniform = recorder.uniform("patches", &PatchUniform { map_near, gap: maps.gap });
    let key = ShaderKey::new("passes::maps::patch_pyramid");
    let first = recorder.gpu.compute_pipeline(&key.clone().feature("first", true), "reduce")?;
    let next = recorder.gpu.compute_pipeline(&key, "reduce")?;
    for level in 0..mips {
        let pipeline = if level == 0 { &first } else { &next };
        let (finer, own) = (patches.array_mip(level.saturating_sub(1)), patches.array_mip(level));
        let set = bindings! {
            step: &uniform,
            source_maps: &maps.texture,
            source_patches: &finer,
            level_patches: &own,
        };
        let side = half >> level;
        recorder.compute("patch pyramid", pipeline, &[set], Work::Threads([side, side, layers]))?;
    }
    Ok(patches)
}
