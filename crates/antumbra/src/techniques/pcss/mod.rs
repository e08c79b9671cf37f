//! Randima Fernando, 2005: Percentage-closer soft shadows, <https://doi.org/10.1145/1187112.1187153>.
//!
//! A blocker search, an estimate of the penumbra from the light's size by similar triangles, a filter of that width. No
//! constant but the light's size in metres.
//!
//! Li Shen, Gaël Guennebaud, Baoguang Yang, Jieqing Feng, 2011: Predicted virtual soft shadow maps with high quality
//! filtering, section 4, <https://doi.org/10.1111/j.1467-8659.2011.01875.x>.
//!
//! `smooth-pcss` filters over the convolution of the light's window, seen through the blockers, with the pixel's, seen
//! through the receiver's plane: soft and hard transitions are filtered alike, also where many texels fall into a
//! pixel.

use crate::error::Error;
use crate::gpu::device::Gpu;
use crate::gpu::pipeline::ComputePipeline;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::uniform;
use crate::gpu::shader::ShaderKey;
use crate::input::frame::BoundFrame;
use crate::passes::maps::depth_map::DepthMap;
use crate::passes::maps::depth_pyramid::DepthPyramid;
use crate::passes::pixels::classify::{Listing, PenumbraList};
use crate::passes::pixels::penumbra_widths::penumbra_widths;
use crate::technique::settings::Kind;
use crate::technique::{Description, Technique, TechniqueFactory};
use crate::{bindings, gpu_struct};
use std::sync::Arc;

crate::settings! {
    /// Settings of [`Pcss`] and [`SmoothPcss`].
    pub struct PcssSettings {
        /// Shadow map, texels per side.
        map: u32 = 2048, Kind::Integer { min: 16, max: 16384 };
        /// Widest blocker search, in nodes of the depth pyramid per side.
        search: u32 = 16, Kind::Integer { min: 2, max: 256 };
        /// Widest filter, in nodes of the depth pyramid per side.
        filter: u32 = 16, Kind::Integer { min: 2, max: 256 };
    }
}

gpu_struct! {
    /// Nodes per side.
    pub(crate) struct PcssUniform {
        search: f32,
        filter_width: f32,
    }
}

/// Shadow of a rectangular light whose penumbra widens with the distance from the occluder.
pub struct Pcss {
    settings: PcssSettings,
    antialias: bool,
    uniform: wgpu::Buffer,
    soften: Arc<ComputePipeline>,
}

/// [`Pcss`] over the pixel's footprint.
pub struct SmoothPcss;

impl TechniqueFactory for Pcss {
    type Settings = PcssSettings;
    type Technique = Pcss;
    const DESCRIPTION: Description = Description {
        name: "pcss",
        title: "Percentage-closer soft shadows",
        source: "Fernando 2005",
        summary: "one map; blockers are taken for a plane at their mean distance; no grain, nothing to tune",
    };

    fn make(gpu: &Gpu, settings: PcssSettings) -> Result<Pcss, Error> {
        Pcss::new(gpu, settings, false)
    }
}

impl TechniqueFactory for SmoothPcss {
    type Settings = PcssSettings;
    type Technique = Pcss;
    const DESCRIPTION: Description = Description {
        name: "smooth-pcss",
        title: "Percentage-closer soft shadows, antialiased",
        source: "Shen 2011, section 4",
        summary: "pcss over the pixel's footprint on the map: hard transitions and far shadows are smooth too",
    };

    fn make(gpu: &Gpu, settings: PcssSettings) -> Result<Pcss, Error> {
        Pcss::new(gpu, settings, true)
    }
}

impl Pcss {
    fn new(gpu: &Gpu, settings: PcssSettings, antialias: bool) -> Result<Pcss, Error> {
        let value = PcssUniform { search: settings.search as f32, filter_width: settings.filter as f32 };
        let soften = gpu.compute_pipeline(&soften_key(antialias), "soften")?;
        Ok(Pcss { settings, antialias, uniform: uniform(gpu, "pcss", &value), soften })
    }
}

/// Blocker search and filter.
fn soften_key(antialias: bool) -> ShaderKey {
    ShaderKey::new("techniques::pcss::soften").feature("antialias", antialias)
}

impl Technique for Pcss {
    fn record(&mut self, frame: &BoundFrame, recorder: &mut Recorder) -> Result<(), Error> {
        let map = DepthMap::of_light(recorder, frame, self.settings.map)?;
        let pyramid = DepthPyramid::record(recorder, &map, frame.frustum.near)?;
        let listing = Listing { trust_dark: true, footprints: self.antialias };
        let list = PenumbraList::record(recorder, frame, &map, &pyramid, listing)?;
        let own = bindings! {
            depth_map: &map.texture,
            pyramid_bounds: &pyramid.bounds,
            pyramid_layers: &pyramid.layers,
            penumbra_pixels: &list.buffer,
            pcss: &self.uniform,
        };
        let (label, work) = ("blocker search and filter", Work::Indirect(&list.buffer, 0));
        let Some(widths) = penumbra_widths(recorder, &list) else {
            return recorder.compute(label, &self.soften, &[&frame.bindings(), own], work);
        };
        let key = soften_key(self.antialias).feature("widths", true);
        let soften = recorder.gpu.compute_pipeline(&key, "soften")?;
        recorder.compute(label, &soften, &[&frame.bindings(), own, bindings! { penumbra_widths: &widths }], work)
    }
}
