//! Casters of shadow maps: triangles in the host's buffers or in our own, in clusters that are culled on the GPU.

use super::cluster_bounds;
use crate::error::Error;
use crate::gpu::bindings::Binding;
use crate::gpu::device::Gpu;
use crate::gpu::resources::{buffer_of, storage_buffer, uniform};
use crate::gpu::texture::{Texture, TextureDescription};
use crate::gpu_struct;
use antumbra_scene::Aabb;
use std::sync::OnceLock;

/// Triangles per cluster: the unit of culling.
pub const CLUSTER_TRIANGLES: u32 = 128;

gpu_struct! {
    /// Where a batch's vertices, indices and transforms lie; offsets and strides in 32-bit words, or in indices.
    pub(crate) struct BatchLayout {
        vertex_offset: u32,
        vertex_stride: u32,
        uv_offset: u32,
        /// 0 none, 1 16-bit, 2 32-bit.
        index_kind: u32,
        index_offset: u32,
        transform_offset: u32,
        transform_stride: u32,
        first_cluster: u32,
        cluster_count: u32,
        /// Place among the batches.
        number: u32,
        /// Alpha below this is cut out; 0 for opaque.
        alpha_cutoff: f32,
        /// Factor of the texture's alpha.
        alpha: f32,
        textured: u32,
    }
}

/// Column-major 4 x 4 `f32` matrices from object to world space (the last row is ignored), one an instance.
#[derive(Clone, Copy, Debug)]
pub struct Transforms<'a> {
    /// Needs `STORAGE`.
    pub buffer: &'a wgpu::Buffer,
    /// First matrix, in bytes; a multiple of 4.
    pub offset: u64,
    /// From one matrix to the next, in bytes; a multiple of 4, at least 64.
    pub stride: u64,
    /// Number of instances.
    pub count: u32,
}

/// Role of a mesh in occluder/receiver classification.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Role {
    /// Casts shadows and takes them. An occluder where a technique parts the scene into occluders and receivers
    /// (`ssm`).
    #[default]
    Caster,
    /// The same, but a receiver where the scene is parted: the ground, and meshes above no other surface.
    Ground,
    /// Takes shadows and casts none, whatever the technique.
    Receiver,
}

/// Three corners a triangle, in the order of the index buffer.
#[derive(Clone, Copy, Debug)]
pub struct Indices<'a> {
    /// Needs `STORAGE`.
    pub buffer: &'a wgpu::Buffer,
    /// 16 or 32 bits.
    pub format: wgpu::IndexFormat,
    /// First index, in bytes; a multiple of the index size.
    pub offset: u64,
}

/// Cuts holes into a mesh where the texture's alpha is low.
#[derive(Clone, Copy, Debug)]
pub struct Mask<'a> {
    /// A float texture with alpha in its fourth channel.
    pub texture: &'a wgpu::TextureView,
    /// How it is filtered and repeated.
    pub sampler: &'a wgpu::Sampler,
    /// Place of the texture coordinates (two `f32`) in a vertex, in bytes; a multiple of 4.
    pub uv_offset: u64,
    /// Alpha below this is a hole, in (0, 1].
    pub cutoff: f32,
}

/// A mesh in the host's own buffers, which are neither copied nor changed.
#[derive(Clone, Copy, Debug)]
pub struct MeshBuffers<'a> {
    /// Needs `STORAGE`.
    pub vertices: &'a wgpu::Buffer,
    /// Position (three `f32`, object space, metres) of vertex 0, in bytes; a multiple of 4.
    pub position_offset: u64,
    /// From one vertex to the next, in bytes; a multiple of 4.
    pub vertex_stride: u64,
    /// None: vertices in order.
    pub indices: Option<Indices<'a>>,
    /// Number of triangles.
    pub triangle_count: u32,
    /// Where the mesh stands.
    pub transforms: Transforms<'a>,
    /// World-space box around all instances; fits the shadow frustum.
    pub bounds: Aabb,
    /// Whether it casts, and its part where a scene is parted.
    pub role: Role,
    /// Holes, for foliage.
    pub mask: Option<Mask<'a>>,
}

