//! Prefiltered shadow maps: the values stored of a texel's depths are blurred, given a mip chain, and looked up once
//! per pixel with trilinear and anisotropic filtering. A technique defines the stored values and how filtered ones are
//! read, in a module `warp.wesl` of two functions.

use crate::error::Error;
use crate::gpu::device::Gpu;
use crate::gpu::pipeline::ComputePipeline;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::uniform;
use crate::gpu::shader::ShaderKey;
use crate::input::frame::BoundFrame;
use crate::passes::maps::moments::{DepthWarp, MomentMap, MomentShape, Nearest, TexelFormat};
use crate::technique::settings::Settings;
use crate::technique::{Description, Technique, TechniqueFactory};
use crate::{bindings, gpu_struct};
use glam::Vec2;
use std::{marker::PhantomData, sync::Arc};

/// The differences between prefiltered techniques.
pub trait Prefilter: 'static {
    /// Its settings, declared by [`prefilter_settings!`](crate::prefilter_settings!).
    type Settings: Settings + HasFiltering;
    /// Its description.
    const DESCRIPTION: Description;
    /// Path of its `warp.wesl` below `src`.
    const WARP: &'static str;

    /// The stored values for these settings.
    fn stored(settings: &Self::Settings) -> Stored;
}

/// The values that a technique stores of each texel.
#[derive(Clone, Copy, Debug)]
pub struct Stored {
    /// Format of a layer.
    pub format: TexelFormat,
    /// A format of the technique that every adapter stores.
    pub portable: &'static str,
    /// Layers of four channels.
    pub layers: u32,
    /// The numbers that the warp takes, without the range of depths.
    pub warp: DepthWarp,
}

crate::choices! {
    /// Where filtering is done.
    pub enum Lookup {
        /// The sampler where the adapter can, the shader elsewhere.
        Hardware = "hardware",
        /// The shader.
        Shader = "shader",
    }
}

/// The settings that every prefiltered technique has.
#[derive(Clone, Copy, Debug)]
pub struct Filtering {
    /// Texels per side.
    pub map: u32,
    /// Four depths per texel.
    pub multisample: bool,
    /// Width of the Gaussian, texels.
    pub blur: u32,
    /// A mip chain.
    pub mips: bool,
    /// Greatest ratio of a footprint's axes.
    pub anisotropy: u32,
    /// Where filtering is done.
    pub lookup: Lookup,
}

/// Settings with those of filtering among them.
pub trait HasFiltering {
    /// The shared settings.
    fn filtering(&self) -> Filtering;
}

