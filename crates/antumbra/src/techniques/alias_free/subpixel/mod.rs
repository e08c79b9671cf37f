//! Minghao Pan, Rui Wang, Weifeng Chen, Kun Zhou, Hujun Bao, 2009: Fast, sub-pixel antialiased shadow maps,
//! <https://doi.org/10.1111/j.1467-8659.2009.01571.x>.
//!
//! The hard shadow of the light's centre at up to 128 samples of each pixel, for little more than the cost of one.
//!
//! 1. A depth map, the silhouettes seen from the light's centre, the texels that they cross, and their summed-area table.
//! 2. A facet per pixel: the piece of its surface's plane that it sees. Where no silhouette crosses it, the depth map decides.
//! 3. Lists of the other facets, texel by texel; pairs of their texels with triangles.
//! 4. The shadow of each triangle on each facet, as a mask of samples made of half-planes from a table; masks are fused.
//! 5. The filtered result.
//!
//! [docs/techniques/subpixel.md](https://github.com/antumbra/antumbra/blob/main/docs/techniques/subpixel.md) has the details.

pub(crate) mod capacity;
mod half_planes;
pub mod pattern;
mod settings;
#[cfg(test)]
mod tests;

pub use settings::{Filter, SubpixelSettings};

use crate::error::Error;
use crate::gpu::device::Gpu;
use crate::gpu::pipeline::ComputePipeline;
use crate::gpu::readback::read_buffer;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::{BufferDescription, buffer_of, uniform};
use crate::gpu::shader::ShaderKey;
use crate::gpu::texture::{Texture, TextureDescription};
use crate::input::frame::BoundFrame;
use crate::passes::lists::texel_lists::TexelLists;
use crate::passes::maps::depth_map::DepthMap;
use crate::passes::triangles::silhouette::{Marking, SilhouetteMask};
use crate::passes::triangles::triangle_pairs::{PairCapacity, PairShader, TrianglePairs};
use crate::technique::{Description, StatsFuture, Technique, TechniqueFactory};
use crate::{binding_array, bindings, gpu_struct};
use capacity::CapacityPlan;
use glam::UVec4;
use pattern::Pattern;
use std::sync::Arc;

gpu_struct! {
    /// The samples of a pixel.
    pub(crate) struct SamplingUniform {
        /// A bit for each sample of the pattern.
        samples: UVec4,
    }
}

/// Facets in a row of texels, two texels per facet; see `facet.wesl`.
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
    /// Positions of the samples, for surfaces with holes.
    sample_positions: Texture,
    /// The Gaussian's weight of each sample of the 3 x 3 pixels around.
    weights: wgpu::Buffer,
    plan: CapacityPlan,
    pair_capacity: PairCapacity,
    counted: Option<Counted>,
}

/// Counts of the last frame, for reports.
struct Counted {
    silhouettes: SilhouetteMask,
    evaluations: wgpu::Buffer,
    pixels: wgpu::Buffer,
}

impl TechniqueFactory for Subpixel {
    type Settings = SubpixelSettings;
    type Technique = Subpixel;
    const DESCRIPTION: Description = Description {
        name: "subpixel",
        title: "Sub-pixel antialiased shadow maps",
        source: "Pan 2009",
        summary: "the exact hard shadow at up to 128 samples of a pixel, as masks of half-planes; the light is a point at \
                  its centre",
    };

    fn make(gpu: &Gpu, settings: SubpixelSettings) -> Result<Subpixel, Error> {
        let pattern = settings.pattern()?;
        let key = |module| key_for(ShaderKey::new(module), &pattern);
        let resolve = key("techniques::alias_free::subpixel::resolve")
            .feature("gaussian", settings.filter == Filter::Gaussian)
            .feature("counted", settings.statistics);
        let plan = CapacityPlan::new(u64::from(settings.budget) << 20);
        let weights = gaussian(&pattern);
        Ok(Subpixel {
            classify: gpu.compute_pipeline(&key("techniques::alias_free::subpixel::classify"), "classify")?,
            resolve: gpu.compute_pipeline(&resolve, "resolve")?,
            sampling: sampling(gpu, &pattern),
            half_planes: half_planes::table(gpu, &pattern),
            sample_positions: sample_positions(gpu, &pattern),
            weights: buffer_of(gpu, "weights", bytemuck::cast_slice(&weights), wgpu::BufferUsages::STORAGE),
            pair_capacity: PairCapacity::new(gpu, plan.pair_bytes()),
            plan,
            pattern,
            settings,
            counted: None,
        })
    }
}

/// A shader with the masks of a pattern.
fn key_for(key: ShaderKey, pattern: &Pattern) -> ShaderKey {
    key.feature("two_words", pattern.words() == 2).feature("four_words", pattern.words() == 4)
}

/// The samples as a uniform.
fn sampling(gpu: &Gpu, pattern: &Pattern) -> wgpu::Buffer {
    let all = half_planes::all(pattern);
    let samples = UVec4::from([0, 1, 2, 3].map(|k| (all >> (32 * k)) as u32));
    uniform(gpu, "sampling", &SamplingUniform { samples })
}

