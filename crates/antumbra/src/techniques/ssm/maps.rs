//! What the light's centre sees: the receivers, and the nearest and the farthest surfaces of the occluders.

use crate::passes::triangles::culling::Surfaces;
use crate::passes::maps::depth_map::{DepthMap, Drawing, Farthest};
use crate::gpu::recorder::Recorder;
use crate::gpu::resources::storage_buffer;
use crate::technique::{InnerPicture, Memory};
use crate::input::casters::Casters;
use crate::error::Error;
use crate::input::frame::Frame;
use crate::gpu::device::Gpu;

/// Labels of the two drawings.
const RECEIVERS: &str = "receiver map";
const OCCLUDERS: &str = "occluder maps";

/// The receiver map and one or two occluder maps [Atty 2006, sections 3.2 and 3.5].
///
/// The paper's second pass keeps the farthest back faces. Here it is the farthest surface that lies before the
/// receivers, whatever way its triangles are wound: on a closed mesh that is the same.
pub(super) struct Maps {
    pub receivers: DepthMap,
    pub nearest: DepthMap,
    /// The depths of the farthest surfaces, as in [`Farthest`]; 16 bytes where they are not asked for.
    pub farthest: wgpu::Buffer,
    passes: u32,
}

impl Maps {
    /// Makes maps in `slot` unless such for these casters are there.
    pub fn ensure<'a>(
        slot: &'a mut Option<Maps>,
        gpu: &Gpu,
        size: u32,
        passes: u32,
        casters: &Casters,
    ) -> Result<&'a Maps, Error> {
        if !slot.as_ref().is_some_and(|maps| maps.receivers.fits(size, casters)) {
            let map = || DepthMap::new(gpu, size, casters);
            let texels = if passes > 1 { u64::from(size) * u64::from(size) } else { 0 };
            let farthest = storage_buffer(gpu, "farthest occluders", 4 * texels);
            *slot = Some(Maps { receivers: map()?, nearest: map()?, farthest, passes });
        }
        Ok(slot.as_ref().expect("just made"))
    }

    /// Draws all of them, the triangles of the occluders once.
    pub fn record(&self, recorder: &mut Recorder, frame: &Frame) -> Result<(), Error> {
        let clip_from_world = frame.map_clip_from_world();
        let mut draw = |map: &DepthMap, drawing: &Drawing| map.draw(recorder, &frame.casters, clip_from_world, drawing);
        draw(&self.receivers, &Drawing::of(RECEIVERS, Surfaces::Receivers))?;
        let farthest = Farthest { before: &self.receivers, depths: &self.farthest };
        let occluders = Drawing::of(OCCLUDERS, Surfaces::Occluders);
        draw(&self.nearest, &Drawing { farthest: (self.passes > 1).then_some(farthest), ..occluders })
    }

    /// For looking at.
    pub fn inner_pictures(&self) -> [InnerPicture; 2] {
        let receivers = InnerPicture { name: "receivers", ..self.receivers.inner_picture() };
        [receivers, InnerPicture { name: "nearest occluders", ..self.nearest.inner_picture() }]
    }

    /// GPU memory by pass.
    pub fn memory(&self) -> Vec<Memory> {
        let farthest = Memory::new(OCCLUDERS, self.farthest.size());
        let maps = [self.receivers.memory_of(RECEIVERS), self.nearest.memory_of(OCCLUDERS)];
        maps.into_iter().flatten().chain([farthest]).collect()
    }
}
