//! Sorting by 32-bit keys: a radix sort of four bits at a time, of lists whose length only the GPU knows.

use crate::error::Error;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::{BufferDescription, UniformArray};
use crate::gpu::shader::ShaderKey;
use crate::passes::lists::list_length::ListLength;
use crate::passes::lists::scan::{Scan, runs_of};
use crate::{bindings, gpu_struct};

gpu_struct! {
    /// The digit that a pass sorts by.
    pub(crate) struct SortUniform {
        /// Its lowest bit.
        shift: u32,
    }
}

/// Bits of a digit, and the number of its values.
const DIGIT_BITS: u32 = 4;
const DIGITS: u32 = 1 << DIGIT_BITS;

/// Keys and their values, each `u32`.
pub struct Keyed {
    /// Sort keys.
    pub keys: wgpu::Buffer,
    /// The value of each key.
    pub values: wgpu::Buffer,
}

/// Sorts keys with their values, the smallest key first; the order of equal keys is kept.
pub struct Sort {
    /// The input of [`Sort::record`], then its intermediate results.
    pub input: Keyed,
    other: Keyed,
    offsets: wgpu::Buffer,
    offset_count: ListLength,
    scan: Scan,
    digits: UniformArray,
    runs: u32,
}

impl Sort {
    /// For lists of at most `capacity` elements.
    pub fn new(recorder: &mut Recorder, capacity: u32) -> Sort {
        let runs = runs_of(capacity);
        let mut buffer = |label, words: u32| recorder.buffer(label, BufferDescription::new(u64::from(words) * 4));
        let mut keyed = || Keyed { keys: buffer("keys", capacity), values: buffer("values", capacity) };
        Sort {
            input: keyed(),
            other: keyed(),
            offsets: buffer("offsets of digits", runs * DIGITS),
            offset_count: ListLength::known(recorder, "number of offsets", runs * DIGITS),
            scan: Scan::new(recorder, runs * DIGITS),
            digits: recorder
                .uniforms("digits", (0..32).step_by(DIGIT_BITS as usize).map(|shift| SortUniform { shift })),
            runs,
        }
    }

    /// Sorts the first `length` elements by the lowest `bits` of their keys, all others being 0; returns the result.
    pub fn record(
        &self,
        recorder: &mut Recorder,
        label: &'static str,
        length: &ListLength,
        bits: u32,
    ) -> Result<&Keyed, Error> {
        let key = ShaderKey::new("passes::lists::sort::sort");
        let count = recorder.gpu.compute_pipeline(&key, "count_digits")?;
        let move_elements = recorder.gpu.compute_pipeline(&key, "move_elements")?;
        let (mut source, mut target) = (&self.input, &self.other);
        for i in 0..bits.min(32).div_ceil(DIGIT_BITS) {
            let digit = self.digits.at(i);
            let set = bindings! {
                length: &length.0,
                digit: &digit,
                keys: &source.keys,
                payload: &source.values,
                offsets: &self.offsets,
                sorted_keys: &target.keys,
                sorted_payload: &target.values,
            };
            recorder.compute(label, &count, &[set], Work::Groups([self.runs, 1, 1]))?;
            self.scan.record(recorder, label, &self.offset_count, &self.offsets)?;
            recorder.compute(label, &move_elements, &[set], Work::Groups([self.runs, 1, 1]))?;
            (source, target) = (target, source);
        }
        Ok(source)
    }
}
