//! The triangles that may cast on what is seen, in light space, gathered once a frame: passes that look at triangles one
//! by one read each corner from one place instead of from the host's buffers.

use crate::input::casters::{Batch, BatchLayout, CLUSTER_TRIANGLES, Casters};
use crate::input::frame::{Frame, FrameUniform, light_from_world};
use crate::passes::lists::scan::ListLength;
use crate::gpu::recorder::{Recorder, Work, dispatch};
use crate::gpu::resources::{Texture, UniformArray, storage_buffer};
use crate::gpu::shader::ShaderKey;
use crate::technique::Memory;
use crate::error::Error;
use crate::gpu::device::Gpu;
use crate::{bindings, gpu_struct};
use glam::{Mat4, Vec2};

gpu_struct! {
    /// Which clusters of a batch are gathered, and into which space.
    pub(crate) struct GatherUniform {
        light_from_world: Mat4,
        /// Half the light's edges, metres; 0 if only its centre counts.
        half_light: Vec2,
        first_cluster: u32,
        cluster_count: u32,
    }
}

/// Bytes of a `LightTriangle` in `shaders/light_triangles.wesl`.
const TRIANGLE_BYTES: u64 = 48;
/// Triangles side by side in a row of texels.
const TEXEL_ROW: u32 = 1024;
/// Bytes of a `LightCluster`.
const CLUSTER_BYTES: u64 = 32;

/// Triangles that are looked at together. There are several such parts where there are more triangles than memory is
/// spent on, and one for each batch with holes, whose texture is bound where the holes are looked up.
pub struct Part {
    /// Batch, first cluster in it, and how many.
    clusters: Vec<(usize, u32, u32)>,
    /// The batch whose material has holes, if it has.
    pub masked: Option<usize>,
}

impl Part {
    /// Clusters in it.
    pub fn cluster_count(&self) -> u32 {
        self.clusters.iter().map(|(_, _, count)| count).sum()
    }
}

/// Triangles in light space.
pub struct LightTriangles {
    /// `LightTriangle`, see `shaders/light_triangles.wesl`, where only the light's centre counts.
    pub buffer: wgpu::Buffer,
    /// The same as texels, where the whole light counts; see `shaders/triangle_texels.wesl`.
    pub texels: Texture,
    /// How many.
    pub length: ListLength,
    /// `LightCluster`, where the whole light counts: which triangles lie side by side, and where.
    pub clusters: wgpu::Buffer,
    /// How many.
    pub cluster_length: ListLength,
    reach: Reach,
    capacity: u32,
}

/// What a triangle is gathered for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reach {
    /// What it hides of the light's centre.
    Center,
    /// What it hides of any point of the light; clusters are noted.
    Light,
}

impl LightTriangles {
    /// The parts of these casters, one at least, of at most `most` triangles each.
    pub fn parts(casters: &Casters, most: u32) -> Vec<Part> {
        let most = (most / CLUSTER_TRIANGLES).max(1);
        let mut parts: Vec<Part> = Vec::new();
        let mut room = 0;
        for (index, batch) in casters.batches.iter().enumerate() {
            let masked = batch.masked.then_some(index);
            let mut first = 0;
            while first < batch.cluster_count {
                if room == 0 || masked.is_some() && first == 0 || parts.last().is_some_and(|p| p.masked != masked) {
                    parts.push(Part { clusters: Vec::new(), masked });
                    room = most;
                }
                let count = room.min(batch.cluster_count - first);
                parts.last_mut().expect("just made").clusters.push((index, first, count));
                first += count;
                room -= count;
            }
        }
        if parts.is_empty() {
            parts.push(Part { clusters: Vec::new(), masked: None });
        }
        parts
    }

