//! Reading back from the GPU: at once, for tests and reports, and some frames later without waiting.

use super::device::Gpu;
use crate::error::Error;
use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::mpsc::{TryRecvError, channel};
use std::time::Duration;

/// Reads a buffer back; it needs `COPY_SRC`.
pub async fn read_buffer(gpu: &Gpu, buffer: &wgpu::Buffer) -> Result<Vec<u8>, Error> {
    let staging = staging(gpu, "readback", buffer.size());
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(buffer, 0, &staging, 0, buffer.size());
    gpu.queue.submit([encoder.finish()]);
    map(gpu, &staging).await
}

/// Reads the first mip level of the first layer; rows tightly packed.
pub async fn read_texture(gpu: &Gpu, texture: &wgpu::Texture) -> Result<Vec<u8>, Error> {
    read_first_layers(gpu, texture, 1).await
}

/// Reads the first mip level of all layers, in order; rows tightly packed.
pub async fn read_layers(gpu: &Gpu, texture: &wgpu::Texture) -> Result<Vec<u8>, Error> {
    read_first_layers(gpu, texture, texture.depth_or_array_layers()).await
}

async fn read_first_layers(gpu: &Gpu, texture: &wgpu::Texture, layers: u32) -> Result<Vec<u8>, Error> {
    let texel = texture.format().block_copy_size(None).expect("a colour format");
    let row = texture.width() * texel;
    let padded = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let staging = staging(gpu, "readback", u64::from(padded) * u64::from(texture.height()) * u64::from(layers));
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

fn staging(gpu: &Gpu, label: &str, size: u64) -> wgpu::Buffer {
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    })
}

/// Within this time a callback runs after its work is done.
const CALLBACK_TIME: Duration = Duration::from_secs(10);

async fn map(gpu: &Gpu, staging: &wgpu::Buffer) -> Result<Vec<u8>, Error> {
    let (send, receive) = channel();
    staging.map_async(wgpu::MapMode::Read, .., move |result| {
        // The receiver lives until the message has come.
        let _ = send.send(result);
    });
    gpu.wait()?;
    // Where threads share the device, another one may be the one that runs the callback, a moment after this one's
    // wait.
    let mapped = match receive.try_recv() {
        Err(TryRecvError::Empty) if !cfg!(target_arch = "wasm32") => receive.recv_timeout(CALLBACK_TIME).ok(),
        result => result.ok(),
    };
    mapped.ok_or(Error::CannotWait)?.map_err(|e| Error::Lost(e.to_string()))?;
    Ok(staging.get_mapped_range(..).map_err(|e| Error::Lost(e.to_string()))?.to_vec())
}

/// A buffer's values on their way to the host, which never waits for them.
#[derive(Debug)]
pub(crate) struct Readback {
    staging: wgpu::Buffer,
    state: Arc<AtomicU8>,
}

/// Nothing is on its way; a copy is recorded; the copy can be read.
const IDLE: u8 = 0;
const ON_ITS_WAY: u8 = 1;
const ARRIVED: u8 = 2;

impl Readback {
    pub fn new(gpu: &Gpu, label: &str, size: u64) -> Readback {
        Readback { staging: staging(gpu, label, size), state: Arc::default() }
    }

    /// The words of an earlier frame, if they have arrived since the last call.
    pub fn take<const N: usize>(&self) -> Option<[u32; N]> {
        self.state.compare_exchange(ARRIVED, IDLE, Ordering::AcqRel, Ordering::Acquire).ok()?;
        let bytes = self.staging.get_mapped_range(..);
        let words =
            bytes.ok().map(|b| std::array::from_fn(|i| u32::from_le_bytes(std::array::from_fn(|k| b[4 * i + k]))));
        self.staging.unmap();
        words
    }

    /// Copies the start of a buffer, unless an earlier copy is on its way.
    pub fn send(&self, encoder: &mut wgpu::CommandEncoder, source: &wgpu::Buffer) {
        if self.state.compare_exchange(IDLE, ON_ITS_WAY, Ordering::AcqRel, Ordering::Acquire).is_err() {
            return;
        }
        encoder.copy_buffer_to_buffer(source, 0, &self.staging, 0, self.staging.size());
        let state = self.state.clone();
        encoder.map_buffer_on_submit(&self.staging, wgpu::MapMode::Read, .., move |result| {
            state.store(if result.is_ok() { ARRIVED } else { IDLE }, Ordering::Release);
        });
    }

    /// GPU memory, in bytes.
    pub fn bytes(&self) -> u64 {
        self.staging.size()
    }
}
