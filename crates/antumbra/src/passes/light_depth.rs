//! What the light's centre sees of all surfaces, casters or not: what is filtered needs a depth in every texel.

use crate::casters::Casters;
use crate::passes::depth_map::DepthMap;
use crate::recorder::Recorder;
use crate::technique::Memory;
use crate::{Error, Frame, Gpu};

/// The nearest caster of each texel and, behind it, the farthest of the surfaces that only take shadows. Were these left
/// out, the mean depth beside a shadow would be that of empty space; were they drawn with the casters, they would cast.
pub struct LightDepth {
    /// The nearest caster.
    pub casters: DepthMap,
    /// The farthest surface that only takes shadows, if there are such surfaces.
    pub background: Option<DepthMap>,
}

impl LightDepth {
    /// Empty maps of `size` texels a side with 1 or 4 depths in each.
    pub fn new(gpu: &Gpu, size: u32, samples: u32, casters: &Casters) -> Result<LightDepth, Error> {
        let background = casters.some_only_receive().then(|| DepthMap::background(gpu, size, samples, casters));
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
        let maps = std::iter::once(&self.casters).chain(&self.background);
        maps.into_iter().try_for_each(|map| map.record(recorder, &frame.casters, clip_from_world))
    }

    /// What is bound as the background: any map where there is none.
    pub(crate) fn behind(&self) -> &DepthMap {
        self.background.as_ref().unwrap_or(&self.casters)
    }

    /// GPU memory by pass.
    pub fn memory(&self) -> Vec<Memory> {
        std::iter::once(&self.casters).chain(&self.background).flat_map(DepthMap::memory).collect()
    }
}
