//! The shadow map: one lookup, a hard edge, no penumbra [Williams 1978].

use crate::frame::FrameUniform;
use crate::passes::depth_map::DepthMap;
use crate::pipeline::ComputePipeline;
use crate::recorder::{Recorder, Work};
use crate::shader::ShaderKey;
use crate::technique::{About, Describe, InnerPicture, Memory, Technique};
use crate::{Error, Frame, Gpu, bindings, settings::Kind};
use std::sync::Arc;

crate::settings! {
    /// Settings of [`Hard`].
    pub struct HardSettings {
        /// Shadow map, texels a side.
        map: u32 = 2048, Kind::Integer { min: 16, max: 16384 };
    }
}

/// Shadow of the light's centre.
pub struct Hard {
    settings: HardSettings,
    lookup: Arc<ComputePipeline>,
    map: Option<DepthMap>,
}

impl Describe for Hard {
    type Settings = HardSettings;
    const ABOUT: About = About {
        name: "hard",
        title: "Shadow map",
        source: "Williams 1978",
        summary: "one depth comparison a pixel; the light is a point at its centre",
    };

    fn make(gpu: &Gpu, settings: HardSettings) -> Result<Self, Error> {
        let lookup =
            gpu.compute_pipeline(&ShaderKey::new("techniques::hard::lookup").with::<FrameUniform>(), "lookup")?;
        Ok(Hard { settings, lookup, map: None })
    }
}

impl Technique for Hard {
    fn record(&mut self, frame: &Frame, recorder: &mut Recorder) -> Result<(), Error> {
        let map = DepthMap::of_light(&mut self.map, recorder, frame, self.settings.map)?;
        let set = frame.bindings(bindings! {
            depth_map: &map.texture,
        });
        let [width, height] = frame.geometry.size;
        recorder.compute("shadow lookup", &self.lookup, &set, Work::Threads([width, height, 1]));
        Ok(())
    }

    fn inner_pictures(&self) -> Vec<InnerPicture> {
        self.map.iter().map(DepthMap::inner_picture).collect()
    }

    fn memory(&self) -> Vec<Memory> {
        self.map.iter().flat_map(DepthMap::memory).collect()
    }
}
