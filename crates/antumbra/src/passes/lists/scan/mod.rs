//! Prefix sums over lists whose length only the GPU knows: from counts to offsets [Blelloch 1990].

use crate::bindings;
use crate::error::Error;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::BufferDescription;
use crate::gpu::shader::ShaderKey;
use crate::passes::lists::list_length::ListLength;

/// Elements that a workgroup processes at once.
const BLOCK: u32 = 1024;

/// Number of workgroups for a list of at most `count` elements: several for each core of the largest GPUs, none idle,
/// and their sums fit one block.
pub(crate) fn runs_of(capacity: u32) -> u32 {
    capacity.div_ceil(BLOCK).clamp(1, BLOCK)
}

/// Replaces each number of a list by the sum of those before it. Three dispatches whatever the length.
pub struct Scan {
    /// The sum of all numbers of the last list, as a length.
    pub total: ListLength,
    run_sums: wgpu::Buffer,
    runs: u32,
}

impl Scan {
    /// For lists of at most `capacity` numbers.
    pub fn new(recorder: &mut Recorder, capacity: u32) -> Scan {
        let runs = runs_of(capacity);
        Scan {
            total: ListLength::new(recorder, "total of a scan"),
            run_sums: recorder.buffer("sums of runs", BufferDescription::new(u64::from(runs) * 4)),
            runs,
        }
    }

    /// Scans the first `length` of `values` (`u32`) in place. Sums wrap around at 2^32.
    pub fn record(
        &self,
        recorder: &mut Recorder,
        label: &'static str,
        length: &ListLength,
        values: &wgpu::Buffer,
    ) -> Result<(), Error> {
        let key = ShaderKey::new("passes::lists::scan::scan");
        let set = bindings! { length: &length.0, values: values, run_sums: &self.run_sums, total: &self.total.0 };
        for (entry, groups) in [("reduce", self.runs), ("scan_runs", 1), ("scan", self.runs)] {
            let pipeline = recorder.gpu.compute_pipeline(&key, entry)?;
            recorder.compute(label, &pipeline, &[set], Work::Groups([groups, 1, 1]))?;
        }
        Ok(())
    }
}
