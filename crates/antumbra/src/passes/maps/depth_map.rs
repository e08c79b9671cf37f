//! The shadow map: depth of the nearest caster seen from a point of the light.

use crate::error::Error;
use crate::gpu::pipeline::{RenderPipeline, RenderTarget};
use crate::gpu::recorder::{Recorder, depth_target};
use crate::gpu::resources::BufferDescription;
use crate::gpu::shader::ShaderKey;
use crate::gpu::texture::{Texture, TextureDescription};
use crate::input::casters::Casters;
use crate::input::frame::BoundFrame;
use crate::input::map_view::MapView;
use crate::passes::triangles::culling::{Culling, Surfaces};
use crate::{bindings, gpu_struct};
use glam::Mat4;
use std::sync::Arc;

/// A square map of `near / z`, z being the linear distance along the light's normal and `near` that of the frustum
/// [Williams 1978]. The reversed depth with its far plane at infinity is the inverse distance itself: 0 is infinitely
/// far, planes are affine in the map's coordinates, and no second texture is needed for linear depth.
pub struct DepthMap {
    /// `Depth32Float`, square.
    pub texture: Texture,
    /// Texels per side.
    pub size: u32,
    /// The clusters that were drawn.
    pub culling: Culling,
}

/// The surfaces that are drawn into a map, and the depths that are kept of them.
pub(crate) struct Drawing<'a> {
    /// Label of the pass and of its map.
    pub label: &'static str,
    /// Meaning of the map, for debug views.
    pub help: &'static str,
    /// Surfaces that are drawn.
    pub surfaces: Surfaces,
    /// `Greater` keeps the nearest surface of each texel, `Less` the farthest; depth is reversed.
    pub kept: wgpu::CompareFunction,
    /// Depths per texel, 1 or 4.
    pub samples: u32,
    /// The surfaces of a texel that are kept besides that one.
    pub extra: Extra<'a>,
    /// True if a surface is drawn to every texel that it touches, not only to those whose middle it covers; then
    /// nothing else can be kept.
    pub touched: bool,
}

