//! Async readback of values.

use antumbra::Gpu;
use antumbra::gpu::texture::Texture;
use std::sync::mpsc::{Receiver, channel};

/// A texture of four bytes per texel, or a buffer, in transfer to the CPU.
pub struct Readback {
    size: [u32; 2],
    row: u32,
    buffer: wgpu::Buffer,
    ready: Receiver<Result<(), wgpu::BufferAsyncError>>,
}

impl Readback {
    /// Copies a texture after all submitted work.
    pub fn start(gpu: &Gpu, texture: &Texture) -> Readback {
        let size = texture.texture.size();
        let row = (size.width * 4).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("readback"),
            size: u64::from(row) * u64::from(size.height),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None };
        let target = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
        encoder.copy_texture_to_buffer(texture.texture.as_image_copy(), target, size);
        Readback::of(gpu, encoder, [size.width, size.height], row, buffer)
    }

    /// Copies a buffer of `count` numbers.
    pub fn of_buffer(gpu: &Gpu, source: &wgpu::Buffer, count: u32) -> Readback {
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("readback"),
            size: u64::from(count) * 4,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(source, 0, &buffer, 0, buffer.size());
        Readback::of(gpu, encoder, [count, 1], count * 4, buffer)
    }

    fn of(gpu: &Gpu, encoder: wgpu::CommandEncoder, size: [u32; 2], row: u32, buffer: wgpu::Buffer) -> Readback {
        gpu.queue.submit([encoder.finish()]);
        let (send, ready) = channel();
        buffer.map_async(wgpu::MapMode::Read, .., move |result| {
            // The image may have changed meanwhile.
            let _ = send.send(result);
        });
        Readback { size, row, buffer, ready }
    }

    /// The bytes, rows tightly packed; no bytes if the device was lost; `None` while the transfer runs.
    pub fn poll(&self) -> Option<Vec<u8>> {
        let result = self.ready.try_recv().ok()?;
        let mapped = result.ok().and_then(|()| self.buffer.get_mapped_range(..).ok());
        let Some(bytes) = mapped else { return Some(Vec::new()) };
        let rows = bytes.chunks_exact(self.row as usize);
        Some(rows.flat_map(|r| &r[..self.size[0] as usize * 4]).copied().collect())
    }

    /// The same as numbers.
    pub fn poll_numbers(&self) -> Option<Vec<f32>> {
        self.poll().map(|bytes| bytemuck::pod_collect_to_vec(&bytes))
    }
}
