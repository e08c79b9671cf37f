//! Pairs of a triangle and a texel: the lists of receivers whose view of the light's centre each triangle may occlude
//! [Pan 2009, section 3.3], found by conservative rasterisation in compute.
//!
//! The candidates of a triangle are all blocks of 8 x 8 texels of its extent, one thread each, so a triangle that fills
//! the map is spread over as many threads as it has blocks. Candidates that pass the test are listed block by block,
//! then texel by texel, and sorted by the length of the texels' lists.
//!
//! *No pair is lost to a small buffer.* Pairs are counted before they are listed. If they exceed the capacity, the same
//! frame evaluates its candidates without lists: the result is the same and takes longer. The counts are read back
//! without waiting, and later frames have that capacity, up to a budget.

use crate::error::Error;
use crate::gpu::bindings::Binding;
use crate::gpu::device::Gpu;
use crate::gpu::readback::read_buffer;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::BufferDescription;
use crate::gpu::shader::ShaderKey;
use crate::input::frame::BoundFrame;
use crate::passes::lists::list_length::ListLength;
use crate::passes::lists::scan::Scan;
use crate::passes::lists::sort::Sort;
use crate::passes::lists::texel_lists::TexelLists;
use crate::passes::triangles::light_triangles::{CenterTriangles, Part};
use crate::{binding_array, bindings, gpu_struct};

gpu_struct! {
    /// The capacity of the lists.
    pub(crate) struct PairLimit {
        pairs: u32,
    }
}

/// Bytes of a triangle-texel pair, with two keys and two values for sorting, and of a triangle-block pair.
const PAIR_BYTES: u64 = (8 + 16) + 12;
/// Pairs of the first frame's lists.
const FIRST_CAPACITY: u32 = 1 << 16;
/// Triangles of a part: 48 MiB.
const MOST_TRIANGLES: u32 = 1 << 20;
/// Bits of the sort keys.
const KEY_BITS: u32 = 4;

/// The capacity of the lists of pairs, learned from the counts of earlier frames.
pub struct PairCapacity {
    pairs: u32,
    most: u32,
    /// Counts of the last frame.
    counts: Option<wgpu::Buffer>,
}

impl PairCapacity {
    /// For lists of about `budget` bytes at most.
    pub fn new(gpu: &Gpu, budget: u64) -> PairCapacity {
        let binding = gpu.device.limits().max_storage_buffer_binding_size / 8;
        let most = (budget / PAIR_BYTES).min(binding).min(1 << 27) as u32;
        PairCapacity { pairs: FIRST_CAPACITY.min(most), most, counts: None }
    }

    /// Ends a frame: requests its counts and takes those of an earlier one.
    pub fn learn(&mut self, recorder: &mut Recorder, pairs: &TrianglePairs) {
        let counts = recorder.read_back::<2>("counts of pairs", &pairs.needed);
        if let Some(needed) = counts.map(|[blocks, texels]| blocks.max(texels)).filter(|n| *n > self.pairs) {
            self.pairs = needed.saturating_add(needed / 4).min(self.most);
        }
        self.counts = Some(pairs.needed.clone());
    }

    /// The most triangle-block and triangle-texel pairs of any part of the last frame, and the capacity. Waits for the
    /// GPU: for tests and reports.
    pub async fn stats(&self, gpu: &Gpu) -> Result<Vec<(&'static str, f64)>, Error> {
        let Some(counts) = &self.counts else { return Ok(Vec::new()) };
        let counts: Vec<u32> = bytemuck::pod_collect_to_vec(&read_buffer(gpu, counts).await?);
        Ok(vec![
            ("triangle-block pairs", f64::from(counts[0])),
            ("triangle-texel pairs", f64::from(counts[1])),
            ("room for pairs", f64::from(self.pairs)),
        ])
    }
}

/// The test of a triangle against the receivers of a texel: a module `pair` with
/// `fn test_list(triangle: LightTriangle, first: u32, end: u32)`, called with a range of entries.
pub struct PairShader<'a> {
    /// [`TrianglePairs::key`] with the module's features. The feature `masked` is on where the material has holes; then
    /// the module may use `shaders/triangles.wesl`.
    pub key: ShaderKey,
    /// Resources of the module, with those of `shaders/frame.wesl` if it uses them.
    pub bindings: &'a [&'a [Binding<'a>]],
}

