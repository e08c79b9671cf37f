//! What the GPU needed, learned by the host some frames later and without waiting: buffers grow by it.

use crate::recorder::Recorder;
use crate::{Gpu, resource::storage_buffer};
use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

/// Counts that come back from the GPU when it gets there.
pub struct Growth {
    /// The counts, `u32` each, for shaders to raise.
    pub counts: wgpu::Buffer,
    staging: wgpu::Buffer,
    state: Arc<AtomicU8>,
}

/// Nothing is on its way; a copy was recorded; the copy can be read.
const IDLE: u8 = 0;
const ON_ITS_WAY: u8 = 1;
const ARRIVED: u8 = 2;

impl Growth {
    /// For so many counts, which are 0 at first.
    pub fn new(gpu: &Gpu, label: &str, count: u32) -> Growth {
        let counts = storage_buffer(gpu, label, u64::from(count) * 4);
        let staging = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: counts.size(),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        Growth { counts, staging, state: Arc::default() }
    }

    /// The counts of an earlier frame, if they have come since the last call. Never waits: they come when the host
    /// submits or polls after the GPU is done.
    pub fn take(&self) -> Option<Vec<u32>> {
        self.state.compare_exchange(ARRIVED, IDLE, Ordering::AcqRel, Ordering::Acquire).ok()?;
        let counts = self.staging.get_mapped_range(..).ok().map(|bytes| bytemuck::pod_collect_to_vec(&bytes));
        self.staging.unmap();
        counts
    }

    /// Sends the counts on their way, unless earlier ones still are.
    pub fn record(&self, recorder: &mut Recorder) {
        if self.state.compare_exchange(IDLE, ON_ITS_WAY, Ordering::AcqRel, Ordering::Acquire).is_err() {
            return;
        }
        recorder.encoder.copy_buffer_to_buffer(&self.counts, 0, &self.staging, 0, self.staging.size());
        let state = self.state.clone();
        recorder.encoder.map_buffer_on_submit(&self.staging, wgpu::MapMode::Read, .., move |result| {
            state.store(if result.is_ok() { ARRIVED } else { IDLE }, Ordering::Release);
        });
    }

    /// GPU memory, in bytes.
    pub fn bytes(&self) -> u64 {
        self.counts.size() + self.staging.size()
    }
}