/// Depths that a drawing keeps besides its map, in a buffer.
#[derive(Clone, Copy)]
pub(crate) enum Extra<'a> {
    /// None.
    Nothing,
    /// The farthest surface of each texel before a map of the same size: the bits of its depth, complemented, row by row;
    /// 0 where there is none.
    FarthestBefore(&'a Texture),
    /// The nearest surfaces of each texel, by a `LayerShape` and the bytes that it takes: see
    /// [`DepthLayers`](super::depth_layers::DepthLayers).
    Nearest(&'a wgpu::Buffer, u64),
}

gpu_struct! {
    /// See `conservative_map.wesl`.
    pub(crate) struct ConservativeUniform {
        /// Half a texel in the units of clip space, and a little more for rounding.
        half_texel: f32,
    }
}

/// A drawn map, and the buffer of its [`Extra`] depths.
pub(crate) type Drawn = (DepthMap, Option<wgpu::Buffer>);

impl<'a> Drawing<'a> {
    /// The nearest of these surfaces.
    pub fn of(label: &'static str, surfaces: Surfaces) -> Drawing<'a> {
        Drawing {
            label,
            help: "nearest caster as near / z: 0 is infinitely far, 1 at the near plane",
            surfaces,
            kept: wgpu::CompareFunction::Greater,
            samples: 1,
            extra: Extra::Nothing,
            touched: false,
        }
    }

    /// Draws a map of `size` texels per side.
    pub fn record(
        &self,
        recorder: &mut Recorder,
        casters: &Casters,
        clip_from_world: Mat4,
        size: u32,
    ) -> Result<Drawn, Error> {
        recorder.gpu.check_size("shadow map", size, size)?;
        let view = recorder.uniform("map view", &MapView::new(clip_from_world));
        let culling = Culling::record(recorder, casters, self.surfaces, &view)?;
        let format = wgpu::TextureFormat::Depth32Float;
        let description = TextureDescription::new([size; 2], format, self.help).samples(self.samples);
        let texture = recorder.texture(self.label, description);
        let texel = recorder.uniform("map texel", &ConservativeUniform { half_texel: 1.001 / size as f32 });
        let texels = u64::from(size) * u64::from(size);
        let depths = match self.extra {
            Extra::Nothing => None,
            Extra::FarthestBefore(_) => {
                Some(recorder.buffer("farthest depths", BufferDescription::new(4 * texels).cleared()))
            }
            Extra::Nearest(_, bytes) => Some(recorder.buffer("nearest depths", BufferDescription::new(bytes))),
        };
        let [opaque, masked] = self.pipelines(recorder)?;
        let mut own = bindings! { map_view: &view, visible: &culling.visible }.to_vec();
        match (self.extra, &depths) {
            (Extra::FarthestBefore(map), Some(depths)) => {
                own.extend_from_slice(bindings! { background: map, farthest_depths: depths });
            }
            (Extra::Nearest(shape, _), Some(depths)) => {
                own.extend_from_slice(bindings! { layer_shape: shape, nearest_depths: depths });
            }
            _ if self.touched => own.extend_from_slice(bindings! { conservative: &texel }),
            _ => {}
        }
        // Reversed depth: infinitely far is 0, the nearest of all 1.
        let nothing = if self.kept == wgpu::CompareFunction::Less { 1.0 } else { 0.0 };
        recorder.render(self.label, &[], depth_target(&texture.view, Some(nothing)), 1, |draw| {
            for (i, batch) in casters.batches.iter().enumerate() {
                let pipeline = if batch.masked { &masked } else { &opaque };
                draw.bind(pipeline, &[&own, &batch.bindings(casters)])?;
                draw.pass.draw_indirect(&culling.draws, Culling::draw_offset(i));
            }
            Ok(())
        })?;
        Ok((DepthMap { texture, size, culling }, depths))
    }

    fn pipelines(&self, recorder: &Recorder) -> Result<[Arc<RenderPipeline>; 2], Error> {
        let native = self.touched && recorder.gpu.capabilities.conservative_rasterization;
        let target = RenderTarget {
            depth: Some(self.kept),
            samples: self.samples,
            conservative: native,
            ..RenderTarget::default()
        };
        let key = match self.touched {
            true => ShaderKey::new("passes::maps::conservative_map").feature("native", native),
            false => ShaderKey::new("passes::maps::depth_map")
                .feature("layers", matches!(self.extra, Extra::Nearest(..)))
                .feature("farthest", matches!(self.extra, Extra::FarthestBefore(_))),
        };
        let opaque = recorder.gpu.render_pipeline(&key, &target)?;
        Ok([opaque, recorder.gpu.render_pipeline(&key.feature("masked", true), &target)?])
    }
}

impl DepthMap {
    /// Draws the casters from the light's centre into a map of `size` texels per side.
    pub fn of_light(recorder: &mut Recorder, frame: &BoundFrame, size: u32) -> Result<DepthMap, Error> {
        DepthMap::record(recorder, &frame.casters, frame.map_clip_from_world(), size)
    }

    /// Draws the casters that `clip_from_world` holds.
    pub fn record(
        recorder: &mut Recorder,
        casters: &Casters,
        clip_from_world: Mat4,
        size: u32,
    ) -> Result<DepthMap, Error> {
        let drawing = Drawing::of("depth map", Surfaces::Casters);
        Ok(drawing.record(recorder, casters, clip_from_world, size)?.0)
    }

    /// Draws the casters that the light's centre sees, each to every texel that it touches: a caster that no texel of a
    /// window shows is not in that window. Holes of masked materials that are smaller than a texel may be closed.
    pub(crate) fn record_touched(
        recorder: &mut Recorder,
        frame: &BoundFrame,
        label: &'static str,
        size: u32,
    ) -> Result<DepthMap, Error> {
        let drawing = Drawing { touched: true, ..Drawing::of(label, Surfaces::Casters) };
        Ok(drawing.record(recorder, &frame.casters, frame.map_clip_from_world(), size)?.0)
    }
}
