//! Timo Aila, Samuli Laine, 2004: Alias-free shadow maps, <https://doi.org/10.2312/EGWR/EGSR04/161-166>.
//!
//! Erik Sintorn, Elmar Eisemann, Ulf Assarsson, 2008: Sample based visibility for soft shadows using alias-free shadow
//! maps, section 3, <https://doi.org/10.1111/j.1467-8659.2008.01267.x>.
//!
//! The exact hard shadow at the middle of every pixel. Pixels are listed in the texels through which the light's centre
//! sees them, and each triangle is tested against the pixels of the texels that it touches. The map only groups the
//! work: whatever its resolution, the result is the same.

use crate::error::Error;
use crate::gpu::device::Gpu;
use crate::gpu::limits::Needs;
use crate::gpu::pipeline::ComputePipeline;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::BufferDescription;
use crate::gpu::shader::ShaderKey;
use crate::input::frame::BoundFrame;
use crate::passes::lists::texel_lists::TexelLists;
use crate::passes::pixels::geometry_buffer::GeometryBuffer;
use crate::passes::triangles::triangle_pairs::{PairCapacity, PairShader, TrianglePairs};
use crate::technique::settings::Kind;
use crate::technique::{Description, StatsFuture, Technique, TechniqueFactory};
use crate::{bindings, gpu_struct};
use std::sync::Arc;

mod supersampling;

crate::settings! {
    /// Settings of [`AliasFree`].
    pub struct AliasFreeSettings {
        /// Map that groups the pixels, texels per side; it does not change the result.
        map: u32 = 512, Kind::Integer { min: 16, max: 4096 };
        /// Points per pixel: the first is its middle, the others are drawn and shadowed again by brute force.
        samples: u32 = 1, Kind::Integer { min: 1, max: 128 };
        /// Memory for pairs of triangles and texels, MiB; a frame that needs more takes longer.
        budget: u32 = 256, Kind::Integer { min: 0, max: 4096 };
    }
}

gpu_struct! {
    /// A point of the pixel.
    pub(crate) struct SampleUniform {
        index: u32,
        count: u32,
    }
}

/// Exact shadow of the light's centre.
pub struct AliasFree {
    settings: AliasFreeSettings,
    resolve: Arc<ComputePipeline>,
    capacity: PairCapacity,
}

impl TechniqueFactory for AliasFree {
    type Settings = AliasFreeSettings;
    type Technique = AliasFree;
    const DESCRIPTION: Description = Description {
        name: "alias-free",
        title: "Alias-free shadow map",
        source: "Aila 2004, Sintorn 2008",
        summary: "the exact hard shadow of every pixel: triangles against lists of pixels; the light is a point at its centre",
    };

    // Lists, pairs and receivers, and for surfaces with holes the host's triangles.
    const NEEDS: Needs = Needs { storage_buffers: 9, ..Needs::CORE };

    fn make(gpu: &Gpu, settings: AliasFreeSettings) -> Result<AliasFree, Error> {
        let key = ShaderKey::new("techniques::alias_free::hard::resolve");
        Ok(AliasFree {
            resolve: gpu.compute_pipeline(&key, "resolve")?,
            capacity: PairCapacity::new(gpu, u64::from(settings.budget) << 20),
            settings,
        })
    }
}

impl Technique for AliasFree {
    fn record(&mut self, frame: &BoundFrame, recorder: &mut Recorder) -> Result<(), Error> {
        let [width, height] = frame.size;
        let count = self.settings.samples;
        let samples = recorder.uniforms("samples", (0..count).map(|index| SampleUniform { index, count }));
        let lists = TexelLists::new(recorder, self.settings.map, width * height);
        let pixels = u64::from(width) * u64::from(height);
        let receivers = recorder.buffer("receivers", BufferDescription::new(pixels * 16));
        let hidden = recorder.buffer("hidden pixels", BufferDescription::new(pixels * 4));
        let own = bindings! { receivers: &receivers, hidden: &hidden };
        let pairs = TrianglePairs::new(recorder, frame, &lists, &self.capacity);
        let key = TrianglePairs::key("techniques::alias_free::hard::pair");
        let shader = PairShader { key, bindings: &[own] };
        let listed = TexelLists::key("techniques::alias_free::hard::listed");
        let geometry = (count > 1).then(|| GeometryBuffer::pooled(recorder, frame.size));
        for index in 0..count {
            let moved = geometry.as_ref().filter(|_| index > 0);
            let moved = moved.map(|g| supersampling::frame_of_point(recorder, frame, g, index)).transpose()?;
            let frame = moved.as_ref().unwrap_or(frame);
            lists.record(recorder, frame, &listed, own)?;
            pairs.record(recorder, frame, &lists, &shader)?;
            let sample = samples.at(index);
            let set = [&frame.bindings()[..], bindings! { hidden: &hidden, sample: &sample }];
            recorder.compute("visibility", &self.resolve, &set, Work::Pixels(frame.size))?;
        }
        self.capacity.learn(recorder, &pairs);
        Ok(())
    }

    fn stats<'a>(&'a self, gpu: &'a Gpu) -> StatsFuture<'a> {
        Box::pin(self.capacity.stats(gpu))
    }
}
