//! Gaël Guennebaud, Loïc Barthe, Mathias Paulin, 2006: Real-time soft shadow mapping by backprojection,
//! <https://doi.org/10.2312/EGWR/EGSR06/227-234>, and 2007: High-quality adaptive soft shadow mapping,
//! <https://doi.org/10.1111/j.1467-8659.2007.01075.x>.
//!
//! Every patch of the map above the receiver's plane is projected from the receiver back to the light, and hides the
//! light's sample points that it covers. Patches come from a pyramid over several depth layers.

use crate::error::Error;
use crate::gpu::bindings::Binding;
use crate::gpu::device::Gpu;
use crate::gpu::pipeline::ComputePipeline;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::uniform;
use crate::gpu::shader::ShaderKey;
use crate::input::frame::BoundFrame;
use crate::passes::maps::depth_layers::DepthLayers;
use crate::passes::maps::depth_pyramid::DepthPyramid;
use crate::passes::maps::patch_pyramid::patch_pyramid;
use crate::passes::pixels::classify::{Listing, PenumbraList};
use crate::passes::pixels::sparse::shade_sparsely;
use crate::technique::{Description, Technique, TechniqueFactory};
use crate::{bindings, gpu_struct};
use serde_json::{Map, Value};
use std::sync::Arc;

#[cfg(test)]
mod mask;
pub mod packet;
mod settings;

pub use settings::{BackprojectionSettings, Bits, Join, Quality, Spacing};

gpu_struct! {
    /// Resolution of the light.
    pub(crate) struct BackprojectionUniform {
        layers: u32,
        /// Smallest width of a patch on the light, as a fraction of the light's.
        leaf: f32,
        /// Spacing of the pixels that are shaded first.
        spacing: f32,
    }
}

/// Shadow of a rectangular light by patches that are projected back to it.
pub struct Backprojection {
    settings: BackprojectionSettings,
    /// True if a workgroup shades a tile of the image, false if it shades any 64 pixels.
    by_tiles: bool,
    gather: Arc<ComputePipeline>,
    uniform: wgpu::Buffer,
}

impl TechniqueFactory for Backprojection {
    type Settings = BackprojectionSettings;
    type Technique = Backprojection;
    const DESCRIPTION: Description = Description {
        name: "backprojection",
        title: "Layered back-projection",
        source: "Guennebaud 2006, 2007",
        summary: "each pixel projects the occluders of several depth layers back to the light; nothing to tune",
    };

    fn defaults(given: &Map<String, Value>) -> BackprojectionSettings {
        BackprojectionSettings::suited_to(given)
    }

    fn make(gpu: &Gpu, settings: BackprojectionSettings) -> Result<Backprojection, Error> {
        Backprojection::new(gpu, settings, false)
    }
}

impl Backprojection {
    fn new(gpu: &Gpu, settings: BackprojectionSettings, by_tiles: bool) -> Result<Backprojection, Error> {
        let module = if by_tiles { "techniques::backprojection::packet" } else { "techniques::backprojection::gather" };
        let key = ShaderKey::new(module)
            .feature(settings.bits.feature(), true)
            .feature("sum", settings.join == Join::Sum)
            .feature("flat", !settings.gaps_filled)
            .feature("sparse", settings.spacing != Spacing::S1);
        let value = BackprojectionUniform {
            layers: settings.layers,
            leaf: 1.0 / settings.window,
            spacing: settings.spacing.pixels() as f32,
        };
        let gather = gpu.compute_pipeline(&key, "gather")?;
        Ok(Backprojection { settings, by_tiles, gather, uniform: uniform(gpu, "backprojection", &value) })
    }
}

impl Technique for Backprojection {
    fn record(&mut self, frame: &BoundFrame, recorder: &mut Recorder) -> Result<(), Error> {
        let BackprojectionSettings { map, layers, apart, spacing, .. } = self.settings;
        let near = frame.frustum.near;
        let maps = DepthLayers::of_light(recorder, frame, map, layers, apart)?;
        let patches = patch_pyramid(recorder, &maps, near)?;
        let pyramid = DepthPyramid::record(recorder, &maps.nearest, near)?;
        let list = PenumbraList::record(recorder, frame, &maps.nearest, &pyramid, Listing::default())?;
        let own = bindings! {
            depth_map: &maps.nearest.texture,
            backprojection: &self.uniform,
            patches: &patches,
            depth_layers: &maps.texture,
        };
        let gather = |recorder: &mut Recorder, work: &wgpu::Buffer, pixels: &[Binding]| {
            let set = [&frame.bindings()[..], own, pixels];
            recorder.compute("back-projection", &self.gather, &set, Work::Indirect(work, 0))
        };
        let (spacing, work) = (spacing.pixels(), if self.by_tiles { &list.tiles } else { &list.buffer });
        if spacing == 1 {
            return gather(recorder, work, bindings! { penumbra_pixels: &list.buffer, penumbra_tiles: &list.tiles });
        }
        shade_sparsely(recorder, frame, &list, spacing, |recorder, chosen, sharpness| {
            gather(recorder, chosen, bindings! { penumbra_pixels: chosen, sharpness: sharpness })
        })
    }
}
