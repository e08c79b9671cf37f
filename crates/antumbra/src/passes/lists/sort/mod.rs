//! Sorting on the GPU by 32-bit keys: a radix sort of four bits at a time, whose lists' length only the GPU knows.

use crate::passes::lists::scan::{ListLength, Scan, runs_of};
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::{UniformArray, storage_buffer};
use crate::gpu::shader::ShaderKey;
use crate::error::Error;
use crate::gpu::device::Gpu;
use crate::{bindings, gpu_struct};

gpu_struct! {
    /// Which bits of the keys are looked at.
    pub(crate) struct SortUniform {
        shift: u32,
    }
}

/// Bits of a digit, and the values that it may take.
const DIGIT_BITS: u32 = 4;
const DIGITS: u32 = 1 << DIGIT_BITS;

/// Keys and what belongs to them, each `u32`.
pub struct Keyed {
    /// What is sorted by.
    pub keys: wgpu::Buffer,
    /// What goes with each key.
    pub values: wgpu::Buffer,
}

impl Keyed {
    fn new(gpu: &Gpu, capacity: u32) -> Keyed {
        let buffer = |label| storage_buffer(gpu, label, u64::from(capacity) * 4);
        Keyed { keys: buffer("keys"), values: buffer("values") }
    }

    fn bytes(&self) -> u64 {
        self.keys.size() + self.values.size()
    }
}

/// Sorts keys with their values, the smallest key first; equal keys keep their order.
pub struct Sort {
    lists: [Keyed; 2],
    places: wgpu::Buffer,
    place_count: ListLength,
    moved: ListLength,
    scan: Scan,
    digits: UniformArray<SortUniform>,
    runs: u32,
}

impl Sort {
    /// For lists of at most `capacity` elements.
    pub fn new(gpu: &Gpu, capacity: u32) -> Sort {
        let runs = runs_of(capacity);
        let digits: Vec<_> = (0..32 / DIGIT_BITS).map(|i| SortUniform { shift: i * DIGIT_BITS }).collect();
        Sort {
            lists: [Keyed::new(gpu, capacity), Keyed::new(gpu, capacity)],
            places: storage_buffer(gpu, "places of digits", u64::from(runs * DIGITS) * 4),
            place_count: ListLength::known(gpu, "number of places", runs * DIGITS),
            moved: ListLength::unknown(gpu, "moved elements"),
            scan: Scan::new(gpu, runs * DIGITS),
            digits: UniformArray::new(gpu, "digits", &digits),
            runs,
        }
    }

    /// What is to be sorted is written here before [`Sort::record`].
    pub fn input(&self) -> &Keyed {
        &self.lists[0]
    }

    /// Sorts the first `length` elements by the lowest `bits` of their keys, all others being 0, and returns where the
    /// result lies.
    pub fn record(
        &self,
        recorder: &mut Recorder,
        label: &str,
        length: &ListLength,
        bits: u32,
    ) -> Result<&Keyed, Error> {
        let key = ShaderKey::new("passes::lists::sort::sort");
        let count = recorder.gpu.compute_pipeline(&key, "count_digits")?;
        let move_elements = recorder.gpu.compute_pipeline(&key, "move_elements")?;
        let passes = bits.min(32).div_ceil(DIGIT_BITS);
        for i in 0..passes {
            let (source, target) = (&self.lists[i as usize % 2], &self.lists[(i as usize + 1) % 2]);
            let digit = self.digits.at(i);
            let set = bindings! {
                length: &length.0,
                digit: &digit,
                keys: &source.keys,
                payload: &source.values,
                places: &self.places,
                sorted_keys: &target.keys,
                sorted_payload: &target.values,
            };
            recorder.compute(label, &count, set, Work::Groups([self.runs, 1, 1]));
            self.scan.record(recorder, label, &self.place_count, &self.places, &self.moved)?;
            recorder.compute(label, &move_elements, set, Work::Groups([self.runs, 1, 1]));
        }
        Ok(&self.lists[passes as usize % 2])
    }

    /// GPU memory, in bytes.
    pub fn bytes(&self) -> u64 {
        let lists: u64 = self.lists.iter().map(Keyed::bytes).sum();
        lists + self.places.size() + self.scan.bytes()
    }
}
