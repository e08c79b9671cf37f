//! What the light's centre sees of all surfaces, casters or not: what is filtered needs a depth in every texel.

use crate::input::casters::Casters;
use crate::passes::triangles::culling::Surfaces;
use crate::passes::maps::depth_map::{DepthMap, Drawing};
use crate::gpu::recorder::Recorder;
use crate::technique::Memory;
use crate::error::Error;
use crate::input::frame::Frame;
use crate::gpu::device::Gpu;

/// Label of the pass that draws what only takes shadows.
const BACKGROUND: &str = "background map";

/// The nearest caster of each texel and, behind it, the farthest of the surfaces that only take shadows. Were these left
/// out, the mean depth beside a shadow would be that of empty space; were they drawn with the casters, they would cast.
pub struct LightDepth {
    /// The nearest caster.
    pub casters: DepthMap,
    /// The farthest surface that only takes shadows, if there are such surfaces; 1 in texels without any.
    pub background: Option<DepthMap>,
}

impl LightDepth {
    /// Empty maps of `size` texels a side with 1 or 4 depths in each.
    pub fn new(gpu: &Gpu, size: u32, samples: u32, casters: &Casters) -> Result<LightDepth, Error> {
        let background = casters.some_only_receive().then(|| DepthMap::multisampled(gpu, size, samples, casters));
        Ok(LightDepth {
            casters: DepthMap::multisampled(gpu, size, samples, casters)?,
            background: background.transpose()?,
        })
    }

    /// True if made for these casters.
    pub fn fits(&self, casters: &Casters) -> bool {
        self.casters.culling().fits(casters) && self.background.is_some() == casters.some_only_receive()
    }

    /// Draws both.
    pub fn record(&self, recorder: &mut Recorder, frame: &Frame) -> Result<(), Error> {
        let clip_from_world = frame.map_clip_from_world();
        self.casters.record(recorder, &frame.casters, clip_from_world)?;
        let Some(background) = &self.background else { return Ok(()) };
        let kept = wgpu::CompareFunction::Less;
        let drawing = Drawing { kept, ..Drawing::of(BACKGROUND, Surfaces::Background) };
        background.draw(recorder, &frame.casters, clip_from_world, &drawing)
    }

    /// What is bound as the background: any map where there is none.
    pub(crate) fn behind(&self) -> &DepthMap {
        self.background.as_ref().unwrap_or(&self.casters)
    }

    /// GPU memory by pass.
    pub fn memory(&self) -> Vec<Memory> {
        let background = self.background.iter().flat_map(|map| map.memory_of(BACKGROUND));
        self.casters.memory().into_iter().chain(background).collect()
    }
}
