//! What the light's centre sees: the receivers, and the nearest and the farthest surfaces of the occluders.

use crate::passes::culling::Surfaces;
use crate::passes::depth_map::{DepthMap, Drawing};
use crate::recorder::Recorder;
use crate::technique::Memory;
use crate::{Casters, Error, Frame, Gpu};

/// The receiver map and one or two occluder maps [Atty 2006, sections 3.2 and 3.5].
///
/// The paper's second pass keeps the farthest back faces. Here it is the farthest surface that lies before the receivers,
/// whatever way its triangles are wound: on a closed mesh that is the same.
pub(super) struct Maps {
    pub receivers: DepthMap,
    pub nearest: DepthMap,
    pub farthest: Option<DepthMap>,
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
            let farthest = if passes > 1 { Some(map()?) } else { None };
            *slot = Some(Maps { receivers: map()?, nearest: map()?, farthest });
        }
        Ok(slot.as_ref().expect("just made"))
    }

    /// Draws all of them.
    pub fn record(&self, recorder: &mut Recorder, frame: &Frame) -> Result<(), Error> {
        let clip_from_world = frame.map_clip_from_world();
        let mut draw =
            |map: &DepthMap, drawing: &Drawing| map.draw(recorder, &frame.casters, clip_from_world, drawing);
        draw(&self.receivers, &Drawing::of("receiver map", Surfaces::Receivers))?;
        let occluders = Drawing::of("occluder maps", Surfaces::Occluders);
        draw(&self.nearest, &occluders)?;
        match &self.farthest {
            Some(map) => draw(map, &Drawing { before: Some(&self.receivers), ..occluders }),
            None => Ok(()),
        }
    }

    /// The map of the farthest surfaces, or of the nearest where it is all there is.
    pub fn last(&self) -> &DepthMap {
        self.farthest.as_ref().unwrap_or(&self.nearest)
    }

    /// GPU memory by pass.
    pub fn memory(&self) -> Vec<Memory> {
        let labelled = |map: &DepthMap, label| map.memory().map(|m| relabelled(m, label));
        let occluders = [Some(&self.nearest), self.farthest.as_ref()];
        let occluders = occluders.into_iter().flatten().flat_map(|map| labelled(map, "occluder maps"));
        occluders.chain(labelled(&self.receivers, "receiver map")).collect()
    }
}

fn relabelled(memory: Memory, label: &'static str) -> Memory {
    if memory.pass == "depth map" { Memory::new(label, memory.bytes) } else { memory }
}