/// A set of triangles in one pair of buffers with one material: one draw.
#[derive(Clone)]
pub(crate) struct Batch {
    pub vertices: wgpu::Buffer,
    pub indices: wgpu::Buffer,
    pub transforms: wgpu::Buffer,
    pub layout: wgpu::Buffer,
    pub texture: wgpu::TextureView,
    pub sampler: wgpu::Sampler,
    pub masked: bool,
    pub textured: bool,
    pub cluster_count: u32,
    /// The triangles of each mesh: the unit that may share edges.
    pub meshes: Vec<std::ops::Range<u32>>,
}

/// A cluster of one instance: the unit of culling and drawing. Matches `Cluster` in `triangles.wesl`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cluster {
    pub first_triangle: u32,
    pub triangle_count: u32,
    pub role: Role,
    pub instance: u32,
    /// sRGB, 8 bits a channel.
    pub color: [u8; 4],
}

impl Cluster {
    fn words(&self) -> [u32; 4] {
        let flags = match self.role {
            Role::Caster => 0,
            Role::Ground => 1 << 17,
            Role::Receiver => 3 << 16,
        };
        [self.first_triangle, self.triangle_count | flags, self.instance, u32::from_le_bytes(self.color)]
    }
}

/// Splits `triangles` into clusters for every instance.
pub(crate) fn clusters_of(
    first: u32,
    triangles: u32,
    instances: std::ops::Range<u32>,
    role: Role,
    color: [u8; 4],
) -> impl Iterator<Item = Cluster> {
    instances.flat_map(move |instance| {
        (0..triangles.div_ceil(CLUSTER_TRIANGLES)).map(move |c| Cluster {
            first_triangle: first + c * CLUSTER_TRIANGLES,
            triangle_count: (triangles - c * CLUSTER_TRIANGLES).min(CLUSTER_TRIANGLES),
            role,
            instance,
            color,
        })
    })
}

/// All geometry that shadows are made of. Clones share the buffers.
#[derive(Clone)]
pub struct Casters {
    pub(crate) batches: Vec<Batch>,
    pub(crate) clusters: wgpu::Buffer,
    pub(crate) cluster_count: u32,
    pub(crate) cluster_bounds: wgpu::Buffer,
    /// The rings of half-edges of each batch, once a pass has found them; see `passes/triangles/adjacency`.
    pub(crate) edge_rings: OnceLock<Vec<wgpu::Buffer>>,
    triangle_count: u64,
    some_only_receive: bool,
    pub(crate) bounds: Aabb,
    pub(crate) occluder_bounds: Aabb,
}

impl Casters {
    /// Takes meshes that lie in the host's buffers. Call it again when a buffer, a layout or a count changes; moved
    /// instances need no call, moved vertices need [`Casters::refit`].
    pub fn from_buffers(gpu: &Gpu, meshes: &[MeshBuffers]) -> Result<Casters, Error> {
        let mut builder = CastersBuilder::new(gpu);
        for (index, mesh) in meshes.iter().enumerate() {
            check(mesh).map_err(|message| Error::Casters { mesh: index, message })?;
            let clusters = clusters_of(0, mesh.triangle_count, 0..mesh.transforms.count, mesh.role, [255; 4]);
            let layout = BatchLayout {
                vertex_offset: (mesh.position_offset / 4) as u32,
                vertex_stride: (mesh.vertex_stride / 4) as u32,
                uv_offset: mesh.mask.map_or(0, |m| (m.uv_offset / 4) as u32),
                index_kind: mesh.indices.map_or(0, |i| if i.format == wgpu::IndexFormat::Uint16 { 1 } else { 2 }),
                index_offset: mesh.indices.map_or(0, |i| (i.offset / i.format.byte_size() as u64) as u32),
                transform_offset: (mesh.transforms.offset / 4) as u32,
                transform_stride: (mesh.transforms.stride / 4) as u32,
                first_cluster: 0,
                cluster_count: 0,
                number: 0,
                alpha_cutoff: mesh.mask.map_or(0.0, |m| m.cutoff),
                alpha: 1.0,
                textured: u32::from(mesh.mask.is_some()),
            };
            let buffers = [mesh.vertices, mesh.indices.map_or(mesh.vertices, |i| i.buffer), mesh.transforms.buffer];
            let texture = mesh.mask.map(|m| (m.texture, m.sampler));
            builder.push(
                layout,
                buffers.map(Clone::clone),
                texture,
                clusters,
                std::iter::once(0..mesh.triangle_count).collect(),
            );
            builder.bounds = builder.bounds.union(&mesh.bounds);
            if mesh.role == Role::Caster {
                builder.occluder_bounds = builder.occluder_bounds.union(&mesh.bounds);
            }
        }
        builder.finish()
    }