/// Declares the settings of a prefiltered technique: those of filtering, then its own, as in
/// `settings!`.
#[macro_export]
macro_rules! prefilter_settings {
    ($(#[$meta:meta])* $vis:vis struct $name:ident { $($own:tt)* }) => {
        $crate::settings! {
            $(#[$meta])*
            $vis struct $name {
                /// Shadow map, texels per side.
                map: u32 = 2048, $crate::technique::settings::Kind::Integer { min: 16, max: 16384 };
                /// Four depths per texel, whose stored values are averaged.
                multisample: bool = false, $crate::technique::settings::Kind::Toggle;
                /// Width of a Gaussian blur of the map in texels, an even one counting as the next odd one; 1 is none.
                blur: u32 = 3, $crate::technique::settings::Kind::Integer { min: 1, max: 63 };
                /// Mip chain, for pixels that cover many texels.
                mips: bool = true, $crate::technique::settings::Kind::Toggle;
                /// Greatest anisotropy of the filter; 1 is none, and so is any without a mip chain.
                anisotropy: u32 = 16, $crate::technique::settings::Kind::Integer { min: 1, max: 16 };
                /// Filtering by the sampler (by the shader where the adapter cannot), or by the shader.
                lookup: $crate::techniques::moments::prefiltered::Lookup = $crate::techniques::moments::prefiltered::Lookup::Hardware,
                    $crate::technique::settings::Kind::Choice { options: $crate::techniques::moments::prefiltered::Lookup::OPTIONS };
                $($own)*
            }
        }

        impl $crate::techniques::moments::prefiltered::HasFiltering for $name {
            fn filtering(&self) -> $crate::techniques::moments::prefiltered::Filtering {
                $crate::techniques::moments::prefiltered::Filtering {
                    map: self.map,
                    multisample: self.multisample,
                    blur: self.blur,
                    mips: self.mips,
                    anisotropy: self.anisotropy,
                    lookup: self.lookup,
                }
            }
        }
    };
}

gpu_struct! {
    /// Filtering of a moment map; see `shaders/moment_map.wesl`.
    pub(crate) struct FilterUniform {
        /// Texels per side.
        size: Vec2,
        /// Greatest ratio of a footprint's axes.
        anisotropy: f32,
        /// Coarsest level of the mip chain.
        last_level: f32,
        /// Layers of the map.
        layers: u32,
    }
}

/// A technique with one lookup of a prefiltered map per pixel.
pub struct Prefiltered<P: Prefilter> {
    stored: Stored,
    shape: MomentShape,
    lookup: Arc<ComputePipeline>,
    filtering: wgpu::Buffer,
    trilinear: wgpu::Sampler,
    technique: PhantomData<fn() -> P>,
}

impl<P: Prefilter> TechniqueFactory for Prefiltered<P> {
    type Settings = P::Settings;
    type Technique = Prefiltered<P>;
    const DESCRIPTION: Description = P::DESCRIPTION;

    fn make(gpu: &Gpu, settings: P::Settings) -> Result<Prefiltered<P>, Error> {
        let (filtering, stored) = (settings.filtering(), P::stored(&settings));
        stored.format.check(gpu, stored.portable)?;
        // Without a mip chain, anisotropic lookups save nothing.
        let anisotropy = if filtering.mips { filtering.anisotropy } else { 1 };
        let filtered = stored.format.is_filtered(gpu) && (anisotropy == 1 || gpu.capabilities.anisotropic_filtering);
        let hardware = filtering.lookup == Lookup::Hardware && filtered;
        let key = ShaderKey::new("techniques::moments::prefiltered::lookup")
            .part("warp", P::WARP)
            .feature("hardware", hardware)
            .feature("split", stored.format.is_split());
        let shape = MomentShape {
            size: filtering.map,
            layers: stored.layers,
            format: stored.format,
            samples: if filtering.multisample { 4 } else { 1 },
            blur: filtering.blur | 1,
            mips: filtering.mips,
        };
        let last_level = if filtering.mips { filtering.map.ilog2() as f32 } else { 0.0 };
        let value = FilterUniform {
            size: Vec2::splat(filtering.map as f32),
            anisotropy: anisotropy as f32,
            last_level,
            layers: stored.layers,
        };
        Ok(Prefiltered {
            lookup: gpu.compute_pipeline(&key, "lookup")?,
            filtering: uniform(gpu, "moment filter", &value),
            trilinear: sampler(gpu, anisotropy as u16, last_level),
            stored,
            shape,
            technique: PhantomData,
        })
    }
}

fn sampler(gpu: &Gpu, anisotropy: u16, last_level: f32) -> wgpu::Sampler {
    gpu.device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("moment filter"),
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        lod_max_clamp: last_level,
        anisotropy_clamp: anisotropy,
        ..Default::default()
    })
}

impl<P: Prefilter> Technique for Prefiltered<P> {
    fn record(&mut self, frame: &BoundFrame, recorder: &mut Recorder) -> Result<(), Error> {
        let warp = self.stored.warp.over(frame, Nearest::Receiver);
        let map = MomentMap::record(recorder, frame, self.shape, P::WARP, warp)?;
        let own = bindings! {
            warp: &map.warp,
            moments: &map.texture,
            filtering: &self.filtering,
            trilinear: &self.trilinear,
        };
        recorder.compute("filtered lookup", &self.lookup, &[&frame.bindings(), own], Work::Pixels(frame.size))
    }
}
