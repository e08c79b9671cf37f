//! Percentage-closer soft shadows [Fernando 2005]: search the blockers, estimate the penumbra from the light's size by
//! similar triangles, filter with that width. No constant but the light's size in metres.

use crate::frame::FrameUniform;
use crate::passes::{
    classify::{Listing, PenumbraList},
    depth_map::DepthMap,
    depth_pyramid::DepthPyramid,
    penumbra_widths::PenumbraWidths,
};
use crate::pipeline::ComputePipeline;
use crate::recorder::{Recorder, Work};
use crate::resource::uniform;
use crate::shader::ShaderKey;
use crate::technique::{About, Describe, InnerPicture, Memory, Technique};
use crate::{Error, Frame, Gpu, bindings, gpu_struct, settings::Kind};
use std::sync::Arc;

crate::settings! {
    /// Settings of [`Pcss`] and of [`SmoothPcss`](super::smooth_pcss::SmoothPcss).
    pub struct PcssSettings {
        /// Shadow map, texels a side.
        map: u32 = 2048, Kind::Integer { min: 16, max: 16384 };
        /// Widest blocker search, in nodes of the depth pyramid a side.
        search: u32 = 16, Kind::Integer { min: 2, max: 256 };
        /// Widest filter, in nodes of the depth pyramid a side.
        filter: u32 = 16, Kind::Integer { min: 2, max: 256 };
    }
}

gpu_struct! {
    /// Nodes a side.
    pub(crate) struct PcssUniform {
        search: f32,
        filter_width: f32,
    }
}

/// Shadow of a rectangular light whose penumbra widens with the distance from the occluder.
pub struct Pcss {
    antialias: bool,
    settings: PcssSettings,
    soften: Arc<ComputePipeline>,
    is_looked_at: bool,
    uniform: wgpu::Buffer,
    map: Option<DepthMap>,
    pyramid: Option<DepthPyramid>,
    list: Option<PenumbraList>,
    widths: Option<PenumbraWidths>,
}

impl Describe for Pcss {
    type Settings = PcssSettings;
    const ABOUT: About = About {
        name: "pcss",
        title: "Percentage-closer soft shadows",
        source: "Fernando 2005",
        summary: "one map; blockers are taken for a plane at their mean distance; no grain, nothing to tune",
    };

    fn make(gpu: &Gpu, settings: PcssSettings) -> Result<Self, Error> {
        Pcss::with_antialias(gpu, settings, false)
    }
}

impl Pcss {
    /// Filters over the pixel's footprint too if `antialias`.
    pub(super) fn with_antialias(gpu: &Gpu, settings: PcssSettings, antialias: bool) -> Result<Self, Error> {
        let value = PcssUniform { search: settings.search as f32, filter_width: settings.filter as f32 };
        Ok(Pcss {
            antialias,
            soften: gpu.compute_pipeline(&soften_key(antialias), "soften")?,
            is_looked_at: false,
            uniform: uniform(gpu, "pcss", &value),
            settings,
            map: None,
            pyramid: None,
            list: None,
            widths: None,
        })
    }
}

/// Search and filter.
fn soften_key(antialias: bool) -> ShaderKey {
    let key = ShaderKey::new("techniques::pcss::soften").feature("antialias", antialias);
    key.with::<FrameUniform>().with::<PcssUniform>()
}

impl Technique for Pcss {
    fn record(&mut self, frame: &Frame, recorder: &mut Recorder) -> Result<(), Error> {
        let gpu = recorder.gpu;
        let map = DepthMap::of_light(&mut self.map, recorder, frame, self.settings.map)?;
        let pyramid = DepthPyramid::ensure(&mut self.pyramid, gpu, self.settings.map);
        let list = PenumbraList::ensure(&mut self.list, gpu, frame.geometry.size);
        pyramid.record(recorder, map, frame.frustum.near)?;
        list.record(recorder, frame, map, pyramid, Listing { trust_dark: true, footprints: self.antialias })?;
        let widths = PenumbraWidths::ensure(&mut self.widths, gpu, list, self.is_looked_at);
        let mut set = frame.bindings(bindings! {
            depth_map: &map.texture,
            pyramid_bounds: &pyramid.bounds,
            pyramid_layers: &pyramid.layers,
            penumbra_pixels: &list.buffer,
            pcss: &self.uniform,
        });
        let mut soften = self.soften.clone();
        if let Some(widths) = widths {
            set.extend_from_slice(bindings! { penumbra_widths: &widths.buffer });
            soften = gpu.compute_pipeline(&soften_key(self.antialias).feature("widths", true), "soften")?;
        }
        recorder.compute("blocker search and filter", &soften, &set, Work::Indirect(&list.buffer, 0));
        Ok(())
    }

    fn look_inside(&mut self, looked_at: bool) {
        self.is_looked_at = looked_at;
    }

    fn inner_pictures(&self) -> Vec<InnerPicture> {
        let map = self.map.iter().map(DepthMap::inner_picture);
        map.chain(self.pyramid.iter().flat_map(DepthPyramid::inner_pictures))
            .chain(self.list.iter().map(PenumbraList::inner_picture))
            .chain(self.list.iter().zip(&self.widths).map(|(list, widths)| widths.inner_picture(list)))
            .collect()
    }

    fn memory(&self) -> Vec<Memory> {
        let map = self.map.iter().flat_map(DepthMap::memory);
        map.chain(self.pyramid.iter().map(DepthPyramid::memory))
            .chain(self.list.iter().map(PenumbraList::memory))
            .chain(self.widths.iter().map(PenumbraWidths::memory))
            .collect()
    }
}
