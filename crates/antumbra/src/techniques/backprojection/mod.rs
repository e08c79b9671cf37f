//! Layered back-projection: every patch of the map that rises above the receiver's plane is projected from the receiver
//! to the light, and the light's points that it covers are taken from the light [Guennebaud 2006, 2007].

use crate::frame::FrameUniform;
use crate::passes::{
    classify::PenumbraList, depth_layers::DepthLayers, depth_pyramid::DepthPyramid, patch_pyramid::PatchPyramid,
};
use crate::pipeline::ComputePipeline;
use crate::recorder::{Recorder, Work};
use crate::resource::uniform;
use crate::shader::ShaderKey;
use crate::technique::{About, Describe, Memory, Technique};
use crate::{Error, Frame, Gpu, bindings, gpu_struct};
use serde_json::{Map, Value};
use std::sync::Arc;

mod settings;

pub use settings::{BackprojectionSettings, Bits, Join, Quality};

gpu_struct! {
    /// How finely is looked.
    pub(crate) struct BackprojectionUniform {
        layers: u32,
        /// Smallest width of a patch on the light, as a part of the light's.
        leaf: f32,
       
    }
}

/// Shadow of a rectangular light by patches that are projected back to it.
pub struct Backprojection {
    settings: BackprojectionSettings,
    gather: Arc<ComputePipeline>,
    uniform: wgpu::Buffer,
    map: Option<DepthLayers>,
    pyramid: Option<DepthPyramid>,
    patches: Option<PatchPyramid>,
    list: Option<PenumbraList>,
}

impl Describe for Backprojection {
    type Settings = BackprojectionSettings;
    const ABOUT: About = About {
        name: "backprojection",
        title: "Layered back-projection",
        source: "Guennebaud 2006, 2007",
        summary: "x",
    };

    fn defaults(given: &Map<String, Value>) -> BackprojectionSettings {
        BackprojectionSettings::suited_to(given)
    }

    fn make(gpu: &Gpu, settings: BackprojectionSettings) -> Result<Self, Error> {
        Backprojection::with_gather(gpu, settings, "techniques::backprojection::gather")
    }
}

impl Backprojection {
    /// With the shader that gathers the patches.
    pub(crate) fn with_gather(gpu: &Gpu, settings: BackprojectionSettings, gather: &'static str) -> Result<Self, Error> {
        let key = ShaderKey::new(gather)
            .feature(settings.bits.feature(), true)
            .feature("sum", settings.join == Join::Sum)
            .feature("flat", !settings.gaps_filled)
            .with::<FrameUniform>()
            .with::<BackprojectionUniform>();
        let value = BackprojectionUniform { layers: settings.layers, leaf: 1.0 / settings.window };
        Ok(Backprojection {
            gather: gpu.compute_pipeline(&key, "gather")?,
            uniform: uniform(gpu, "backprojection", &value),
            settings,
            map: None,
            pyramid: None,
            patches: None,
            list: None,
        })
    }
}

impl Technique for Backprojection {
    fn record(&mut self, frame: &Frame, recorder: &mut Recorder) -> Result<(), Error> {
        let gpu = recorder.gpu;
        let maps = DepthLayers::of_light(&mut self.map, recorder, frame, self.settings.map, self.settings.layers, self.settings.apart)?;
        let map = &maps.nearest;
        let pyramid = DepthPyramid::ensure(&mut self.pyramid, gpu, self.settings.map);
        let list = PenumbraList::ensure(&mut self.list, gpu, frame.geometry.size);
        pyramid.record(recorder, map, frame.frustum.near)?;
        list.record(recorder, frame, map, pyramid, false)?;
        let patches = PatchPyramid::ensure(&mut self.patches, gpu, self.settings.map, self.settings.layers);
        patches.record(recorder, maps, frame.frustum.near)?;
        let set = frame.bindings(bindings! {
            depth_map: &map.texture,
            penumbra_pixels: &list.buffer,
            backprojection: &self.uniform,
            patches: &patches.patches,
        });
        recorder.compute("back-projection", &self.gather, &set, Work::Indirect(&list.buffer, 0));
        Ok(())
    }

    fn memory(&self) -> Vec<Memory> {
        let map = self.map.iter().flat_map(DepthLayers::memory);
        map.chain(self.pyramid.iter().map(DepthPyramid::memory))
            .chain(self.patches.iter().map(PatchPyramid::memory))
            .chain(self.list.iter().map(PenumbraList::memory))
            .collect()
    }
}
