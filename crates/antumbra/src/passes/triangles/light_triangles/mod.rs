//! The triangles that may occlude the light from a visible point, in light space, gathered once per frame: passes over
//! triangles read each corner from one place instead of from the host's buffers.

use crate::error::Error;
use crate::gpu::bindings::Binding;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::BufferDescription;
use crate::gpu::shader::ShaderKey;
use crate::gpu::texture::{Texture, TextureDescription};
use crate::input::casters::{CLUSTER_TRIANGLES, Casters};
use crate::input::frame::{BoundFrame, light_from_world};
use crate::passes::lists::list_length::ListLength;
use crate::{bindings, gpu_struct};
use glam::{Mat4, Vec2};

gpu_struct! {
    /// The clusters of a batch that are gathered, and the light.
    pub(crate) struct GatherUniform {
        light_from_world: Mat4,
        /// Half the light's edges, metres; 0 for its centre alone.
        half_light: Vec2,
        first_cluster: u32,
        cluster_count: u32,
    }
}

/// Bytes of a `LightTriangle` in `shaders/light_triangles.wesl`.
const TRIANGLE_BYTES: u64 = 48;
/// Bytes of a `LightCluster`.
const CLUSTER_BYTES: u64 = 32;
/// Triangles in a row of texels; see `shaders/triangle_texels.wesl`.
const TEXEL_ROW: u32 = 1024;

/// Triangles that are processed together. Large scenes have several parts, to bound the memory, and each batch with
/// holes has parts of its own, whose texture is bound.
pub struct Part {
    /// Batch, first cluster of the batch, number of clusters.
    clusters: Vec<(usize, u32, u32)>,
    /// The batch, if its material has holes.
    pub masked: Option<usize>,
}

impl Part {
    /// The casters as one or more parts of at most `most` triangles each.
    pub fn of(casters: &Casters, most: u32) -> Vec<Part> {
        let most = (most / CLUSTER_TRIANGLES).max(1);
        let mut parts: Vec<Part> = Vec::new();
        let mut free = 0;
        for (index, batch) in casters.batches.iter().enumerate() {
            let masked = batch.masked.then_some(index);
            let mut first = 0;
            while first < batch.cluster_count {
                if free == 0 || masked.is_some() && first == 0 || parts.last().is_some_and(|p| p.masked != masked) {
                    parts.push(Part { clusters: Vec::new(), masked });
                    free = most;
                }
                let count = free.min(batch.cluster_count - first);
                parts.last_mut().expect("not empty").clusters.push((index, first, count));
                first += count;
                free -= count;
            }
        }
        if parts.is_empty() {
            parts.push(Part { clusters: Vec::new(), masked: None });
        }
        parts
    }

    /// Number of clusters.
    pub fn cluster_count(&self) -> u32 {
        self.clusters.iter().map(|(_, _, count)| count).sum()
    }

    /// Number of clusters of the largest part, at least one.
    fn most_clusters(parts: &[Part]) -> u32 {
        parts.iter().map(Part::cluster_count).max().unwrap_or(0).max(1)
    }

    /// Writes the triangles of this part that may occlude the light from a point of the frustum; returns their number.
    fn gather(
        &self,
        recorder: &mut Recorder,
        frame: &BoundFrame,
        key: &ShaderKey,
        half_light: Vec2,
        output: &[Binding],
    ) -> Result<ListLength, Error> {
        let gather = recorder.gpu.compute_pipeline(key, "gather_triangles")?;
        let finish = recorder.gpu.compute_pipeline(key, "finish")?;
        let light_from_world = light_from_world(&frame.light).as_mat4();
        let uniform = |&(_, first_cluster, cluster_count): &_| GatherUniform {
            light_from_world,
            half_light,
            first_cluster,
            cluster_count,
        };
        let uniforms = recorder.uniforms("clusters to gather", self.clusters.iter().map(uniform));
        let length = ListLength::counted(recorder, "number of light triangles");
        let own = bindings! { boxes: &frame.casters.cluster_bounds, gathered_length: &length.0 };
        let label = "light triangles";
        for (i, &(batch, _, count)) in self.clusters.iter().enumerate() {
            let clusters = uniforms.at(i as u32);
            let batch = frame.casters.batches[batch].bindings(&frame.casters);
            let set = [&bindings! { gather: &clusters }[..], own, output, &frame.bindings(), &batch];
            recorder.compute(label, &gather, &set, Work::groups(count))?;
        }
        recorder.compute(label, &finish, &[own, output], Work::Groups([1, 1, 1]))?;
        Ok(length)
    }
}

/// Triangles that may occlude the light's centre.
pub struct CenterTriangles {
    /// `LightTriangle`; see `shaders/light_triangles.wesl`.
    pub buffer: wgpu::Buffer,
    /// Number of triangles of the largest part, clusters counted as full.
    pub capacity: u32,
}

impl CenterTriangles {
    /// Room for the largest of these parts.
    pub fn new(recorder: &mut Recorder, parts: &[Part]) -> CenterTriangles {
        let capacity = Part::most_clusters(parts) * CLUSTER_TRIANGLES;
        let description = BufferDescription::new(u64::from(capacity) * TRIANGLE_BYTES);
        CenterTriangles { buffer: recorder.buffer("light triangles", description), capacity }
    }

    /// Gathers a part; returns the number of its triangles.
    pub fn record(&self, recorder: &mut Recorder, frame: &BoundFrame, part: &Part) -> Result<ListLength, Error> {
        let key = ShaderKey::new("passes::triangles::light_triangles::gather");
        part.gather(recorder, frame, &key, Vec2::ZERO, bindings! { gathered: &self.buffer })
    }
}

/// Triangles that may occlude any point of the light, with the clusters that they belong to.
pub struct AreaTriangles {
    /// Corners and texture coordinates; see `shaders/triangle_texels.wesl`.
    pub texels: Texture,
    /// `LightCluster`: the bounds and the triangles of each cluster.
    pub clusters: wgpu::Buffer,
}

impl AreaTriangles {
    /// Room for the largest of these parts.
    pub fn new(recorder: &mut Recorder, parts: &[Part]) -> AreaTriangles {
        let clusters = Part::most_clusters(parts);
        let size = [4 * TEXEL_ROW, (clusters * CLUSTER_TRIANGLES).div_ceil(TEXEL_ROW)];
        let help = "corners of the triangles in light space, metres; four texels per triangle";
        let texels = TextureDescription::new(size, wgpu::TextureFormat::Rgba32Float, help);
        AreaTriangles {
            texels: recorder.texture("light triangles", texels),
            clusters: recorder.buffer("light clusters", BufferDescription::new(u64::from(clusters) * CLUSTER_BYTES)),
        }
    }

    /// Gathers a part; returns the number of its clusters.
    pub fn record(&self, recorder: &mut Recorder, frame: &BoundFrame, part: &Part) -> Result<ListLength, Error> {
        let key = ShaderKey::new("passes::triangles::light_triangles::gather")
            .feature("clusters", true)
            .feature("masked", part.masked.is_some());
        let length = ListLength::counted(recorder, "number of light clusters");
        let output = bindings! {
            gathered_texels: &self.texels,
            gathered_clusters: &self.clusters,
            cluster_length: &length.0,
        };
        part.gather(recorder, frame, &key, frame.light.size * 0.5, output)?;
        Ok(length)
    }
}
