//! Lance Williams, 1978: Casting curved shadows on curved surfaces, <https://doi.org/10.1145/800248.807402>.
//!
//! The shadow map: one lookup per pixel, a hard edge, no penumbra.

use crate::bindings;
use crate::error::Error;
use crate::gpu::device::Gpu;
use crate::gpu::pipeline::ComputePipeline;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::shader::ShaderKey;
use crate::input::frame::BoundFrame;
use crate::passes::maps::depth_map::DepthMap;
use crate::technique::settings::Kind;
use crate::technique::{Description, Technique, TechniqueFactory};
use std::sync::Arc;

crate::settings! {
    /// Settings of [`Hard`].
    pub struct HardSettings {
        /// Shadow map, texels per side.
        map: u32 = 2048, Kind::Integer { min: 16, max: 16384 };
    }
}

/// Shadow of the light's centre.
pub struct Hard {
    settings: HardSettings,
    lookup: Arc<ComputePipeline>,
}

impl TechniqueFactory for Hard {
    type Settings = HardSettings;
    type Technique = Hard;
    const DESCRIPTION: Description = Description {
        name: "hard",
        title: "Shadow map",
        source: "Williams 1978",
        summary: "one depth comparison per pixel; the light is a point at its centre",
    };

    fn make(gpu: &Gpu, settings: HardSettings) -> Result<Hard, Error> {
        let lookup = gpu.compute_pipeline(&ShaderKey::new("techniques::shadow_map::hard::lookup"), "lookup")?;
        Ok(Hard { settings, lookup })
    }
}

impl Technique for Hard {
    fn record(&mut self, frame: &BoundFrame, recorder: &mut Recorder) -> Result<(), Error> {
        let map = DepthMap::of_light(recorder, frame, self.settings.map)?;
        let set = [&frame.bindings()[..], bindings! { depth_map: &map.texture }];
        recorder.compute("shadow lookup", &self.lookup, &set, Work::Pixels(frame.size))
    }
}
