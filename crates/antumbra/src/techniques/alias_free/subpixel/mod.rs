//! Sub-pixel antialiased shadows [Pan 2009]: the hard shadow of the light's centre at up to 128 samples of each pixel, for
//! little more than that at one.
//!
//! 1. A depth map, the silhouettes that the light's centre sees, the texels that these pass, and their summed-area table.
//! 2. A facet a pixel: the piece of its surface's plane that it sees. Where no silhouette passes it, the depth map decides.
//! 3. Lists of the other facets, texel by texel; pairs of their texels with triangles.
//! 4. The shadow of each triangle on each facet, as a mask of samples made of half-planes from a table; masks are fused.
//! 5. The filtered result.
//!
//! [docs/subpixel.md](https://github.com/antumbra/antumbra/blob/main/docs/subpixel.md) tells it in full.

mod half_planes;
pub(crate) mod lists;
pub mod pattern;
mod settings;
#[cfg(test)]
mod tests;

pub use settings::{Filter, SubpixelSettings};

use crate::input::frame::FrameUniform;
use crate::passes::maps::depth_map::DepthMap;
use crate::passes::triangles::silhouette::{Marking, SilhouetteMask};
use crate::passes::lists::texel_lists::{TexelLists, TexelMap};
use crate::passes::triangles::triangle_pairs::{Look, TrianglePairs};
use crate::gpu::pipeline::{Binding, ComputePipeline};
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::{Texture, UniformArray, buffer_of, read_buffer, storage_buffer, uniform};
use crate::gpu::shader::ShaderKey;
use crate::technique::{TechniqueAbout, TechniqueFactory, StatsFuture, InnerPicture, Memory, Technique};
use crate::error::Error;
use crate::input::frame::Frame;
use crate::gpu::device::Gpu;
use crate::{bindings, gpu_struct};
use glam::UVec4;
use lists::{Room, StripUniform};
use pattern::Pattern;
use std::sync::Arc;

gpu_struct! {
    /// The samples of a pixel.
    pub(crate) struct SamplingUniform {
        /// A bit for each that there is.
        samples: UVec4,
    }
}

/// Facets side by side in a row of texels, two a facet; see `facet.wesl`.
const FACET_ROW: u32 = 2048;

/// Standard deviation of the Gaussian, in pixels.
const GAUSSIAN_WIDTH: f64 = 0.5;

/// Sub-pixel antialiased shadows.
pub struct Subpixel {
    settings: SubpixelSettings,
    pattern: Pattern,
    classify: Arc<ComputePipeline>,
    resolve: Arc<ComputePipeline>,
    sampling: wgpu::Buffer,
    half_planes: Texture,
    /// Where the samples lie, for surfaces with holes.
    places: Texture,
    /// What the Gaussian gives each sample of the 3 x 3 pixels around.
    weights: wgpu::Buffer,
    counters: Counters,
    map: Option<DepthMap>,
    silhouettes: Option<SilhouetteMask>,
    pixels: Option<Pixels>,
    room: Room,
    lists: Option<TexelLists>,
    pairs: Option<TrianglePairs>,
    strips: Option<UniformArray<StripUniform>>,
}

/// What is counted for reports.
struct Counters {
    evaluations: wgpu::Buffer,
    pixels: wgpu::Buffer,
}

/// What is kept of each pixel.
struct Pixels {
    size: [u32; 2],
    facets: Texture,
    masks: wgpu::Buffer,
}

impl Pixels {
    fn ensure<'a>(slot: &'a mut Option<Pixels>, gpu: &Gpu, size: [u32; 2], words: usize) -> &'a Pixels {
        if slot.as_ref().is_none_or(|p| p.size != size) {
            let count = size[0] * size[1];
            *slot = Some(Pixels {
                size,
                facets: Texture::new(
                    gpu,
                    "facets",
                    [2 * FACET_ROW, count.div_ceil(FACET_ROW)],
                    1,
                    wgpu::TextureFormat::Rgba32Float,
                    wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::TEXTURE_BINDING,
                ),
                masks: storage_buffer(gpu, "masks of samples", u64::from(count) * words as u64 * 8),
            });
        }
        slot.as_ref().expect("just made")
    }
}

