//! William Reeves, David Salesin, Robert Cook, 1987: Rendering antialiased shadows with depth maps,
//! <https://doi.org/10.1145/37402.37435>.
//!
//! Percentage-closer filtering: the results of the comparison are filtered, not the depths.

use crate::error::Error;
use crate::gpu::device::Gpu;
use crate::gpu::pipeline::ComputePipeline;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::uniform;
use crate::gpu::shader::ShaderKey;
use crate::input::frame::BoundFrame;
use crate::passes::maps::depth_map::DepthMap;
use crate::technique::settings::Kind;
use crate::technique::{Description, Technique, TechniqueFactory};
use crate::{bindings, gpu_struct};
use std::sync::Arc;

crate::choices! {
    /// Kind of a lookup.
    pub enum Lookup {
        /// The texel that the position falls into.
        Nearest = "nearest",
        /// The sampler's own comparison of 2 x 2 texels, interpolated.
        Hardware = "hardware",
        /// 2 x 2 texels compared with the receiver's plane at each of them, interpolated.
        Bilinear = "bilinear",
    }
}

crate::settings! {
    /// Settings of [`Pcf`].
    pub struct PcfSettings {
        /// Shadow map, texels per side.
        map: u32 = 2048, Kind::Integer { min: 16, max: 16384 };
        /// Width of the Gaussian kernel in lookups per side; 1 is a single lookup.
        pcf: u32 = 5, Kind::Integer { min: 1, max: 33 };
        /// One lookup: the nearest texel, the sampler's 2 x 2 comparison, or 2 x 2 compared with the receiver's plane.
        lookup: Lookup = Lookup::Bilinear, Kind::Choice { options: Lookup::OPTIONS };
    }
}

gpu_struct! {
    /// The kernel.
    pub(crate) struct PcfUniform {
        /// Lookups per side.
        side: i32,
        /// Of the Gaussian, in texels.
        deviation: f32,
        /// From the first lookup to the middle of the kernel, in texels.
        shift: f32,
    }
}

/// Shadow of the light's centre with filtered edges of a constant width in texels.
pub struct Pcf {
    settings: PcfSettings,
    filter: Arc<ComputePipeline>,
    kernel: wgpu::Buffer,
    comparison: wgpu::Sampler,
}

impl TechniqueFactory for Pcf {
    type Settings = PcfSettings;
    type Technique = Pcf;
    const DESCRIPTION: Description = Description {
        name: "pcf",
        title: "Percentage-closer filtering",
        source: "Reeves et al. 1987",
        summary: "filtered comparisons; edges as soft as the kernel is wide, whatever the light's size",
    };

    fn make(gpu: &Gpu, settings: PcfSettings) -> Result<Pcf, Error> {
        let key = ShaderKey::new("techniques::shadow_map::pcf::filter")
            .feature("hardware", settings.lookup == Lookup::Hardware)
            .feature("bilinear", settings.lookup == Lookup::Bilinear);
        let n = settings.pcf as i32;
        // The kernel ends at two standard deviations.
        let value = PcfUniform { side: n, deviation: (n as f32 / 4.0).max(0.25), shift: 0.5 * (n - 1) as f32 };
        Ok(Pcf {
            filter: gpu.compute_pipeline(&key, "filter_pixels")?,
            kernel: uniform(gpu, "pcf kernel", &value),
            comparison: gpu.device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("shadow comparison"),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                compare: Some(wgpu::CompareFunction::GreaterEqual),
                ..Default::default()
            }),
            settings,
        })
    }
}

impl Technique for Pcf {
    fn record(&mut self, frame: &BoundFrame, recorder: &mut Recorder) -> Result<(), Error> {
        let map = DepthMap::of_light(recorder, frame, self.settings.map)?;
        let own = bindings! { depth_map: &map.texture, comparison: &self.comparison, kernel: &self.kernel };
        let set = [&frame.bindings()[..], own];
        recorder.compute("percentage-closer filter", &self.filter, &set, Work::Pixels(frame.size))
    }
}