/// Positions of the samples, one texel each.
fn sample_positions(gpu: &Gpu, pattern: &Pattern) -> Texture {
    let positions: Vec<[f32; 2]> = pattern.samples().iter().map(|s| s.as_vec2().to_array()).collect();
    let size = [positions.len() as u32, 1];
    let help = "positions in pixels from the middle";
    let description = TextureDescription::new(size, wgpu::TextureFormat::Rg32Float, help);
    let texture = Texture::new(gpu, "samples", description.usage(wgpu::TextureUsages::COPY_DST));
    let (target, extent) = (texture.texture.as_image_copy(), texture.texture.size());
    gpu.queue.write_texture(target, bytemuck::cast_slice(&positions), Default::default(), extent);
    texture
}

/// The weight of each sample of the 3 x 3 pixels around the middle one; 32 per word of their masks.
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
    fn record(&mut self, frame: &BoundFrame, recorder: &mut Recorder) -> Result<(), Error> {
        let map = DepthMap::of_light(recorder, frame, self.settings.map)?;
        let marking = Marking { hide: self.settings.hide, count: self.settings.statistics };
        let silhouettes = SilhouetteMask::record(recorder, frame, &map, marking)?;
        let pixels = frame.size[0] * frame.size[1];
        let help = "facets, two texels per pixel: position, step; normal, error; light space, metres";
        let facets = [2 * FACET_ROW, pixels.div_ceil(FACET_ROW)];
        let facets = TextureDescription::new(facets, wgpu::TextureFormat::Rgba32Float, help);
        let facets = recorder.texture("facets", facets);
        let masks = BufferDescription::new(u64::from(pixels) * self.pattern.words() as u64 * 8);
        let masks = recorder.buffer("masks of samples", masks);
        let (strips, entries) = self.plan.strips(frame.size, u32::from(self.settings.filter == Filter::Gaussian));
        let lists = TexelLists::new(recorder, self.settings.map, entries);
        let (of_frame, depth_map) = (frame.bindings(), bindings! { depth_map: &map.texture });
        let shared = bindings! {
            facets: &facets,
            masks: &masks,
            sampling: &self.sampling,
            half_planes: &self.half_planes,
        };
        let own = bindings! { mask_counts: &silhouettes.counts, texel_map: &lists.uniform };
        recorder.compute("facets", &self.classify, &[&of_frame, depth_map, shared, own], Work::Pixels(frame.size))?;

        self.counted = self.settings.statistics.then(|| Counted {
            silhouettes,
            evaluations: recorder.buffer("visibility evaluations", BufferDescription::new(8).cleared()),
            pixels: recorder.buffer("counts of pixels", BufferDescription::new(32).cleared()),
        });
        let counters = self.counted.as_ref();
        let counters = counters.map(|c| binding_array! { evaluations: &c.evaluations, pixel_counts: &c.pixels });
        let [evaluations, pixel_counts] = counters.as_ref().map_or([&[][..]; 2], |c| [&c[..1], &c[1..]]);
        let pairs = TrianglePairs::new(recorder, frame, &lists, &self.pair_capacity);
        let listed = TexelLists::key("techniques::alias_free::subpixel::listed");
        let key = TrianglePairs::key("techniques::alias_free::subpixel::pair");
        let shader = PairShader {
            key: key_for(key, &self.pattern)
                .feature("counted", self.settings.statistics)
                .feature("no_validity", !self.settings.validity),
            bindings: &[&of_frame, shared, bindings! { sample_positions: &self.sample_positions }, evaluations],
        };
        let needed = recorder.buffer("most entries", BufferDescription::new(8).cleared());
        let (strips, count) = (recorder.uniforms("strips", strips.iter().copied()), strips.len() as u32);
        for i in 0..count {
            let strip = strips.at(i);
            lists.record(recorder, frame, &listed, bindings! { facets: &facets, strip: &strip })?;
            pairs.record(recorder, frame, &lists, &shader)?;
            let own = bindings! {
                strip: &strip,
                list_length: &lists.length().0,
                weights: &self.weights,
                needed: &needed,
            };
            let sets: [&[_]; 5] = [&of_frame, depth_map, shared, own, pixel_counts];
            recorder.compute("visibility", &self.resolve, &sets, Work::Pixels(frame.size))?;
        }
        self.pair_capacity.learn(recorder, &pairs);
        self.plan.learn(recorder, &needed);
        Ok(())
    }

    fn stats<'a>(&'a self, gpu: &'a Gpu) -> StatsFuture<'a> {
        Box::pin(async move {
            let Some(Counted { silhouettes, evaluations, pixels }) = &self.counted else { return Ok(Vec::new()) };
            let words = |bytes: Vec<u8>| -> Vec<f64> {
                bytemuck::pod_collect_to_vec::<u8, u32>(&bytes).into_iter().map(f64::from).collect()
            };
            let [edges, texels] = silhouettes.stats(gpu).await?;
            let evaluations = words(read_buffer(gpu, evaluations).await?);
            let pixels = words(read_buffer(gpu, pixels).await?);
            Ok(vec![
                ("silhouette edges", edges as f64),
                ("silhouette texels", texels as f64),
                ("silhouette pixels", pixels[0]),
                ("visibility evaluations", evaluations[0] + evaluations[1] * 4_294_967_296.0),
                ("valid samples", pixels[1] / pixels[0].max(1.0)),
                ("pixels partly in shadow", pixels[2]),
                ("valid samples partly in shadow", pixels[3] / pixels[2].max(1.0)),
                ("strips", f64::from(self.plan.strip_count())),
            ])
        })
    }
}