/// The lists of pairs.
pub struct TrianglePairs {
    parts: Vec<Part>,
    triangles: CenterTriangles,
    first_candidates: wgpu::Buffer,
    candidate_scan: Scan,
    counts: wgpu::Buffer,
    needed: wgpu::Buffer,
    limit: wgpu::Buffer,
    unlisted: ListLength,
    block_pair_length: ListLength,
    block_pairs: wgpu::Buffer,
    texel_counts: wgpu::Buffer,
    pairs: wgpu::Buffer,
    pair_scan: Scan,
    sort: Sort,
}

impl TrianglePairs {
    /// Empty lists for the casters of a frame.
    pub fn new(
        recorder: &mut Recorder,
        frame: &BoundFrame,
        lists: &TexelLists,
        capacity: &PairCapacity,
    ) -> TrianglePairs {
        // The candidates of a part are counted in 32 bits.
        let parts = Part::of(&frame.casters, MOST_TRIANGLES.min((1 << 31) / lists.block_side.pow(2)));
        let triangles = CenterTriangles::new(recorder, &parts);
        let pairs = capacity.pairs;
        let of = |count: u32, bytes: u64| BufferDescription::new(u64::from(count) * bytes);
        TrianglePairs {
            first_candidates: recorder.buffer("first candidates", of(triangles.capacity, 4)),
            candidate_scan: Scan::new(recorder, triangles.capacity),
            parts,
            triangles,
            counts: recorder.buffer("pairs of a part", of(1, 8).cleared()),
            needed: recorder.buffer("most pairs", of(1, 8).cleared()),
            limit: recorder.uniform("capacity for pairs", &PairLimit { pairs }),
            unlisted: ListLength::new(recorder, "number of unlisted candidates"),
            block_pair_length: ListLength::new(recorder, "number of triangle-block pairs"),
            block_pairs: recorder.buffer("triangle-block pairs", of(pairs, 8)),
            texel_counts: recorder.buffer("texels of pairs", of(pairs, 4)),
            pairs: recorder.buffer("triangle-texel pairs", of(pairs, 8)),
            pair_scan: Scan::new(recorder, pairs),
            sort: Sort::new(recorder, pairs),
        }
    }

    /// The shader that evaluates pairs with the module at `part`.
    pub fn key(part: &'static str) -> ShaderKey {
        ShaderKey::new("passes::triangles::triangle_pairs::evaluate").part("pair", part)
    }

    /// Calls the shader for each triangle and each list of receivers whose view of the light's centre it may occlude.
    pub fn record(
        &self,
        recorder: &mut Recorder,
        frame: &BoundFrame,
        lists: &TexelLists,
        shader: &PairShader,
    ) -> Result<(), Error> {
        for part in &self.parts {
            let length = self.triangles.record(recorder, frame, part)?;
            self.find(recorder, frame, lists, &length)?;
            self.evaluate(recorder, frame, lists, (part, &length), shader)?;
        }
        Ok(())
    }

