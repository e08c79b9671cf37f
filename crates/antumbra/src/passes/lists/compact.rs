//! Keeps some elements of a list whose length only the GPU knows.

use crate::passes::lists::scan::{ListLength, Scan};
use crate::gpu::recorder::Recorder;
use crate::gpu::shader::ShaderKey;
use crate::error::Error;
use crate::gpu::device::Gpu;
use crate::bindings;

/// What a list is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Element {
    /// `u32`.
    Word,
    /// `vec2<u32>`.
    Pair,
}

/// Moves what is kept to the front of another list, in its order.
pub struct Compact {
    scan: Scan,
}

/// A list and where it is moved to.
pub struct Compaction<'a> {
    /// What it is made of.
    pub element: Element,
    /// The list.
    pub elements: &'a wgpu::Buffer,
    /// Its length.
    pub length: &'a ListLength,
    /// For each element 1 if it is kept, else 0 (`u32`). Overwritten by the places of what is kept.
    pub flags: &'a wgpu::Buffer,
    /// Where what is kept goes: another buffer, as large as can be needed.
    pub compacted: &'a wgpu::Buffer,
    /// Its length.
    pub kept: &'a ListLength,
}

impl Compact {
    /// For lists of at most `capacity` elements.
    pub fn new(gpu: &Gpu, capacity: u32) -> Compact {
        Compact { scan: Scan::new(gpu, capacity) }
    }

    /// Compacts a list.
    pub fn record(&self, recorder: &mut Recorder, label: &str, list: &Compaction) -> Result<(), Error> {
        self.scan.record(recorder, label, list.length, list.flags, list.kept)?;
        let key = ShaderKey::new("passes::lists::compact").feature("pairs", list.element == Element::Pair);
        let compact = recorder.gpu.compute_pipeline(&key, "compact")?;
        let set = bindings! {
            length: &list.length.0,
            places: list.flags,
            kept: &list.kept.0,
            elements: list.elements,
            compacted: list.compacted,
        };
        recorder.compute(label, &compact, set, list.length.work());
        Ok(())
    }

    /// GPU memory, in bytes.
    pub fn bytes(&self) -> u64 {
        self.scan.bytes()
    }
}
