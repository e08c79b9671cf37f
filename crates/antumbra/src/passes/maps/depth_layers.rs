//! The nearest few casters of each texel, seen from the light's centre, in one pass over the casters.
//!
//! Each fragment inserts its depth among the texel's nearest by a chain of atomic maxima: the multi-depth test of [Liu
//! et al. 2010]. Depth peeling, a pass over the casters for each layer, gives the same bits. Time of the single pass
//! relative to peeling, for as many surfaces as layers, on llvmpipe with 2 cores (medians of 5 frames):
//!
//! | scene (triangles) | 1024 texels, 2 layers | 4 layers | 2048 texels, 2 layers | 4 layers |
//! |---|---|---|---|---|
//! | fence (5 thousand) | 0.84 | 0.56 | 1.16 | 0.74 |
//! | layers (8 thousand) | 0.94 | 0.69 | 1.95 | 1.08 |
//! | plant (10 thousand) | 0.67 | 0.44 | 0.91 | 0.55 |
//! | Stanford bunny (69 thousand) | 0.77 | 0.37 | 0.86 | 0.47 |
//! | bumpy (476 thousand) | 0.51 | 0.28 | 0.61 | 0.31 |
//!
//! Peeling is faster where few triangles cover many texels and two layers are wanted. The single pass gains with the
//! number of layers and of triangles; on average it takes two thirds of the time. GPUs have not been measured. It needs
//! more memory: k layers of single surfaces take 3k + 1 maps where peeling takes k, and merged surfaces four more.

use crate::error::Error;
use crate::gpu::device::Gpu;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::shader::ShaderKey;
use crate::gpu::texture::{Texture, TextureDescription};
use crate::input::frame::BoundFrame;
use crate::passes::maps::depth_map::{DepthMap, Drawing, Extra};
use crate::passes::triangles::culling::Surfaces;
use crate::{bindings, gpu_struct};

gpu_struct! {
    /// Layout of the collected depths in their buffer: a slice of rows for each surface, nearest first.
    pub(crate) struct LayerShape {
        /// Texels per side.
        size: u32,
        /// Texels from one row to the next.
        row: u32,
        /// Surfaces collected per texel.
        count: u32,
        /// Layers that are stored: `textureNumLayers` of a storage texture is not valid SPIR-V with naga 30.
        layers: u32,
        /// Surfaces less than this behind the first of a layer join it, in the unit of the depths.
        gap: f32,
    }
}

/// Square maps of depth intervals, nearest first: each texel has the `near / z` of the interval's nearer end, as in
/// [`DepthMap`], and its length. A layer is a surface, or several with little parallax over the light, such as both
/// sides of a slat or the leaves of a twig. The last layer extends down to the collected surfaces that have no layer of
/// their own. An empty layer is 0.
///
/// Surfaces of equal depth, bit for bit, are one. Coinciding surfaces of different triangles may differ in the last
/// bits, by up to some 4e-7 of the depth.
pub struct DepthLayers {
    /// `Rg32Float`, `size` x `size` x `layers`; its view is an array even of a single layer.
    pub texture: Texture,
    /// The nearest surface, drawn by the same pass.
    pub nearest: DepthMap,
    /// Largest extent of all layers but the last, as a difference of inverse distances, 1/metres.
    pub gap: f32,
}

/// Surfaces that are collected besides one per layer if surfaces are merged: both sides of two more objects as a rule.
const EXTRA_SURFACES: u32 = 4;

impl DepthLayers {
    /// Draws the surfaces nearest to the light's centre, and those behind them, into `layers` (1 or more) maps of
    /// `size` texels per side. Surfaces join a layer if their parallax between the light's centre and its border is
    /// below `apart` texels. With 0 each surface is a layer, and those behind the last are dropped.
    pub fn of_light(
        recorder: &mut Recorder,
        frame: &BoundFrame,
        size: u32,
        layers: u32,
        apart: f32,
    ) -> Result<DepthLayers, Error> {
        recorder.gpu.check_size("shadow map", size, size)?;
        let gap = largest_gap(frame, size, apart);
        let shape = LayerShape {
            size,
            row: size.next_multiple_of(64),
            count: collected_surfaces(recorder.gpu, size, layers, apart > 0.0)?,
            layers,
            gap: frame.frustum.near * gap,
        };
        let bytes = 4 * u64::from(shape.row) * u64::from(size) * u64::from(shape.count);
        let uniform = recorder.uniform("layer shape", &shape);
        let drawing =
            Drawing { extra: Extra::Nearest(&uniform, bytes), ..Drawing::of("depth layers", Surfaces::Casters) };
        let (nearest, depths) = drawing.record(recorder, &frame.casters, frame.map_clip_from_world(), size)?;
        let depths = depths.expect("an extra of the drawing");
        let merge = recorder.gpu.compute_pipeline(&ShaderKey::new("passes::maps::depth_layers"), "merge_layers")?;
        let help = "near / z of each layer's nearer end, and its extent in the same unit";
        let description = TextureDescription::new([size; 2], wgpu::TextureFormat::Rg32Float, help).layers(layers);
        let texture = recorder.texture("depth layers", description);
        let set = bindings! { nearest_depths: &depths, layer_shape: &uniform, layers: &texture };
        recorder.compute("merging layers", &merge, &[set], Work::Threads([size, size, 1]))?;
        Ok(DepthLayers { texture, nearest, gap })
    }
}

/// Surfaces that are collected per texel: one per layer, and more if surfaces are `merged`, as far as a buffer holds
/// them.
fn collected_surfaces(gpu: &Gpu, size: u32, layers: u32, merged: bool) -> Result<u32, Error> {
    let limits = gpu.device.limits();
    let most = limits.max_buffer_size.min(limits.max_storage_buffer_binding_size) / 4;
    let fit = (most / (u64::from(size.next_multiple_of(64)) * u64::from(size))) as u32;
    if fit < layers {
        let max = (most / u64::from(layers)).isqrt() as u32;
        return Err(Error::Size { what: "depth layers", width: size, height: size, max });
    }
    Ok(if merged { (layers + EXTRA_SURFACES).min(fit) } else { layers })
}

/// The difference of inverse distances that has a parallax of `apart` texels over half the light, 1/metres.
fn largest_gap(frame: &BoundFrame, size: u32, apart: f32) -> f32 {
    let texel = 2.0 * frame.frustum.tan_half / size as f32;
    let half_light = (0.5 * frame.light.size).max(glam::Vec2::splat(1.0e-6));
    apart * (texel / half_light).min_element()
}
