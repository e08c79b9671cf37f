//! The length of a list that only the GPU knows.

use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::BufferDescription;

/// 16 bytes: the arguments of an indirect dispatch of 64 elements per workgroup, then the number of elements; see
/// `shaders/list_length.wesl`. Shaders read it as a uniform or as storage.
#[derive(Clone, Debug)]
pub struct ListLength(pub wgpu::Buffer);

impl ListLength {
    /// A length that a pass writes.
    pub fn new(recorder: &mut Recorder, label: &'static str) -> ListLength {
        ListLength(recorder.buffer(label, BufferDescription::new(16)))
    }

    /// A length that passes count up: 0 at the start of each frame.
    pub fn counted(recorder: &mut Recorder, label: &'static str) -> ListLength {
        ListLength(recorder.buffer(label, BufferDescription::new(16).cleared()))
    }

    /// The length of a list that the host knows.
    pub fn known(recorder: &mut Recorder, label: &'static str, count: u32) -> ListLength {
        let bytes = || bytemuck::cast_slice(&ListLength::words(count)).to_vec();
        ListLength(recorder.buffer_of_key(label, &count.to_le_bytes(), bytes))
    }

    /// The contents for this number of elements.
    pub fn words(count: u32) -> [u32; 4] {
        let groups = count.div_ceil(64);
        [groups.min(1 << 15), groups.div_ceil(1 << 15), 1, count]
    }

    /// A dispatch over the list.
    pub fn work(&self) -> Work<'_> {
        Work::Indirect(&self.0, 0)
    }
}