    /// Number of triangles over all instances.
    pub fn triangle_count(&self) -> u64 {
        self.triangle_count
    }

    /// Number of clusters over all instances.
    pub fn cluster_count(&self) -> u32 {
        self.cluster_count
    }

    /// True if some surfaces take shadows and cast none.
    pub fn some_only_receive(&self) -> bool {
        self.some_only_receive
    }

    /// World-space box around everything.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// World-space bounding box of classified occluders ([`Role::Caster`]); empty if nothing is.
    pub fn occluder_bounds(&self) -> Aabb {
        self.occluder_bounds
    }

    /// Measures the clusters again after vertices have moved in their buffers.
    pub fn refit(&self, gpu: &Gpu) -> Result<(), Error> {
        cluster_bounds::measure(gpu, self)
    }
}

/// Collects batches, then uploads the table of clusters and measures their boxes on the GPU.
pub(crate) struct CastersBuilder<'a> {
    gpu: &'a Gpu,
    batches: Vec<Batch>,
    words: Vec<[u32; 4]>,
    triangle_count: u64,
    some_only_receive: bool,
    white: (wgpu::TextureView, wgpu::Sampler),
    pub bounds: Aabb,
    pub occluder_bounds: Aabb,
}

impl<'a> CastersBuilder<'a> {
    pub fn new(gpu: &'a Gpu) -> Self {
        let white = TextureDescription::new([1, 1], wgpu::TextureFormat::Rgba8Unorm, "white")
            .usage(wgpu::TextureUsages::COPY_DST);
        let white = Texture::new(gpu, "no texture", white);
        gpu.queue.write_texture(
            white.texture.as_image_copy(),
            &[255; 4],
            Default::default(),
            wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: 1 },
        );
        let sampler = gpu.device.create_sampler(&Default::default());
        CastersBuilder {
            gpu,
            batches: Vec::new(),
            words: Vec::new(),
            triangle_count: 0,
            some_only_receive: false,
            white: (white.view.clone(), sampler),
            bounds: Aabb::EMPTY,
            occluder_bounds: Aabb::EMPTY,
        }
    }

    pub fn push(
        &mut self,
        mut layout: BatchLayout,
        [vertices, indices, transforms]: [wgpu::Buffer; 3],
        texture: Option<(&wgpu::TextureView, &wgpu::Sampler)>,
        clusters: impl Iterator<Item = Cluster>,
        meshes: Vec<std::ops::Range<u32>>,
    ) {
        layout.first_cluster = self.words.len() as u32;
        for cluster in clusters {
            self.triangle_count += u64::from(cluster.triangle_count);
            self.some_only_receive |= cluster.role == Role::Receiver;
            self.words.push(cluster.words());
        }
        layout.cluster_count = self.words.len() as u32 - layout.first_cluster;
        layout.number = self.batches.len() as u32;
        let (texture, sampler) = texture.unwrap_or((&self.white.0, &self.white.1));
        self.batches.push(Batch {
            vertices,
            indices,
            transforms,
            layout: uniform(self.gpu, "batch layout", &layout),
            texture: texture.clone(),
            sampler: sampler.clone(),
            masked: layout.alpha_cutoff > 0.0,
            textured: layout.textured != 0,
            cluster_count: layout.cluster_count,
            meshes,
        });
    }

    pub fn finish(self) -> Result<Casters, Error> {
        let usage = wgpu::BufferUsages::STORAGE;
        let words = if self.words.is_empty() { vec![[0; 4]] } else { self.words };
        let casters = Casters {
            clusters: buffer_of(self.gpu, "clusters", bytemuck::cast_slice(&words), usage),
            cluster_count: self.batches.iter().map(|b| b.cluster_count).sum(),
            cluster_bounds: storage_buffer(self.gpu, "cluster bounds", words.len() as u64 * 32),
            batches: self.batches,
            edge_rings: OnceLock::new(),
            triangle_count: self.triangle_count,
            some_only_receive: self.some_only_receive,
            bounds: self.bounds,
            occluder_bounds: self.occluder_bounds,
        };
        casters.refit(self.gpu)?;
        Ok(casters)
    }
}

