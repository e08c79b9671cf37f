//! Layered back-projection: every patch of the map that rises above the receiver's plane is projected from the receiver
//! to the light, and the light's points that it covers are taken from the light [Guennebaud 2006, 2007].

use crate::input::frame::FrameUniform;
use crate::passes::pixels::classify::{Listing, PenumbraList};
use crate::passes::maps::depth_layers::DepthLayers;
use crate::passes::maps::depth_pyramid::DepthPyramid;
use crate::passes::maps::patch_pyramid::PatchPyramid;
use crate::passes::pixels::sparse::SparsePixels;
use crate::gpu::pipeline::{Binding, ComputePipeline};
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::uniform;
use crate::gpu::shader::ShaderKey;
use crate::technique::{TechniqueAbout, TechniqueFactory, InnerPicture, Memory, Technique};
use crate::error::Error;
use crate::input::frame::Frame;
use crate::gpu::device::Gpu;
use crate::{bindings, gpu_struct};
use serde_json::{Map, Value};
use std::sync::Arc;

#[cfg(test)]
mod mask;
pub mod packet;
mod settings;

pub use settings::{BackprojectionSettings, Bits, Join, Quality, Spacing};

gpu_struct! {
    /// How finely is looked.
    pub(crate) struct BackprojectionUniform {
        layers: u32,
        /// Smallest width of a patch on the light, as a part of the light's.
        leaf: f32,
        /// Pixels between those that are looked at first.
        spacing: f32,

    }
}

/// Shadow of a rectangular light by patches that are projected back to it.
pub struct Backprojection {
    settings: BackprojectionSettings,
    /// True if a workgroup looks at a tile of the picture, false if at any 64 pixels.
    by_tiles: bool,
    gather: Arc<ComputePipeline>,
    uniform: wgpu::Buffer,
    map: Option<DepthLayers>,
    pyramid: Option<DepthPyramid>,
    patches: Option<PatchPyramid>,
    list: Option<PenumbraList>,
    sparse: Option<SparsePixels>,
}

impl TechniqueFactory for Backprojection {
    type Settings = BackprojectionSettings;
    const ABOUT: TechniqueAbout = TechniqueAbout {
        name: "backprojection",
        title: "Layered back-projection",
        source: "Guennebaud 2006, 2007",
        summary: "what hides the light is projected back to it from each pixel, over several layers; nothing to tune",
    };

    fn defaults(given: &Map<String, Value>) -> BackprojectionSettings {
        BackprojectionSettings::suited_to(given)
    }

    fn make(gpu: &Gpu, settings: BackprojectionSettings) -> Result<Self, Error> {
        Backprojection::with_gather(gpu, settings, "techniques::backprojection::gather", false)
    }
}

impl Backprojection {
    /// With the shader that gathers the patches.
    pub(crate) fn with_gather(
        gpu: &Gpu,
        settings: BackprojectionSettings,
        gather: &'static str,
        by_tiles: bool,
    ) -> Result<Self, Error> {
        let key = ShaderKey::new(gather)
            .feature(settings.bits.feature(), true)
            .feature("sum", settings.join == Join::Sum)
            .feature("flat", !settings.gaps_filled)
            .feature("sparse", settings.spacing != Spacing::S1);
        let value = BackprojectionUniform {
            layers: settings.layers,
            leaf: 1.0 / settings.window,
            spacing: settings.spacing.pixels() as f32,
        };
        Ok(Backprojection {
            gather: gpu.compute_pipeline(&key, "gather")?,
            uniform: uniform(gpu, "backprojection", &value),
            settings,
            by_tiles,
            map: None,
            pyramid: None,
            patches: None,
            list: None,
            sparse: None,
        })
    }
}

impl Technique for Backprojection {
    fn record(&mut self, frame: &Frame, recorder: &mut Recorder) -> Result<(), Error> {
        let gpu = recorder.gpu;
        let maps = DepthLayers::of_light(
            &mut self.map,
            recorder,
            frame,
            self.settings.map,
            self.settings.layers,
            self.settings.apart,
        )?;
        let map = &maps.nearest;
        let list = PenumbraList::ensure(&mut self.list, gpu, frame.size);
        let pyramid = DepthPyramid::ensure(&mut self.pyramid, gpu, self.settings.map);
        let patches = PatchPyramid::ensure(&mut self.patches, gpu, self.settings.map, self.settings.layers);
        patches.record(recorder, maps, frame.frustum.near, maps.gap(frame, self.settings.apart))?;
        pyramid.record(recorder, map, frame.frustum.near)?;
        list.record(recorder, frame, map, pyramid, Listing::default())?;
        let look = |recorder: &mut Recorder, list: &PenumbraList, sharpness: &[Binding]| {
            let set = bindings! {
                depth_map: &map.texture,
                penumbra_pixels: &list.buffer,
                penumbra_tiles: &list.tiles,
                backprojection: &self.uniform,
                patches: &patches.patches,
                depth_layers: &maps.texture,
            };
            let set = frame.bindings(&[set, sharpness].concat());
            let work = if self.by_tiles { &list.tiles } else { &list.buffer };
            recorder.compute("back-projection", &self.gather, &set, Work::Indirect(work, 0));
        };
        let spacing = self.settings.spacing.pixels();
        if spacing == 1 {
            look(recorder, list, &[]);
            return Ok(());
        }
        let sparse = SparsePixels::ensure(&mut self.sparse, gpu, frame.size, spacing);
        sparse.record(recorder, frame, list, |recorder, chosen| {
            look(recorder, chosen, bindings! { sharpness: &sparse.sharpness });
        })
    }

    fn inner_pictures(&self) -> Vec<InnerPicture> {
        let map = self.map.iter().flat_map(|m| [m.nearest.inner_picture(), m.inner_picture()]);
        map.chain(self.pyramid.iter().flat_map(DepthPyramid::inner_pictures))
            .chain(self.list.iter().map(PenumbraList::inner_picture))
            .collect()
    }

    fn memory(&self) -> Vec<Memory> {
        let map = self.map.iter().flat_map(DepthLayers::memory);
        map.chain(self.pyramid.iter().map(DepthPyramid::memory))
            .chain(self.patches.iter().map(PatchPyramid::memory))
            .chain(self.list.iter().map(PenumbraList::memory))
            .chain(self.sparse.iter().map(SparsePixels::memory))
            .collect()
    }
}
