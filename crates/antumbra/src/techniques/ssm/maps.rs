//! The maps from the light's centre: receivers, nearest and farthest surfaces of the occluders.

use crate::error::Error;
use crate::gpu::recorder::Recorder;
use crate::input::frame::BoundFrame;
use crate::passes::maps::depth_map::{DepthMap, Drawing, Extra};
use crate::passes::triangles::culling::Surfaces;

/// The receiver map and one or two occluder maps [Atty 2006, sections 3.2 and 3.5].
///
/// The paper's second pass keeps the farthest back faces. Here it is the farthest surface before the receivers,
/// whatever the winding of its triangles: the same on a closed mesh.
pub(super) struct Maps {
    pub receivers: DepthMap,
    pub nearest: DepthMap,
    /// The depths of the farthest surfaces, as in [`Extra::FarthestBefore`], by two passes.
    pub farthest: Option<wgpu::Buffer>,
}

impl Maps {
    /// Draws maps of `size` texels per side. The triangles of the occluders are drawn once, also for two passes.
    pub fn record(recorder: &mut Recorder, frame: &BoundFrame, size: u32, passes: u32) -> Result<Maps, Error> {
        let mut draw = |drawing: Drawing| drawing.record(recorder, &frame.casters, frame.map_clip_from_world(), size);
        let (receivers, _) = draw(Drawing::of("receiver map", Surfaces::Receivers))?;
        let extra = if passes > 1 { Extra::FarthestBefore(&receivers.texture) } else { Extra::Nothing };
        let (nearest, farthest) = draw(Drawing { extra, ..Drawing::of("occluder maps", Surfaces::Occluders) })?;
        Ok(Maps { receivers, nearest, farthest })
    }
}
