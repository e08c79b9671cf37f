//! Textures and buffers that know their size in bytes, and reading them back.

use crate::{Error, Gpu};
use std::sync::mpsc::{TryRecvError, channel};
use wgpu::util::DeviceExt;

/// A 2D texture (or array) with a view of all of it.
#[derive(Clone, Debug)]
pub struct Texture {
    /// The texture.
    pub texture: wgpu::Texture,
    /// Everything in it.
    pub view: wgpu::TextureView,
}

impl Texture {
    /// A texture of one layer; `mips` levels.
    pub fn new(
        gpu: &Gpu,
        label: &str,
        size: [u32; 2],
        mips: u32,
        format: wgpu::TextureFormat,
        usage: wgpu::TextureUsages,
    ) -> Texture {
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
            mip_level_count: mips,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage,
            view_formats: &[],
        });
        Texture { view: texture.create_view(&Default::default()), texture }
    }

    /// A depth texture with `samples` depths a texel.
    pub fn depth(gpu: &Gpu, label: &str, size: [u32; 2], samples: u32, usage: wgpu::TextureUsages) -> Texture {
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: samples,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Depth32Float,
            usage,
            view_formats: &[],
        });
        Texture { view: texture.create_view(&Default::default()), texture }
    }

    /// A texture of `layers` layers and `mips` levels; its view is an array whatever their number.
    pub fn array(
        gpu: &Gpu,
        label: &str,
        size: [u32; 2],
        layers: u32,
        mips: u32,
        format: wgpu::TextureFormat,
        usage: wgpu::TextureUsages,
    ) -> Texture {
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: layers },
            mip_level_count: mips,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage,
            view_formats: &[],
        });
        let whole =
            wgpu::TextureViewDescriptor { dimension: Some(wgpu::TextureViewDimension::D2Array), ..Default::default() };
        Texture { view: texture.create_view(&whole), texture }
    }

    /// A view of `count` layers from `first` on: an array if they are several.
    pub fn layers(&self, first: u32, count: u32) -> wgpu::TextureView {
        self.texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(match count {
                1 => wgpu::TextureViewDimension::D2,
                _ => wgpu::TextureViewDimension::D2Array,
            }),
            base_array_layer: first,
            array_layer_count: Some(count),
            ..Default::default()
        })
    }

    /// A view of one mip level.
    pub fn mip(&self, level: u32) -> wgpu::TextureView {
        self.texture.create_view(&wgpu::TextureViewDescriptor {
            base_mip_level: level,
            mip_level_count: Some(1),
            ..Default::default()
        })
    }

    /// An array view of one mip level of all layers.
    pub fn array_mip(&self, level: u32) -> wgpu::TextureView {
        self.texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            base_mip_level: level,
            mip_level_count: Some(1),
            ..Default::default()
        })
    }

    /// GPU memory of all levels and layers, in bytes.
    pub fn bytes(&self) -> u64 {
        let t = &self.texture;
        let texel = u64::from(t.format().block_copy_size(None).unwrap_or(4));
        (0..t.mip_level_count())
            .map(|m| u64::from((t.width() >> m).max(1)) * u64::from((t.height() >> m).max(1)))
            .sum::<u64>()
            * texel
            * u64::from(t.depth_or_array_layers())
            * u64::from(t.sample_count())
    }
}

/// A buffer that holds `bytes` from the start.
pub fn buffer_of(gpu: &Gpu, label: &str, bytes: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
    gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: Some(label), contents: bytes, usage })
}

/// A zeroed storage buffer of `size` bytes that can also be an indirect argument and be copied.
pub fn storage_buffer(gpu: &Gpu, label: &str, size: u64) -> wgpu::Buffer {
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: size.max(16),
        usage: wgpu::BufferUsages::STORAGE
            | wgpu::BufferUsages::INDIRECT
            | wgpu::BufferUsages::COPY_DST
            | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    })
}

/// A uniform buffer with the bytes of a host struct.
pub fn uniform<T: crate::shader::HostStruct>(gpu: &Gpu, label: &str, value: &T) -> wgpu::Buffer {
    buffer_of(gpu, label, &value.uniform_bytes(), wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST)
}

/// The bytes of an array of host structs in a storage buffer.
pub fn storage_bytes<T>(values: &[T]) -> Vec<u8>
where
    T: encase::ShaderType + encase::ShaderSize + encase::internal::WriteInto,
{
    let mut buffer = encase::StorageBuffer::new(Vec::new());
    buffer.write(values).expect("a vector grows as needed");
    buffer.into_inner()
}

/// A storage buffer that holds an array of host structs.
pub fn storage_of<T>(gpu: &Gpu, label: &str, values: &[T]) -> wgpu::Buffer
where
    T: encase::ShaderType + encase::ShaderSize + encase::internal::WriteInto,
{
    let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
    buffer_of(gpu, label, &storage_bytes(values), usage)
}