impl TechniqueFactory for Subpixel {
    type Settings = SubpixelSettings;
    const ABOUT: TechniqueAbout = TechniqueAbout {
        name: "subpixel",
        title: "Sub-pixel antialiased shadow maps",
        source: "Pan 2009",
        summary: "the exact hard shadow at up to 128 samples of a pixel, as masks of half-planes; the light is a point at \
                  its centre",
    };

    fn make(gpu: &Gpu, settings: SubpixelSettings) -> Result<Self, Error> {
        let pattern = settings.pattern()?;
        let key = |module| key_for(ShaderKey::new(module), &pattern);
        let resolve = key("techniques::alias_free::subpixel::resolve")
            .feature("gaussian", settings.filter == Filter::Gaussian)
            .feature("counted", settings.statistics);
        let all = half_planes::all(&pattern);
        let samples = UVec4::from([0, 1, 2, 3].map(|k| (all >> (32 * k)) as u32));
        let places: Vec<[f32; 2]> = pattern.samples().iter().map(|s| s.as_vec2().to_array()).collect();
        let storage = wgpu::BufferUsages::STORAGE;
        Ok(Subpixel {
            classify: gpu.compute_pipeline(&key("techniques::alias_free::subpixel::classify"), "classify")?,
            resolve: gpu.compute_pipeline(&resolve, "resolve")?,
            sampling: uniform(gpu, "sampling", &SamplingUniform { samples }),
            half_planes: half_planes::table(gpu, &pattern),
            places: place_texels(gpu, &places),
            weights: buffer_of(gpu, "weights", bytemuck::cast_slice(&gaussian(&pattern)), storage),
            counters: Counters {
                evaluations: storage_buffer(gpu, "visibility evaluations", 16),
                pixels: storage_buffer(gpu, "counts of pixels", 32),
            },
            room: Room::new(gpu, settings.budget),
            pattern,
            settings,
            map: None,
            silhouettes: None,
            pixels: None,
            lists: None,
            pairs: None,
            strips: None,
        })
    }
}

/// A shader with the masks of a pattern.
pub(crate) fn key_for(key: ShaderKey, pattern: &Pattern) -> ShaderKey {
    key.feature("two_words", pattern.words() == 2)
        .feature("four_words", pattern.words() == 4)
}

/// Where the samples lie, a texel each.
fn place_texels(gpu: &Gpu, places: &[[f32; 2]]) -> Texture {
    let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
    let size = [places.len() as u32, 1];
    let texture = Texture::new(gpu, "samples", size, 1, wgpu::TextureFormat::Rg32Float, usage);
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: None, rows_per_image: None };
    let extent = texture.texture.size();
    gpu.queue.write_texture(texture.texture.as_image_copy(), bytemuck::cast_slice(places), layout, extent);
    texture
}

/// The weight of each sample of the 3 x 3 pixels around the middle one; 32 to a word of their masks.
fn gaussian(pattern: &Pattern) -> Vec<f32> {
    let weight = |s: glam::DVec2| (-0.5 * s.length_squared() / GAUSSIAN_WIDTH.powi(2)).exp() as f32;
    let offsets = (0..9).map(|i| glam::DVec2::new(f64::from(i % 3 - 1), f64::from(i / 3 - 1)));
    let padding = 32 * pattern.words() - pattern.samples().len();
    let of_pixel = |o: glam::DVec2| {
        let samples = pattern.samples().iter().map(move |s| weight(o + *s));
        samples.chain(std::iter::repeat_n(0.0, padding)).collect::<Vec<_>>()
    };
    offsets.flat_map(of_pixel).collect()
}

