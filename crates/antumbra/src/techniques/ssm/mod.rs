//! Soft shadow maps: the texels of an occluder map are micro-patches, and each adds its soft shadow to a map of the
//! receivers [Atty 2006].

mod accumulate;
mod caution;
mod maps;
pub(crate) mod patches;
#[cfg(test)]
mod penumbra;
mod settings;

use crate::gpu::pipeline::ComputePipeline;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::texture::Texture;
use crate::technique::{TechniqueAbout, TechniqueFactory, StatsFuture, InnerPicture, Memory, Technique};
use crate::error::Error;
use crate::input::frame::Frame;
use crate::gpu::device::Gpu;
use crate::bindings;
use accumulate::SoftMap;
use maps::Maps;
use patches::Patches;
use std::sync::Arc;

pub use caution::largest_float16_q;
pub use settings::{Accumulate, Format, SsmSettings};

/// Soft shadows of occluders on receivers, made in the light's own map and projected on the scene.
pub struct Ssm {
    settings: SsmSettings,
    project: Arc<ComputePipeline>,
    patches: Patches,
    soft: SoftMap,
    maps: Option<Maps>,
    /// What has been said already.
    said: Vec<String>,
}

impl TechniqueFactory for Ssm {
    type Settings = SsmSettings;
    const ABOUT: TechniqueAbout = TechniqueAbout {
        name: "ssm",
        title: "Soft shadow maps",
        source: "Atty 2006",
        summary: "each texel of an occluder map casts the soft shadow of a small rectangle; occluders take no shadow",
    };

    fn make(gpu: &Gpu, settings: SsmSettings) -> Result<Self, Error> {
        gpu.check_size("shadow map", settings.map, settings.map)?;
        let settings = blendable(gpu, settings);
        let key = Patches::key("techniques::ssm::project");
        let patches = Patches::new(gpu, &settings);
        Ok(Ssm {
            project: gpu.compute_pipeline(&key, "project")?,
            soft: SoftMap::new(gpu, &settings, &patches),
            patches,
            maps: None,
            said: Vec::new(),
            settings,
        })
    }
}

/// Where the adapter cannot blend 32-bit floats, texels gather.
fn blendable(gpu: &Gpu, settings: SsmSettings) -> SsmSettings {
    let blends = settings.accumulate == Accumulate::Blend && settings.format == Format::Float32;
    if blends && !gpu.capabilities.float32_blending {
        tracing::warn!("ssm: this adapter does not blend 32-bit floats; accumulate=gather takes the place of blend");
        return SsmSettings { accumulate: Accumulate::Gather, ..settings };
    }
    settings
}

impl Ssm {
    /// `R32Float`, `map` x `map` texels over the frame's frustum, row 0 at its smallest y: the part of the light that
    /// is hidden from the receiver at each texel. Filled by `record`.
    pub fn soft_shadow_map(&self) -> &Texture {
        &self.soft.merged
    }

    /// `Depth32Float`, of the same size: `near / z` of the receivers, 0 where there is none. None before the first
    /// frame.
    pub fn receiver_map(&self) -> Option<&Texture> {
        self.maps.as_ref().map(|maps| &maps.receivers.texture)
    }

    /// `Depth32Float`, of the same size: `near / z` of the nearest occluders, 0 where there is none. None before the
    /// first frame.
    pub fn occluder_map(&self) -> Option<&Texture> {
        self.maps.as_ref().map(|maps| &maps.nearest.texture)
    }

    /// Says once what makes a picture of this frame wrong.
    fn caution(&mut self, frame: &Frame) {
        for sentence in caution::of_frame(frame, &self.settings) {
            if !self.said.contains(&sentence) {
                tracing::warn!("{sentence}");
                self.said.push(sentence);
            }
        }
    }
}

impl Technique for Ssm {
    fn record(&mut self, frame: &Frame, recorder: &mut Recorder) -> Result<(), Error> {
        self.caution(frame);
        let SsmSettings { map, passes, .. } = self.settings;
        let maps = Maps::ensure(&mut self.maps, recorder.gpu, map, passes, &frame.casters)?;
        maps.record(recorder, frame)?;
        self.patches.record(recorder, frame, maps)?;
        self.soft.record(recorder, frame, maps, &self.patches)?;

        let mut set = self.patches.bindings(frame, &maps.receivers);
        set.extend_from_slice(bindings! { soft: &self.soft.merged });
        let [width, height] = frame.size;
        recorder.compute("projection", &self.project, &frame.bindings(&set), Work::Threads([width, height, 1]));
        Ok(())
    }

    fn inner_pictures(&self) -> Vec<InnerPicture> {
        let maps = self.maps.iter().flat_map(Maps::inner_pictures);
        maps.chain([self.patches.inner_picture()]).chain(self.soft.inner_pictures()).collect()
    }

    fn memory(&self) -> Vec<Memory> {
        let maps = self.maps.iter().flat_map(Maps::memory);
        maps.chain(self.patches.memory()).chain(self.soft.memory()).collect()
    }

    fn stats<'a>(&'a self, gpu: &'a Gpu) -> StatsFuture<'a> {
        Box::pin(self.patches.stats(gpu))
    }
}
