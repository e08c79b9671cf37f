//! Depths of all surfaces that the light's centre sees, casters or not: a filterable map needs a depth in every texel.

use crate::error::Error;
use crate::gpu::recorder::Recorder;
use crate::gpu::texture::Texture;
use crate::input::frame::BoundFrame;
use crate::passes::maps::depth_map::{DepthMap, Drawing};
use crate::passes::triangles::culling::Surfaces;

/// The nearest caster of each texel and, behind it, the farthest of the surfaces that only receive. Without these, the
/// mean depth beside a shadow would be that of empty space; drawn with the casters, they would cast.
pub struct LightDepth {
    /// The nearest caster.
    pub casters: DepthMap,
    /// The farthest surface that only receives, if there are such surfaces; 1 in texels without any.
    pub background: Option<DepthMap>,
}

impl LightDepth {
    /// Draws both, `size` texels per side with 1 or 4 depths in each.
    pub fn record(recorder: &mut Recorder, frame: &BoundFrame, size: u32, samples: u32) -> Result<LightDepth, Error> {
        let (casters, clip_from_world) = (&frame.casters, frame.map_clip_from_world());
        let nearest = Drawing { samples, ..Drawing::of("depth map", Surfaces::Casters) };
        let farthest = Drawing {
            help: "farthest surface that only receives, as near / z",
            kept: wgpu::CompareFunction::Less,
            samples,
            ..Drawing::of("background map", Surfaces::Background)
        };
        let mut draw = |drawing: &Drawing| -> Result<DepthMap, Error> {
            Ok(drawing.record(recorder, casters, clip_from_world, size)?.0)
        };
        Ok(LightDepth {
            casters: draw(&nearest)?,
            background: casters.some_only_receive().then(|| draw(&farthest)).transpose()?,
        })
    }

    /// The texture that is bound as the background: any map where there is none.
    pub(crate) fn behind(&self) -> &Texture {
        &self.background.as_ref().unwrap_or(&self.casters).texture
    }
}
