//! Alias-free shadow maps: the exact hard shadow at the middle of every pixel [Aila, Laine 2004; Sintorn 2008].
//!
//! Pixels are put into lists, one for each texel that the light's centre sees them through, and each triangle is tested
//! against the pixels of the texels that it touches. The map only groups the work: whatever its resolution, the picture is
//! the same.

use crate::input::frame::FrameUniform;
use crate::passes::lists::texel_lists::TexelLists;
use crate::passes::triangles::triangle_pairs::{Look, TrianglePairs};
use crate::gpu::pipeline::ComputePipeline;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::{UniformArray, storage_buffer};
use crate::gpu::shader::{Needs, ShaderKey};
use crate::technique::{TechniqueAbout, TechniqueFactory, StatsFuture, InnerPicture, Memory, Technique};
use crate::error::Error;
use crate::input::frame::Frame;
use crate::gpu::device::Gpu;
use crate::{bindings, gpu_struct};
use crate::technique::settings::Kind;
use std::sync::Arc;

mod supersampling;

use supersampling::SubPixels;

crate::settings! {
    /// Settings of [`AliasFree`].
    pub struct AliasFreeSettings {
        /// Texels a side of the map that pixels are listed in; it has no bearing on the picture.
        map: u32 = 512, Kind::Integer { min: 16, max: 4096 };
        /// Points a pixel: the first is its middle, others are drawn and shadowed anew by brute force.
        samples: u32 = 1, Kind::Integer { min: 1, max: 128 };
        /// Memory for pairs of triangles and texels, MiB; a frame that needs more takes longer.
        budget: u32 = 256, Kind::Integer { min: 0, max: 4096 };
    }
}

gpu_struct! {
    /// Which of a pixel's points is looked at.
    pub(crate) struct SampleUniform {
        index: u32,
        count: u32,
    }
}

/// Exact shadow of the light's centre.
pub struct AliasFree {
    settings: AliasFreeSettings,
    resolve: Arc<ComputePipeline>,
    samples: UniformArray<SampleUniform>,
    lists: Option<TexelLists>,
    pairs: Option<TrianglePairs>,
    pixels: Option<Pixels>,
    sub_pixels: Option<SubPixels>,
}

/// What is known of each pixel.
struct Pixels {
    size: [u32; 2],
    /// Position in light space and its error.
    receivers: wgpu::Buffer,
    /// 1 where the light's centre is hidden.
    hidden: wgpu::Buffer,
}

impl Pixels {
    fn ensure<'a>(slot: &'a mut Option<Pixels>, gpu: &Gpu, size: [u32; 2]) -> &'a Pixels {
        if slot.as_ref().is_none_or(|p| p.size != size) {
            let buffer =
                |label, bytes: u64| storage_buffer(gpu, label, u64::from(size[0]) * u64::from(size[1]) * bytes);
            *slot = Some(Pixels { size, receivers: buffer("receivers", 16), hidden: buffer("hidden pixels", 4) });
        }
        slot.as_ref().expect("just made")
    }
}

impl TechniqueFactory for AliasFree {
    type Settings = AliasFreeSettings;
    const ABOUT: TechniqueAbout = TechniqueAbout {
        name: "alias-free",
        title: "Alias-free shadow map",
        source: "Aila 2004, Sintorn 2008",
        summary: "the exact hard shadow of every pixel: triangles against lists of pixels; the light is a point at its centre",
    };

    // Lists, pairs and receivers, and for surfaces with holes the host's triangles.
    const NEEDS: Needs = Needs { storage_buffers: 9, ..Needs::CORE };

    fn make(gpu: &Gpu, settings: AliasFreeSettings) -> Result<Self, Error> {
        let key = ShaderKey::new("techniques::alias_free::hard::resolve");
        let count = settings.samples;
        let samples: Vec<_> = (0..count).map(|index| SampleUniform { index, count }).collect();
        Ok(AliasFree {
            resolve: gpu.compute_pipeline(&key, "resolve")?,
            samples: UniformArray::new(gpu, "samples", &samples),
            settings,
            lists: None,
            pairs: None,
            pixels: None,
            sub_pixels: None,
        })
    }
}

impl AliasFree {
    /// The shadow at one point of every pixel.
    fn record_sample(&mut self, frame: &Frame, recorder: &mut Recorder, index: u32) -> Result<(), Error> {
        let gpu = recorder.gpu;
        let [width, height] = frame.size;
        let pixels = Pixels::ensure(&mut self.pixels, gpu, frame.size);
        let lists = TexelLists::ensure(&mut self.lists, gpu, self.settings.map, width * height);
        let receivers = bindings! { receivers: &pixels.receivers };
        lists.record(recorder, frame, TexelLists::key("techniques::alias_free::hard::listed"), receivers)?;
        let parts = TrianglePairs::parts(frame, lists);
        let budget = u64::from(self.settings.budget) << 20;
        let pairs = TrianglePairs::ensure(&mut self.pairs, gpu, &parts, budget);
        recorder.encoder.clear_buffer(&pixels.hidden, 0, None);
        let look = Look {
            key: TrianglePairs::key("techniques::alias_free::hard::pair"),
            bindings: bindings! { receivers: &pixels.receivers, hidden: &pixels.hidden },
            label: "shadow tests",
        };
        pairs.record(recorder, frame, lists, &parts, &look)?;
        let sample = self.samples.at(index);
        let set = frame.bindings(bindings! { hidden: &pixels.hidden, sample: &sample });
        recorder.compute("visibility", &self.resolve, &set, Work::Threads([width, height, 1]));
        Ok(())
    }
}

impl Technique for AliasFree {
    fn record(&mut self, frame: &Frame, recorder: &mut Recorder) -> Result<(), Error> {
        self.record_sample(frame, recorder, 0)?;
        if self.settings.samples > 1 {
            let mut sub_pixels =
                SubPixels::updated(self.sub_pixels.take(), recorder.gpu, frame, self.settings.samples)?;
            for index in 1..self.settings.samples {
                let moved = sub_pixels.record(recorder, frame, index)?;
                self.record_sample(moved, recorder, index)?;
            }
            self.sub_pixels = Some(sub_pixels);
        }
        Ok(())
    }

    fn inner_pictures(&self) -> Vec<InnerPicture> {
        self.lists.iter().map(TexelLists::inner_picture).collect()
    }

    fn memory(&self) -> Vec<Memory> {
        let pixels =
            self.pixels.iter().map(|p| Memory::new("lists of receivers", p.receivers.size() + p.hidden.size()));
        pixels
            .chain(self.lists.iter().map(TexelLists::memory))
            .chain(self.pairs.iter().flat_map(TrianglePairs::memory))
            .chain(self.sub_pixels.iter().map(SubPixels::memory))
            .collect()
    }

    fn stats<'a>(&'a self, gpu: &'a Gpu) -> StatsFuture<'a> {
        Box::pin(async move {
            let Some(pairs) = &self.pairs else { return Ok(Vec::new()) };
            let [blocks, texels] = pairs.needed(gpu).await?;
            Ok(vec![
                ("triangle-block pairs", f64::from(blocks)),
                ("triangle-texel pairs", f64::from(texels)),
                ("room for pairs", f64::from(pairs.room())),
            ])
        })
    }
}
