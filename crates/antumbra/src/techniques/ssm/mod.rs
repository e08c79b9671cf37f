//! Lionel Atty, Nicolas Holzschuch, Marc Lapierre, Jean-Marc Hasenfratz, Charles Hansen, François Sillion, 2006: Soft
//! shadow maps: efficient sampling of light source visibility, <http://maverick.inria.fr/Publications/2006/AHLHHS06/>.
//!
//! The texels of an occluder map are micro-patches. Each adds its soft shadow to a map of the receivers, which is
//! projected on the image.

mod accumulate;
mod maps;
pub(crate) mod patches;
#[cfg(test)]
mod penumbra;
mod settings;
mod warnings;

use crate::bindings;
use crate::error::Error;
use crate::gpu::device::Gpu;
use crate::gpu::pipeline::ComputePipeline;
use crate::gpu::readback::read_buffer;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::shader::ShaderKey;
use crate::gpu::texture::Texture;
use crate::input::frame::BoundFrame;
use crate::technique::{Description, StatsFuture, Technique, TechniqueFactory};
use accumulate::soft_shadow_map;
use maps::Maps;
use patches::Patches;
use std::sync::Arc;

pub use settings::{Accumulate, Format, SsmSettings};
pub use warnings::largest_float16_q;

/// Soft shadows of occluders on receivers, computed in a map from the light and projected on the image.
pub struct Ssm {
    settings: SsmSettings,
    project: Arc<ComputePipeline>,
    /// Maps of the last frame.
    last: Option<SsmMaps>,
    /// Warnings so far.
    warned: Vec<String>,
}

/// The maps of a frame, `map` x `map` texels over its frustum, row 0 at the smallest y.
pub struct SsmMaps {
    /// `R32Float`: the fraction of the light that is hidden from the receiver at each texel.
    pub soft_shadow: Texture,
    /// `Depth32Float`: `near / z` of the receivers, 0 where there is none.
    pub receivers: Texture,
    /// `Depth32Float`: `near / z` of the nearest occluders, 0 where there is none.
    pub occluders: Texture,
    totals: wgpu::Buffer,
}

impl TechniqueFactory for Ssm {
    type Settings = SsmSettings;
    type Technique = Ssm;
    const DESCRIPTION: Description = Description {
        name: "ssm",
        title: "Soft shadow maps",
        source: "Atty 2006",
        summary: "each texel of an occluder map casts the soft shadow of a small rectangle; occluders receive no shadow",
    };

    fn make(gpu: &Gpu, settings: SsmSettings) -> Result<Ssm, Error> {
        gpu.check_size("shadow map", settings.map, settings.map)?;
        let project = gpu.compute_pipeline(&ShaderKey::new("techniques::ssm::project"), "project")?;
        Ok(Ssm { settings: blendable(gpu, settings), project, last: None, warned: Vec::new() })
    }
}

/// Gathers where the adapter cannot blend 32-bit floats.
fn blendable(gpu: &Gpu, settings: SsmSettings) -> SsmSettings {
    let blends = settings.accumulate == Accumulate::Blend && settings.format == Format::Float32;
    if blends && !gpu.capabilities.float32_blending {
        tracing::warn!("ssm: this adapter does not blend 32-bit floats; accumulate=gather replaces blend");
        return SsmSettings { accumulate: Accumulate::Gather, ..settings };
    }
    settings
}

impl Ssm {
    /// The maps of the last frame; none before the first.
    pub fn maps(&self) -> Option<&SsmMaps> {
        self.last.as_ref()
    }

    /// Warns once of each fault that the image of this frame will have.
    fn warn(&mut self, frame: &BoundFrame) {
        for sentence in warnings::of_frame(frame, &self.settings) {
            if !self.warned.contains(&sentence) {
                tracing::warn!("{sentence}");
                self.warned.push(sentence);
            }
        }
    }
}

impl Technique for Ssm {
    fn record(&mut self, frame: &BoundFrame, recorder: &mut Recorder) -> Result<(), Error> {
        self.warn(frame);
        let maps = Maps::record(recorder, frame, self.settings.map, self.settings.passes)?;
        let patches = Patches::record(recorder, frame, &self.settings, &maps)?;
        let soft_shadow = soft_shadow_map(recorder, frame, &self.settings, &maps, &patches)?;
        let set = [&frame.bindings()[..], &patches.bindings(&maps), bindings! { soft: &soft_shadow }];
        recorder.compute("projection", &self.project, &set, Work::Pixels(frame.size))?;
        let (receivers, occluders) = (maps.receivers.texture, maps.nearest.texture);
        self.last = Some(SsmMaps { soft_shadow, receivers, occluders, totals: patches.totals });
        Ok(())
    }

    /// Patches, those that float16 loses, and the widest penumbra in texels of its level.
    fn stats<'a>(&'a self, gpu: &'a Gpu) -> StatsFuture<'a> {
        Box::pin(async move {
            let Some(last) = &self.last else { return Ok(Vec::new()) };
            let words: Vec<u32> = bytemuck::pod_collect_to_vec(&read_buffer(gpu, &last.totals).await?);
            let (patches, lost, widest) = (words[32], words[33], f32::from_bits(words[34]));
            Ok(vec![("patches", patches.into()), ("float16 loses", lost.into()), ("widest penumbra", widest.into())])
        })
    }
}