/// Uniforms of one kind for several passes of a frame, which are all written before the frame runs.
pub struct UniformArray<T> {
    buffer: wgpu::Buffer,
    size: u64,
    values: Vec<T>,
}

/// From one uniform to the next: what every device can bind at.
const UNIFORM_STRIDE: u64 = 256;

impl<T: crate::shader::HostStruct + Copy> UniformArray<T> {
    /// The values, in order.
    pub fn new(gpu: &Gpu, label: &str, values: &[T]) -> Self {
        UniformArray {
            buffer: buffer_of(
                gpu,
                label,
                &Self::bytes(values),
                wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            ),
            size: values.first().map_or(0, |v| v.uniform_bytes().len() as u64),
            values: values.to_vec(),
        }
    }

    /// The values of this frame, in the buffer of the last one if it has room.
    pub fn ensure<'a>(slot: &'a mut Option<Self>, gpu: &Gpu, label: &str, values: &[T]) -> &'a Self {
        let bytes = Self::bytes(values);
        match slot {
            Some(array) if array.buffer.size() >= bytes.len() as u64 => {
                gpu.queue.write_buffer(&array.buffer, 0, &bytes);
                array.values.clear();
                array.values.extend_from_slice(values);
            }
            _ => *slot = Some(UniformArray::new(gpu, label, values)),
        }
        slot.as_ref().expect("just made")
    }

    /// As they are bound.
    fn bytes(values: &[T]) -> Vec<u8> {
        let mut bytes = Vec::new();
        for value in values {
            bytes.extend(value.uniform_bytes());
            bytes.resize(bytes.len().next_multiple_of(UNIFORM_STRIDE as usize), 0);
        }
        bytes
    }

    /// The value at `index`.
    pub fn value(&self, index: u32) -> T {
        self.values[index as usize]
    }

    /// What is bound for the value at `index`.
    pub fn at(&self, index: u32) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: &self.buffer,
            offset: u64::from(index) * UNIFORM_STRIDE,
            size: std::num::NonZero::new(self.size),
        })
    }

    /// Number of values.
    pub fn len(&self) -> u32 {
        self.values.len() as u32
    }

    /// True if there is none.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }
}

/// Reads a buffer back; it needs `COPY_SRC`.
pub async fn read_buffer(gpu: &Gpu, buffer: &wgpu::Buffer) -> Result<Vec<u8>, Error> {
    let staging = staging(gpu, buffer.size());
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(buffer, 0, &staging, 0, buffer.size());
    gpu.queue.submit([encoder.finish()]);
    map(gpu, &staging).await
}

/// Reads the first mip level of the first layer; rows tightly packed.
pub async fn read_texture(gpu: &Gpu, texture: &wgpu::Texture) -> Result<Vec<u8>, Error> {
    read_first_layers(gpu, texture, 1).await
}

/// Reads the first mip level of all layers, one after the other; rows tightly packed.
pub async fn read_layers(gpu: &Gpu, texture: &wgpu::Texture) -> Result<Vec<u8>, Error> {
    read_first_layers(gpu, texture, texture.depth_or_array_layers()).await
}

async fn read_first_layers(gpu: &Gpu, texture: &wgpu::Texture, layers: u32) -> Result<Vec<u8>, Error> {
    let texel = texture.format().block_copy_size(None).expect("a colour format");
    let row = texture.width() * texel;
    let padded = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let staging = staging(gpu, u64::from(padded) * u64::from(texture.height()) * u64::from(layers));
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &staging,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(padded),
                rows_per_image: Some(texture.height()),
            },
        },
        wgpu::Extent3d { width: texture.width(), height: texture.height(), depth_or_array_layers: layers },
    );
    gpu.queue.submit([encoder.finish()]);
    let bytes = map(gpu, &staging).await?;
    Ok(bytes.chunks_exact(padded as usize).flat_map(|r| &r[..row as usize]).copied().collect())
}

fn staging(gpu: &Gpu, size: u64) -> wgpu::Buffer {
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("readback"),
        size,
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    })
}

async fn map(gpu: &Gpu, staging: &wgpu::Buffer) -> Result<Vec<u8>, Error> {
    let (send, receive) = channel();
    staging.map_async(wgpu::MapMode::Read, .., move |result| {
        // The receiver lives until the message has come.
        let _ = send.send(result);
    });
    gpu.wait()?;
    match receive.try_recv() {
        Ok(mapped) => mapped.map_err(|e| Error::Lost(e.to_string()))?,
        Err(TryRecvError::Empty) => return Err(Error::CannotWait),
        Err(e) => return Err(Error::Lost(e.to_string())),
    }
    Ok(staging.get_mapped_range(..).map_err(|e| Error::Lost(e.to_string()))?.to_vec())
}