/// The reason why a mesh cannot be borrowed.
fn check(mesh: &MeshBuffers) -> Result<(), String> {
    let storage = |buffer: &wgpu::Buffer, what: &str| {
        if buffer.usage().contains(wgpu::BufferUsages::STORAGE) {
            return Ok(());
        }
        Err(format!("its {what} buffer was made without BufferUsages::STORAGE, which reading it in a shader needs"))
    };
    let holds = |buffer: &wgpu::Buffer, what: &str, needed: u64| {
        if buffer.size() >= needed {
            return Ok(());
        }
        Err(format!("its {what} buffer has {} bytes where the layout needs {needed}", buffer.size()))
    };
    let words = |value: u64, what: &str| {
        if value.is_multiple_of(4) { Ok(()) } else { Err(format!("its {what} of {value} bytes is no multiple of 4")) }
    };
    if mesh.triangle_count == 0 || mesh.transforms.count == 0 {
        return Err("it has no triangles or no instances: leave it out".to_owned());
    }
    storage(mesh.vertices, "vertex")?;
    storage(mesh.transforms.buffer, "transform")?;
    words(mesh.position_offset, "position offset")?;
    words(mesh.vertex_stride, "vertex stride")?;
    words(mesh.transforms.offset, "transform offset")?;
    words(mesh.transforms.stride, "transform stride")?;
    if mesh.vertex_stride < 12 {
        return Err(format!("its vertex stride of {} bytes is shorter than a position", mesh.vertex_stride));
    }
    let t = &mesh.transforms;
    if t.stride < 64 {
        return Err(format!("its transform stride of {} bytes is shorter than a matrix", t.stride));
    }
    if let Some(mask) = &mesh.mask {
        words(mask.uv_offset, "offset of texture coordinates")?;
        if !(mask.cutoff > 0.0 && mask.cutoff <= 1.0) {
            return Err(format!("its mask's cutoff of {} is not over 0 and up to 1", mask.cutoff));
        }
    }
    holds(t.buffer, "transform", t.offset + t.stride * u64::from(t.count - 1) + 64)?;
    match &mesh.indices {
        None => {
            let last = u64::from(mesh.triangle_count) * 3 - 1;
            holds(mesh.vertices, "vertex", mesh.position_offset + mesh.vertex_stride * last + 12)
        }
        Some(i) => {
            storage(i.buffer, "index")?;
            if i.offset % i.format.byte_size() as u64 != 0 {
                return Err(format!("its index offset of {} bytes is no multiple of the index size", i.offset));
            }
            let size = i.format.byte_size() as u64;
            holds(i.buffer, "index", i.offset + u64::from(mesh.triangle_count) * 3 * size)
        }
    }
}

/// Number of [`Batch::bindings`].
pub(crate) const BATCH_BINDINGS: usize = 7;

impl Batch {
    /// The resources of `shaders/triangles.wesl`.
    pub(crate) fn bindings<'a>(&'a self, casters: &'a Casters) -> [Binding<'a>; BATCH_BINDINGS] {
        crate::binding_array! {
            batch: &self.layout,
            vertex_words: &self.vertices,
            index_words: &self.indices,
            transforms: &self.transforms,
            clusters: &casters.clusters,
            surface_texture: &self.texture,
            surface_sampler: &self.sampler,
        }
    }
}