    /// The triangles of a part and their candidates.
    fn candidates<'a>(&'a self, triangles: &'a ListLength) -> [Binding<'a>; 4] {
        binding_array! {
            triangles: &self.triangles.buffer,
            triangle_length: &triangles.0,
            first_candidates: &self.first_candidates,
            candidate_length: &self.candidate_scan.total.0,
        }
    }

    /// Counts the candidates, tests them, and lists the pairs.
    fn find(
        &self,
        recorder: &mut Recorder,
        frame: &BoundFrame,
        lists: &TexelLists,
        length: &ListLength,
    ) -> Result<(), Error> {
        let pipeline = |key: &ShaderKey, entry| recorder.gpu.compute_pipeline(key, entry);
        let module = ShaderKey::new;
        let count = pipeline(&module("passes::triangles::triangle_pairs::count"), "count_candidates")?;
        let test = pipeline(&module("passes::triangles::triangle_pairs::test"), "test_candidates")?;
        let plan = pipeline(&module("passes::triangles::triangle_pairs::plan"), "plan")?;
        let write = pipeline(&module("passes::triangles::triangle_pairs::write"), "write_pairs")?;
        let (frame, candidates) = (frame.bindings(), self.candidates(length));
        let [triangles, triangle_length, _, candidate_length] = candidates.clone();
        let map = bindings! { texel_map: &lists.uniform };

        let label = "triangle-block pairs";
        let own: [&[_]; 2] =
            [&[triangles.clone(), triangle_length], bindings! { candidate_counts: &self.first_candidates }];
        recorder.compute(label, &count, &[&frame, map, own[0], own[1]], length.work())?;
        self.candidate_scan.record(recorder, label, length, &self.first_candidates)?;
        let own = bindings! {
            blocks: &lists.blocks,
            block_pairs: &self.block_pairs,
            texel_counts: &self.texel_counts,
            pair_counts: &self.counts,
        };
        let work = self.candidate_scan.total.work();
        recorder.compute(label, &test, &[&frame, map, &candidates, own], work)?;
        let own = bindings! {
            pair_counts: &self.counts,
            block_pair_length: &self.block_pair_length.0,
            unlisted_length: &self.unlisted.0,
            limit: &self.limit,
            needed: &self.needed,
        };
        recorder.compute(label, &plan, &[own, &[candidate_length]], Work::Groups([1, 1, 1]))?;

        let label = "triangle-texel pairs";
        self.pair_scan.record(recorder, label, &self.block_pair_length, &self.texel_counts)?;
        let own = bindings! {
            block_pair_length: &self.block_pair_length.0,
            block_pairs: &self.block_pairs,
            first_pairs: &self.texel_counts,
            blocks: &lists.blocks,
            pairs: &self.pairs,
        };
        recorder.compute(label, &write, &[&frame, map, own, &[triangles]], self.block_pair_length.work())
    }

    /// Sorts the pairs and evaluates them, and the candidates if pairs exceed the capacity.
    fn evaluate(
        &self,
        recorder: &mut Recorder,
        frame: &BoundFrame,
        lists: &TexelLists,
        (part, length): (&Part, &ListLength),
        shader: &PairShader,
    ) -> Result<(), Error> {
        let key = ShaderKey::new("passes::triangles::triangle_pairs::keys");
        let keys = recorder.gpu.compute_pipeline(&key, "write_keys")?;
        let pair_length = &self.pair_scan.total;
        let pairs = binding_array! { pair_length: &pair_length.0, pairs: &self.pairs };
        let own = bindings! { ends: &lists.ends, keys: &self.sort.input.keys, indices: &self.sort.input.values };
        recorder.compute("order of pairs", &keys, &[&pairs, own], pair_length.work())?;
        let sorted = self.sort.record(recorder, "order of pairs", pair_length, KEY_BITS)?;

        let batch = part.masked.map(|index| frame.casters.batches[index].bindings(&frame.casters));
        let key = shader.key.clone().feature("masked", batch.is_some());
        let listed = recorder.gpu.compute_pipeline(&key, "evaluate")?;
        let unlisted = recorder.gpu.compute_pipeline(&key.feature("unlisted", true), "evaluate")?;
        let (frame, lists_of) = (frame.bindings(), lists.bindings());
        let mut shared = vec![&lists_of[..]];
        shared.extend_from_slice(shader.bindings);
        shared.extend(batch.as_ref().map(|batch| &batch[..]));
        let label = "shadow tests";
        let own = bindings! { triangles: &self.triangles.buffer, order: &sorted.values };
        recorder.compute(label, &listed, &[&shared[..], &[&pairs, own]].concat(), pair_length.work())?;
        let map = bindings! { texel_map: &lists.uniform, blocks: &lists.blocks };
        let own: [&[_]; 3] = [&frame, &self.candidates(length), map];
        recorder.compute(label, &unlisted, &[&shared[..], &own].concat(), self.unlisted.work())
    }
}
