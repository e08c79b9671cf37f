//! Pairs of a triangle and a texel: which lists of receivers each triangle may hide from the light's centre
//! [Pan 2009, section 3.3], found by rasterising triangles conservatively in compute.
//!
//! A triangle's candidates are all blocks of 8 x 8 texels of its extent. They are counted, and looked at by a thread each,
//! so a triangle that fills the map is spread over as many threads as it has blocks. What is left is listed block by
//! block, then texel by texel, and ordered by the length of the texels' lists.
//!
//! *Nothing is lost where there is no room.* Pairs are counted before they are listed. Where they exceed the buffers, the
//! same frame looks at its candidates once more, without lists; the result is the same and comes later. The counts travel
//! to the host without being waited for, and the buffers of a later frame are as large as they say, up to a budget.

use crate::input::frame::{Frame, FrameUniform};
use crate::gpu::growth::Growth;
use crate::passes::triangles::light_triangles::{LightTriangles, Part, Reach};
use crate::passes::lists::scan::{ListLength, Scan};
use crate::passes::lists::sort::Sort;
use crate::passes::lists::texel_lists::{TexelLists, TexelMap};
use crate::gpu::pipeline::{Binding, ComputePipeline};
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::{storage_buffer, uniform};
use crate::gpu::shader::ShaderKey;
use crate::technique::Memory;
use crate::error::Error;
use crate::gpu::device::Gpu;
use crate::{bindings, gpu_struct};
use crate::input::casters::BatchLayout;
use std::sync::Arc;

gpu_struct! {
    /// How much can be listed.
    pub(crate) struct PairRoom {
        block_pairs: u32,
        pairs: u32,
    }
}

/// Bytes that a pair takes, with its two keys and places for sorting.
const PAIR_BYTES: u64 = 8 + 16;
/// Bytes that a triangle with a block takes.
const BLOCK_PAIR_BYTES: u64 = 12;

/// Pairs that there is room for at first.
const FIRST_ROOM: u32 = 1 << 16;

/// Triangles that are held in light space at once: 48 MiB of them.
const MOST_TRIANGLES: u32 = 1 << 20;

/// Lists of one size.
struct Lists {
    room: u32,
    room_uniform: wgpu::Buffer,
    block_pairs: wgpu::Buffer,
    texel_counts: wgpu::Buffer,
    pairs: wgpu::Buffer,
    scan: Scan,
    sort: Sort,
}

impl Lists {
    fn new(gpu: &Gpu, room: u32) -> Lists {
        let buffer = |label, bytes: u64| storage_buffer(gpu, label, u64::from(room) * bytes);
        Lists {
            room,
            room_uniform: uniform(gpu, "room for pairs", &PairRoom { block_pairs: room, pairs: room }),
            block_pairs: buffer("pairs of triangle and block", 8),
            texel_counts: buffer("texels of pairs", 4),
            pairs: buffer("pairs of triangle and texel", 8),
            scan: Scan::new(gpu, room),
            sort: Sort::new(gpu, room),
        }
    }

    fn bytes(&self) -> u64 {
        let own = [&self.block_pairs, &self.texel_counts, &self.pairs];
        own.iter().map(|b| b.size()).sum::<u64>() + self.scan.bytes() + self.sort.bytes()
    }
}

/// Finds the pairs and has a technique look at each.
pub struct TrianglePairs {
    triangles: LightTriangles,
    first_candidates: wgpu::Buffer,
    candidate_scan: Scan,
    counts: wgpu::Buffer,
    candidates: ListLength,
    block_pairs: ListLength,
    pairs: ListLength,
    unlisted: ListLength,
    lists: Lists,
    growth: Growth,
    most_pairs: u32,
}

/// What is done with a list of receivers and a triangle: a module `pair` with
/// `fn look_at_list(triangle: LightTriangle, first: u32, end: u32)`, which is handed the places of a list among all
/// entries.
pub struct Look<'a> {
    /// [`TrianglePairs::key`] with what the module shares with the host. Where a material has holes the feature `masked`
    /// is on and group 1 is that of `shaders/triangles.wesl`.
    pub key: ShaderKey,
    /// What the module binds, from slot 24 on.
    pub bindings: &'a [Binding<'a>],
    /// Label of the pass.
    pub label: &'static str,
}

impl TrianglePairs {
    /// The parts that the triangles of a frame are taken in, so few that candidates can be counted in 32 bits.
    pub fn parts(frame: &Frame, lists: &TexelLists) -> Vec<Part> {
        let blocks = lists.block_side() * lists.block_side();
        LightTriangles::parts(&frame.casters, MOST_TRIANGLES.min((1 << 31) / blocks))
    }

