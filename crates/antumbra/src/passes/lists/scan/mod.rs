//! Prefix sums over lists whose length only the GPU knows: from counts to places [Blelloch 1990].

use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::{buffer_of, storage_buffer};
use crate::gpu::shader::ShaderKey;
use crate::error::Error;
use crate::gpu::device::Gpu;
use crate::bindings;

/// The length of a list on the GPU, 16 bytes: arguments of an indirect dispatch of 64 elements a workgroup, then the
/// count. Passes read it as a uniform or as storage.
#[derive(Clone, Debug)]
pub struct ListLength(pub wgpu::Buffer);

impl ListLength {
    /// Of an empty list, which a pass will count.
    pub fn unknown(gpu: &Gpu, label: &str) -> ListLength {
        ListLength::of_words(gpu, label, [0, 1, 1, 0])
    }

    /// Of a list that the host knows.
    pub fn known(gpu: &Gpu, label: &str, count: u32) -> ListLength {
        let groups = count.div_ceil(64);
        ListLength::of_words(gpu, label, [groups.min(1 << 15), groups.div_ceil(1 << 15), 1, count])
    }

    fn of_words(gpu: &Gpu, label: &str, words: [u32; 4]) -> ListLength {
        let usage = wgpu::BufferUsages::STORAGE
            | wgpu::BufferUsages::UNIFORM
            | wgpu::BufferUsages::INDIRECT
            | wgpu::BufferUsages::COPY_SRC
            | wgpu::BufferUsages::COPY_DST;
        ListLength(buffer_of(gpu, label, bytemuck::cast_slice(&words), usage))
    }

    /// A dispatch over the list.
    pub fn work(&self) -> Work<'_> {
        Work::Indirect(&self.0, 0)
    }
}

/// Elements that a workgroup looks at at once.
pub(crate) const BLOCK: u32 = 1024;

/// How many workgroups go over a list of at most so many elements: several for each core of the largest GPUs, and none
/// in vain. The scan of their sums is one block.
pub(crate) fn runs_of(capacity: u32) -> u32 {
    capacity.div_ceil(BLOCK).clamp(1, BLOCK)
}

/// Replaces each of a list's numbers by the sum of those before it. Three dispatches whatever the length.
pub struct Scan {
    run_sums: wgpu::Buffer,
    runs: u32,
}

impl Scan {
    /// For lists of at most `capacity` numbers.
    pub fn new(gpu: &Gpu, capacity: u32) -> Scan {
        let runs = runs_of(capacity);
        Scan { run_sums: storage_buffer(gpu, "sums of runs", u64::from(runs) * 4), runs }
    }

    /// Scans the first `length` of `values` (`u32`) in place and writes their sum to `total`. A sum over 2^32 wraps
    /// around.
    pub fn record(
        &self,
        recorder: &mut Recorder,
        label: &str,
        length: &ListLength,
        values: &wgpu::Buffer,
        total: &ListLength,
    ) -> Result<(), Error> {
        let key = ShaderKey::new("passes::lists::scan::scan");
        let set = bindings! { length: &length.0, values: values, run_sums: &self.run_sums, total: &total.0 };
        for (entry, groups) in [("reduce", self.runs), ("scan_runs", 1), ("scan", self.runs)] {
            let pipeline = recorder.gpu.compute_pipeline(&key, entry)?;
            recorder.compute(label, &pipeline, set, Work::Groups([groups, 1, 1]));
        }
        Ok(())
    }

    /// GPU memory, in bytes.
    pub fn bytes(&self) -> u64 {
        self.run_sums.size()
    }
}
