//! A host's buffers: one mesh of a scene with all of its instances, in a given layout.

use crate::common::gpu;
use antumbra::Aabb;
use antumbra::input::casters::{Indices, MeshBuffers, Role, Transforms};
use antumbra_scene::Scene;
use glam::Mat4;
use wgpu::util::DeviceExt;

/// Layout of a mesh in its buffers; offsets and strides in bytes.
#[derive(Clone, Copy, Debug)]
pub struct Layout {
    pub vertex_stride: u64,
    pub position_offset: u64,
    /// `None`: three vertices per triangle.
    pub indices: Option<wgpu::IndexFormat>,
    /// Number of indices before the mesh's first.
    pub first_index: u64,
    pub transform_stride: u64,
    pub transform_offset: u64,
}

impl Layout {
    /// Everything tightly packed, 32-bit indices.
    pub const PLAIN: Layout = Layout {
        vertex_stride: 12,
        position_offset: 0,
        indices: Some(wgpu::IndexFormat::Uint32),
        first_index: 0,
        transform_stride: 64,
        transform_offset: 0,
    };
}

/// One mesh in buffers of its own. Gaps between values are NaN, so that a test detects a wrong address.
pub struct Host {
    pub vertices: wgpu::Buffer,
    pub bounds: Aabb,
    indices: Option<wgpu::Buffer>,
    transforms: wgpu::Buffer,
    layout: Layout,
    triangles: u32,
    instances: u32,
    role: Role,
}

impl Host {
    pub fn new(scene: &Scene, mesh: usize, layout: Layout) -> Host {
        let source = &scene.meshes[mesh];
        let placed: Vec<_> = scene.instances.iter().filter(|i| i.mesh == mesh).collect();
        let order: Vec<u32> = match layout.indices {
            Some(_) => (0..source.positions.len() as u32).collect(),
            None => source.indices.clone(),
        };
        let vertex = |i: &u32| {
            let uv = source.uvs.get(*i as usize).copied().unwrap_or_default();
            let p = source.positions[*i as usize];
            let words = [p.x, p.y, p.z, uv.x, uv.y];
            words[..if layout.vertex_stride >= 20 { 5 } else { 3 }].to_vec()
        };
        let matrices = placed.iter().map(|i| Mat4::from(i.world_from_object).to_cols_array().to_vec());
        Host {
            vertices: spread(order.iter().map(vertex), layout.position_offset, layout.vertex_stride),
            indices: layout.indices.map(|format| indices(&source.indices, format, layout.first_index)),
            transforms: spread(matrices, layout.transform_offset, layout.transform_stride),
            bounds: scene.bounds_of(|i| i.mesh == mesh),
            triangles: source.triangle_count() as u32,
            instances: placed.len() as u32,
            role: if placed.iter().all(|i| i.receiver_only) { Role::Receiver } else { Role::Caster },
            layout,
        }
    }

    pub fn mesh(&self) -> MeshBuffers<'_> {
        let l = &self.layout;
        MeshBuffers {
            vertices: &self.vertices,
            position_offset: l.position_offset,
            vertex_stride: l.vertex_stride,
            indices: self.indices.as_ref().zip(l.indices).map(|(buffer, format)| Indices {
                buffer,
                format,
                offset: l.first_index * format.byte_size() as u64,
            }),
            triangle_count: self.triangles,
            transforms: Transforms {
                buffer: &self.transforms,
                offset: l.transform_offset,
                stride: l.transform_stride,
                count: self.instances,
            },
            bounds: self.bounds,
            role: self.role,
            mask: None,
        }
    }
}

/// Values of a few words each at an offset and a stride in bytes, NaN between them.
fn spread(values: impl Iterator<Item = Vec<f32>>, offset: u64, stride: u64) -> wgpu::Buffer {
    let mut words: Vec<f32> = Vec::new();
    for (i, value) in values.enumerate() {
        let at = (offset as usize + i * stride as usize) / 4;
        words.resize(at, f32::NAN);
        words.extend(value);
    }
    buffer(
        bytemuck::cast_slice(&words),
        wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
    )
}

/// A buffer with `first` wrong indices, then those of `source`.
fn indices(source: &[u32], format: wgpu::IndexFormat, first: u64) -> wgpu::Buffer {
    let padded = std::iter::repeat_n(1u32, first as usize).chain(source.iter().copied());
    let mut bytes: Vec<u8> = match format {
        wgpu::IndexFormat::Uint16 => padded.flat_map(|i| (i as u16).to_le_bytes()).collect(),
        wgpu::IndexFormat::Uint32 => padded.flat_map(u32::to_le_bytes).collect(),
    };
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    buffer(&bytes, wgpu::BufferUsages::STORAGE)
}

pub fn buffer(contents: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
    gpu().device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: Some("host"), contents, usage })
}

/// A texture with a sampler that takes the nearest texel.
pub fn texture(source: &antumbra_scene::Texture) -> (wgpu::TextureView, wgpu::Sampler) {
    let size = wgpu::Extent3d { width: source.width, height: source.height, depth_or_array_layers: 1 };
    let descriptor = wgpu::TextureDescriptor {
        label: Some("leaf"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8UnormSrgb,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    };
    let gpu = gpu();
    let texture = gpu.device.create_texture_with_data(&gpu.queue, &descriptor, Default::default(), &source.rgba);
    (texture.create_view(&Default::default()), gpu.device.create_sampler(&Default::default()))
}