    /// Room for the largest of these parts.
    pub fn new(gpu: &Gpu, parts: &[Part], reach: Reach) -> LightTriangles {
        let capacity = LightTriangles::capacity_for(parts);
        let (listed, drawn) = match reach {
            Reach::Center => (capacity, 0),
            Reach::Light => (0, capacity),
        };
        LightTriangles {
            buffer: storage_buffer(gpu, "light triangles", u64::from(listed) * TRIANGLE_BYTES),
            texels: Texture::new(
                gpu,
                "light triangles",
                [4 * TEXEL_ROW, drawn.div_ceil(TEXEL_ROW).max(1)],
                1,
                wgpu::TextureFormat::Rgba32Float,
                wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::TEXTURE_BINDING,
            ),
            length: ListLength::unknown(gpu, "number of light triangles"),
            clusters: storage_buffer(gpu, "light clusters", u64::from(drawn / CLUSTER_TRIANGLES) * CLUSTER_BYTES),
            cluster_length: ListLength::unknown(gpu, "number of light clusters"),
            reach,
            capacity,
        }
    }

    /// Triangles of the largest of these parts, whole clusters counted.
    pub fn capacity_for(parts: &[Part]) -> u32 {
        let clusters = parts.iter().map(Part::cluster_count).max();
        clusters.unwrap_or(0).max(1) * CLUSTER_TRIANGLES
    }

    /// Most triangles of a part.
    pub fn capacity(&self) -> u32 {
        self.capacity
    }

    /// Gathers the triangles of a part that may hide the light from something in the frustum.
    pub fn record(&self, recorder: &mut Recorder, frame: &Frame, part: &Part) -> Result<(), Error> {
        let key = ShaderKey::new("passes::triangles::light_triangles::gather")
            .feature("clusters", self.reach == Reach::Light)
            .feature("masked", self.reach == Reach::Light && part.masked.is_some());
        let gather = recorder.gpu.compute_pipeline(&key, "gather_triangles")?;
        let finish = recorder.gpu.compute_pipeline(&key, "finish")?;
        let half_light = match self.reach {
            Reach::Center => Vec2::ZERO,
            Reach::Light => frame.light.size * 0.5,
        };
        let light_from_world = light_from_world(&frame.light).as_mat4();
        let uniform = |&(_, first_cluster, cluster_count): &(usize, u32, u32)| GatherUniform {
            light_from_world,
            half_light,
            first_cluster,
            cluster_count,
        };
        let uniforms: Vec<_> = part.clusters.iter().map(uniform).collect();
        let uniforms = UniformArray::new(recorder.gpu, "clusters to gather", &uniforms);
        for length in [&self.length, &self.cluster_length] {
            recorder.encoder.clear_buffer(&length.0, 0, None);
        }
        recorder.compute_pass("light triangles", |gpu, pass| {
            for (i, &(batch, _, count)) in part.clusters.iter().enumerate() {
                let gathered = uniforms.at(i as u32);
                let set = frame.bindings(bindings! {
                    gather: &gathered,
                    boxes: &frame.casters.cluster_bounds,
                    gathered: &self.buffer,
                    gathered_length: &self.length.0,
                    gathered_texels: &self.texels,
                    gathered_clusters: &self.clusters,
                    cluster_length: &self.cluster_length.0,
                });
                let batch: &Batch = &frame.casters.batches[batch];
                pass.set_pipeline(&gather.pipeline);
                pass.set_bind_group(0, &gather.bind_group(gpu, 0, &set), &[]);
                pass.set_bind_group(1, &gather.bind_group(gpu, 1, &batch.bindings(&frame.casters)), &[]);
                let side = count.min(1 << 15);
                dispatch(pass, &gather, Work::Groups([side, count.div_ceil(side), 1]));
            }
            pass.set_pipeline(&finish.pipeline);
            let set = bindings! { gathered_length: &self.length.0, cluster_length: &self.cluster_length.0 };
            pass.set_bind_group(0, &finish.bind_group(gpu, 0, set), &[]);
            dispatch(pass, &finish, Work::Groups([1, 1, 1]));
        });
        Ok(())
    }

    /// GPU memory by pass.
    pub fn memory(&self) -> Memory {
        Memory::new("light triangles", self.buffer.size() + self.texels.bytes() + self.clusters.size())
    }
}