    /// For these parts; lists take at most about `budget` bytes.
    pub fn new(gpu: &Gpu, parts: &[Part], budget: u64) -> TrianglePairs {
        let triangles = LightTriangles::new(gpu, parts, Reach::Center);
        let capacity = triangles.capacity();
        let binding = gpu.device.limits().max_storage_buffer_binding_size / 8;
        let most_pairs = (budget / (PAIR_BYTES + BLOCK_PAIR_BYTES)).min(binding).min(1 << 27) as u32;
        let length = |label| ListLength::unknown(gpu, label);
        TrianglePairs {
            triangles,
            first_candidates: storage_buffer(gpu, "first candidates", u64::from(capacity) * 4),
            candidate_scan: Scan::new(gpu, capacity),
            counts: storage_buffer(gpu, "counts of pairs", 16),
            candidates: length("number of candidates"),
            block_pairs: length("number of block pairs"),
            pairs: length("number of pairs"),
            unlisted: length("number of unlisted candidates"),
            lists: Lists::new(gpu, FIRST_ROOM.min(most_pairs)),
            growth: Growth::new(gpu, "needed room for pairs", 4),
            most_pairs,
        }
    }

    /// Makes one in `slot` unless one is there that these parts fit into.
    pub fn ensure<'a>(
        slot: &'a mut Option<TrianglePairs>,
        gpu: &Gpu,
        parts: &[Part],
        budget: u64,
    ) -> &'a mut TrianglePairs {
        if slot.as_ref().is_none_or(|p| p.triangles.capacity() != LightTriangles::capacity_for(parts)) {
            *slot = None; // Frees the old lists before the new ones are made.
            *slot = Some(TrianglePairs::new(gpu, parts, budget));
        }
        slot.as_mut().expect("just made")
    }

    /// Makes room for what earlier frames have been found to need, as far as the budget goes.
    fn grow(&mut self, gpu: &Gpu) {
        let Some(needed) = self.growth.take() else { return };
        let needed = needed[0].max(needed[1]);
        if needed > self.lists.room && self.lists.room < self.most_pairs {
            self.lists = Lists::new(gpu, needed.saturating_add(needed / 4).min(self.most_pairs));
        }
    }

    /// Has `look` called for every triangle and every list of `lists` that it may hide from the light's centre.
    pub fn record(
        &mut self,
        recorder: &mut Recorder,
        frame: &Frame,
        lists: &TexelLists,
        parts: &[Part],
        look: &Look,
    ) -> Result<(), Error> {
        self.grow(recorder.gpu);
        for part in parts {
            self.triangles.record(recorder, frame, part)?;
            self.find_pairs(recorder, frame, lists)?;
            self.look_at_pairs(recorder, frame, lists, part, look)?;
        }
        self.growth.record(recorder);
        Ok(())
    }

    /// Counts the candidates, tests them, and lists what is left.
    fn find_pairs(&self, recorder: &mut Recorder, frame: &Frame, texels: &TexelLists) -> Result<(), Error> {
        let gpu = recorder.gpu;
        let pipeline = |module, entry| gpu.compute_pipeline(&key_of(module), entry);
        let shapes = frame.bindings(bindings! {
            texel_map: &texels.uniform,
            triangle_length: &self.triangles.length.0,
            triangles: &self.triangles.buffer,
        });
        let label = "triangle-block pairs";
        let count = pipeline("passes::triangles::triangle_pairs::count", "count_candidates")?;
        let set = joined(&shapes, bindings! { candidate_counts: &self.first_candidates });
        recorder.compute(label, &count, &set, self.triangles.length.work());
        let [length, first] = [&self.triangles.length, &self.candidates];
        self.candidate_scan.record(recorder, label, length, &self.first_candidates, first)?;
        recorder.encoder.clear_buffer(&self.counts, 0, None);
        let test = pipeline("passes::triangles::triangle_pairs::test", "test_candidates")?;
        let set = joined(
            &shapes,
            bindings! {
                first_candidates: &self.first_candidates,
                candidate_length: &self.candidates.0,
                blocks: &texels.blocks,
                block_pairs: &self.lists.block_pairs,
                texel_counts: &self.lists.texel_counts,
                pair_counts: &self.counts,
            },
        );
        recorder.compute(label, &test, &set, self.candidates.work());
        let plan = pipeline("passes::triangles::triangle_pairs::plan", "plan")?;
        let set = bindings! {
            pair_counts: &self.counts,
            candidate_length: &self.candidates.0,
            block_pair_length: &self.block_pairs.0,
            unlisted_length: &self.unlisted.0,
            room: &self.lists.room_uniform,
            needed: &self.growth.counts,
        };
        recorder.compute(label, &plan, set, Work::Groups([1, 1, 1]));
        let label = "triangle-texel pairs";
        let lists = &self.lists;
        lists.scan.record(recorder, label, &self.block_pairs, &lists.texel_counts, &self.pairs)?;
        let write = pipeline("passes::triangles::triangle_pairs::write", "write_pairs")?;
        let set = joined(
            &shapes,
            bindings! {
                block_pair_length: &self.block_pairs.0,
                block_pairs: &lists.block_pairs,
                first_pairs: &lists.texel_counts,
                blocks: &texels.blocks,
                pairs: &lists.pairs,
            },
        );
        recorder.compute(label, &write, &set, self.block_pairs.work());
        Ok(())
    }

    /// Orders the pairs and hands them on, and what could not be listed.
    fn look_at_pairs(
        &self,
        recorder: &mut Recorder,
        frame: &Frame,
        texels: &TexelLists,
        part: &Part,
        look: &Look,
    ) -> Result<(), Error> {
        let gpu = recorder.gpu;
        let lists = &self.lists;
        let keys = gpu.compute_pipeline(&key_of("passes::triangles::triangle_pairs::keys"), "write_keys")?;
        let set = bindings! {
            pair_length: &self.pairs.0,
            pairs: &lists.pairs,
            ends: &texels.ends,
            keys: &lists.sort.input().keys,
            places: &lists.sort.input().values,
        };
        recorder.compute("order of pairs", &keys, set, self.pairs.work());
        let sorted = lists.sort.record(recorder, "order of pairs", &self.pairs, KEY_BITS)?;
        let batch = part.masked.map(|index| &frame.casters.batches[index]);
        let evaluate = |unlisted: bool| -> Result<Arc<ComputePipeline>, Error> {
            let features = |key: ShaderKey| key.feature("masked", batch.is_some()).feature("unlisted", unlisted);
            gpu.compute_pipeline(&features(look.key.clone()), "evaluate")
        };
        let set = frame.bindings(
            &[
                &texels.bindings()[..],
                look.bindings,
                bindings! {
                    triangle_length: &self.triangles.length.0,
                    triangles: &self.triangles.buffer,
                    first_candidates: &self.first_candidates,
                    candidate_length: &self.candidates.0,
                    pair_length: &self.pairs.0,
                    pairs: &lists.pairs,
                    order: &sorted.values,
                },
            ]
            .concat(),
        );
        let batch = batch.map(|b| b.bindings(&frame.casters));
        for (pipeline, length) in [(evaluate(false)?, &self.pairs), (evaluate(true)?, &self.unlisted)] {
            recorder.compute_pass(look.label, |gpu, pass| {
                pass.set_pipeline(&pipeline.pipeline);
                pass.set_bind_group(0, &pipeline.bind_group(gpu, 0, &set), &[]);
                if let Some(batch) = &batch {
                    pass.set_bind_group(1, &pipeline.bind_group(gpu, 1, batch), &[]);
                }
                crate::gpu::recorder::dispatch(pass, &pipeline, length.work());
            });
        }
        Ok(())
    }

    /// The shader that looks at pairs with this module, to be extended by what the module shares with the host.
    pub fn key(part: &'static str) -> ShaderKey {
        key_of("passes::triangles::triangle_pairs::evaluate").part("pair", part)
    }

    /// Pairs of triangle and block, and of triangle and texel: the most that a part of any frame has needed. Waits for
    /// the GPU: for tests and reports.
    pub async fn needed(&self, gpu: &Gpu) -> Result<[u32; 2], Error> {
        let bytes = crate::gpu::resources::read_buffer(gpu, &self.growth.counts).await?;
        let counts: Vec<u32> = bytemuck::pod_collect_to_vec(&bytes);
        Ok([counts[0], counts[1]])
    }

    /// Pairs that there is room for.
    pub fn room(&self) -> u32 {
        self.lists.room
    }

    /// GPU memory by pass.
    pub fn memory(&self) -> [Memory; 2] {
        let candidates = self.first_candidates.size() + self.candidate_scan.bytes() + self.growth.bytes();
        [self.triangles.memory(), Memory::new("triangle-texel pairs", candidates + self.lists.bytes())]
    }
}

fn joined<'a>(some: &[Binding<'a>], more: &[Binding<'a>]) -> Vec<Binding<'a>> {
    [some, more].concat()
}

/// Bits of what pairs are sorted by.
const KEY_BITS: u32 = 4;

fn key_of(module: &'static str) -> ShaderKey {
    ShaderKey::new(module)
}