impl Technique for Subpixel {
    fn record(&mut self, frame: &Frame, recorder: &mut Recorder) -> Result<(), Error> {
        let gpu = recorder.gpu;
        let [width, height] = frame.size;
        let map = DepthMap::of_light(&mut self.map, recorder, frame, self.settings.map)?;
        let marking = Marking { hide: self.settings.hide, count: self.settings.statistics };
        let silhouettes = SilhouetteMask::ensure(&mut self.silhouettes, gpu, self.settings.map)?;
        silhouettes.record(recorder, frame, map, marking)?;
        let pixels = Pixels::ensure(&mut self.pixels, gpu, frame.size, self.pattern.words());
        let own: &[Binding] = bindings! {
            depth_map: &map.texture,
            mask_counts: &silhouettes.counts.texture,
            facets: &pixels.facets,
            masks: &pixels.masks,
            sampling: &self.sampling,
            half_planes: &self.half_planes,
            sample_places: &self.places,
            weights: &self.weights,
            evaluations: &self.counters.evaluations,
            pixel_counts: &self.counters.pixels,
        };
        let plan = self.room.plan(frame.size);
        let lists = TexelLists::ensure(&mut self.lists, gpu, self.settings.map, plan.entries);
        let set = frame.bindings(&[own, bindings! { texel_map: &lists.uniform }].concat());
        recorder.compute("facets", &self.classify, &set, Work::Threads([width, height, 1]));
        if self.settings.statistics {
            recorder.encoder.clear_buffer(&self.counters.evaluations, 0, None);
            recorder.encoder.clear_buffer(&self.counters.pixels, 0, None);
        }
        let strips = UniformArray::ensure(&mut self.strips, gpu, "strips", &plan.strips);
        let parts = TrianglePairs::parts(frame, lists);
        let pairs = TrianglePairs::ensure(&mut self.pairs, gpu, &parts, self.room.pair_bytes());
        for i in 0..plan.strips.len() as u32 {
            let strip = strips.at(i);
            let set = [own, bindings! { strip: &strip, list_length: &lists.length.0 }].concat();
            let listed = key_for(TexelLists::key("techniques::alias_free::subpixel::listed"), &self.pattern);
            lists.record(recorder, frame, listed, &set)?;
            let look = Look {
                key: key_for(TrianglePairs::key("techniques::alias_free::subpixel::pair"), &self.pattern)
                    .feature("counted", self.settings.statistics)
                    .feature("no_validity", !self.settings.validity),
                bindings: &set,
                label: "shadow tests",
            };
            pairs.record(recorder, frame, lists, &parts, &look)?;
            let set = frame.bindings(&set);
            recorder.compute("visibility", &self.resolve, &set, Work::Threads([width, height, 1]));
            self.room.count(recorder, i, &lists.length);
        }
        self.room.learn(recorder);
        Ok(())
    }

    fn inner_pictures(&self) -> Vec<InnerPicture> {
        let map = self.map.iter().map(DepthMap::inner_picture);
        map.chain(self.silhouettes.iter().map(SilhouetteMask::inner_picture))
            .chain(self.lists.iter().map(TexelLists::inner_picture))
            .collect()
    }

    fn memory(&self) -> Vec<Memory> {
        let own = [&self.weights, &self.sampling, &self.counters.evaluations, &self.counters.pixels];
        let tables = own.iter().map(|b| b.size()).sum::<u64>() + self.places.bytes() + self.half_planes.bytes();
        let pixels = self.pixels.iter().map(|p| Memory::new("facets", p.facets.bytes() + p.masks.size()));
        self.map
            .iter()
            .flat_map(DepthMap::memory)
            .chain(self.silhouettes.iter().map(SilhouetteMask::memory))
            .chain(pixels)
            .chain(self.lists.iter().map(TexelLists::memory))
            .chain(self.pairs.iter().flat_map(TrianglePairs::memory))
            .chain([Memory::new("shadow tests", tables), self.room.memory()])
            .collect()
    }

    fn stats<'a>(&'a self, gpu: &'a Gpu) -> StatsFuture<'a> {
        Box::pin(async move {
            let Some(silhouettes) = self.silhouettes.as_ref().filter(|_| self.settings.statistics) else {
                return Ok(Vec::new());
            };
            let words = |bytes: Vec<u8>| -> Vec<f64> {
                bytemuck::pod_collect_to_vec::<u8, u32>(&bytes).into_iter().map(f64::from).collect()
            };
            let [edges, texels] = silhouettes.stats(gpu).await?;
            let evaluations = words(read_buffer(gpu, &self.counters.evaluations).await?);
            let pixels = words(read_buffer(gpu, &self.counters.pixels).await?);
            Ok(vec![
                ("silhouette edges", edges as f64),
                ("silhouette texels", texels as f64),
                ("silhouette pixels", pixels[0]),
                ("visibility evaluations", evaluations[0] + evaluations[1] * 4_294_967_296.0),
                ("valid samples", pixels[1] / pixels[0].max(1.0)),
                ("pixels half in shadow", pixels[2]),
                ("valid samples half in shadow", pixels[3] / pixels[2].max(1.0)),
                ("strips", f64::from(self.room.strips())),
            ])
        })
    }
}
