//! Stream compaction: keeps some elements of a list whose length only the GPU knows.

use crate::bindings;
use crate::error::Error;
use crate::gpu::recorder::Recorder;
use crate::gpu::shader::ShaderKey;
use crate::passes::lists::list_length::ListLength;
use crate::passes::lists::scan::Scan;

/// The type of a list's elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Element {
    /// `u32`.
    Word,
    /// `vec2<u32>`.
    Pair,
}

/// A list and its compaction.
pub struct Compaction<'a> {
    /// Type of its elements.
    pub element: Element,
    /// The list.
    pub elements: &'a wgpu::Buffer,
    /// Its length.
    pub length: &'a ListLength,
    /// For each element 1 if it is kept, else 0 (`u32`). Overwritten by the offsets of the kept elements.
    pub flags: &'a wgpu::Buffer,
    /// Receives the kept elements in their order: another buffer, large enough for all of them.
    pub compacted: &'a wgpu::Buffer,
}

impl Compaction<'_> {
    /// Copies the kept elements; returns their number.
    pub fn record(&self, recorder: &mut Recorder, label: &'static str) -> Result<ListLength, Error> {
        let scan = Scan::new(recorder, (self.flags.size() / 4) as u32);
        scan.record(recorder, label, self.length, self.flags)?;
        let key = ShaderKey::new("passes::lists::compact").feature("pairs", self.element == Element::Pair);
        let compact = recorder.gpu.compute_pipeline(&key, "compact")?;
        let set = bindings! {
            length: &self.length.0,
            offsets: self.flags,
            kept: &scan.total.0,
            elements: self.elements,
            compacted: self.compacted,
        };
        recorder.compute(label, &compact, &[set], self.length.work())?;
        Ok(scan.total)
    }
}
