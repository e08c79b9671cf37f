//! Several dispatches over the same triangles, each resuming where the one before stopped; see `rounds.wesl`.

use super::TrianglePass;
use super::lattice::MOST_ROWS;
use crate::binding_array;
use crate::gpu::bindings::Binding;
use crate::gpu::device::Gpu;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::BufferDescription;
use crate::input::casters::CLUSTER_TRIANGLES;
use crate::passes::lists::list_length::ListLength;
use crate::passes::triangles::light_triangles::Part;

/// The length of a dispatch, and the number of dispatches.
pub(super) struct Rounds {
    /// A tile stops after this many rounds.
    pub most: u32,
    /// Dispatches after which every tile has come to its end in the worst case.
    pub passes: u32,
}

/// Rounds of all loops of a thread, after which llvmpipe ends them: 65 535, less the uncounted rounds.
const LLVMPIPE_ROUNDS: u32 = 65_000;
/// Rounds of a cluster besides those of its triangles: `ROUNDS_OF_CLUSTER`.
const CLUSTER_ROUNDS: u32 = 32;
/// Sets of four rows.
const SETS: u32 = MOST_ROWS as u32 / 4;
/// Threads that share a loop.
const GROUP: u32 = 8;

impl Rounds {
    /// For a part of the triangles and this many points of the light. Drivers of GPUs end no loop.
    pub fn of(gpu: &Gpu, part: &Part, points: u32) -> Rounds {
        if !gpu.is_software() {
            return Rounds { most: u32::MAX, passes: 1 };
        }
        let masked = part.masked.is_some();
        let (loops, lookups) = if masked { (2, points) } else { (1, 0) };
        let triangles = CLUSTER_ROUNDS + CLUSTER_TRIANGLES * (1 + loops * SETS);
        // Rounds that a cluster may need, and its counted bound: lookups are summed over threads.
        let needed = triangles + CLUSTER_TRIANGLES * lookups;
        let counted = triangles + CLUSTER_TRIANGLES * lookups * GROUP;
        let most = LLVMPIPE_ROUNDS - needed;
        let clusters = part.cluster_count();
        Rounds { most, passes: clusters.min(clusters * counted / most + 1).max(1) }
    }
}

/// The state of tiles that stopped before their end, for the next dispatch.
pub(super) struct ResumeState {
    /// Hidden points of each pixel.
    masks: wgpu::Buffer,
    /// The cluster with which each tile resumes.
    stopped_at: wgpu::Buffer,
    /// Arguments of each dispatch, written by the one before.
    passes: Vec<ListLength>,
}

impl ResumeState {
    /// The state for these dispatches; none if one is enough.
    pub fn new(recorder: &mut Recorder, size: [u32; 2], passes: &[TrianglePass]) -> Option<ResumeState> {
        if passes.len() <= 1 {
            return None;
        }
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        let tiles = u64::from(size[0].div_ceil(8)) * u64::from(size[1].div_ceil(8));
        let most = passes.iter().map(|p| p.pass_index + 2).max().expect("more than one");
        Some(ResumeState {
            masks: recorder.buffer("hidden points", BufferDescription::new(pixels * MOST_ROWS as u64 * 4)),
            stopped_at: recorder.buffer("clusters to resume with", BufferDescription::new(tiles * 4)),
            passes: (0..most).map(|_| ListLength::new(recorder, "next pass")).collect(),
        })
    }

    /// The resources of a dispatch; the arguments of the next one are cleared.
    pub fn bindings(&self, recorder: &mut Recorder, pass_index: u32) -> [Binding<'_>; 3] {
        let next = &self.passes[pass_index as usize + 1].0;
        recorder.clear(next, None);
        binding_array! { masks: &self.masks, stopped_at: &self.stopped_at, next_pass: next }
    }

    /// The dispatch that the one before has asked for.
    pub fn work(&self, pass_index: u32) -> Work<'_> {
        self.passes[pass_index as usize].work()
    }
}
