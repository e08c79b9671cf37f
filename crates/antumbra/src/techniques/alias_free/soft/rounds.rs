//! Several looks at the same triangles, each from where the one before it stopped; see `rounds.wesl`.

use super::TriangleLook;
use super::lattice::MOST_ROWS;
use crate::gpu::device::Gpu;
use crate::input::casters::CLUSTER_TRIANGLES;
use crate::passes::triangles::light_triangles::Part;
use crate::passes::lists::scan::ListLength;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::storage_buffer;

/// How far a look goes, and how many looks there must be.
pub(super) struct Rounds {
    /// A tile that has gone round more often than that stops.
    pub most: u32,
    /// Looks at which every tile has come to its end, whatever it meets.
    pub looks: u32,
}

/// Rounds of all loops of a thread, after which llvmpipe ends them: 65 535, less what is not counted.
const LLVMPIPE_ROUNDS: u32 = 65_000;
/// Rounds of a cluster beside those of its triangles: `ROUNDS_OF_CLUSTER`.
const CLUSTER_ROUNDS: u32 = 32;
/// Sets of four rows.
const SETS: u32 = MOST_ROWS as u32 / 4;
/// Threads that go round together.
const GROUP: u32 = 8;

impl Rounds {
    /// Of a part of the triangles, for so many points of the light. Drivers of GPUs end no loop.
    pub fn of(gpu: &Gpu, part: &Part, points: u32) -> Rounds {
        if !gpu.is_software() {
            return Rounds { most: u32::MAX, looks: 1 };
        }
        let masked = part.masked.is_some();
        let (loops, lookups) = if masked { (2, points) } else { (1, 0) };
        let triangles = CLUSTER_ROUNDS + CLUSTER_TRIANGLES * (1 + loops * SETS);
        // What a cluster may need, and what it may be counted as: lookups are summed over threads.
        let needed = triangles + CLUSTER_TRIANGLES * lookups;
        let counted = triangles + CLUSTER_TRIANGLES * lookups * GROUP;
        let most = LLVMPIPE_ROUNDS - needed;
        let clusters = part.cluster_count();
        Rounds { most, looks: clusters.min(clusters * counted / most + 1).max(1) }
    }
}

/// What a look at the triangles leaves for the next.
pub(super) struct Between {
    /// Hidden points of each pixel.
    pub masks: wgpu::Buffer,
    /// The cluster with which each tile goes on.
    pub stopped_at: wgpu::Buffer,
    /// Arguments of the dispatch of each look, written by the one before.
    looks: Vec<ListLength>,
}

impl Between {
    /// What these looks need; nothing if one is enough.
    pub fn ensure<'a>(
        slot: &'a mut Option<Between>,
        gpu: &Gpu,
        size: [u32; 2],
        looks: &[TriangleLook],
    ) -> Option<&'a Between> {
        if looks.len() <= 1 {
            *slot = None;
            return None;
        }
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        let bytes = pixels * MOST_ROWS as u64 * 4;
        let tiles = u64::from(size[0].div_ceil(8)) * u64::from(size[1].div_ceil(8));
        let most = looks.iter().map(|l| l.look as usize + 2).max().expect("more than one");
        if slot.as_ref().is_none_or(|b| b.masks.size() != bytes || b.looks.len() < most) {
            *slot = None; // Frees the old ones before the new ones are made.
            *slot = Some(Between {
                masks: storage_buffer(gpu, "hidden points", bytes),
                stopped_at: storage_buffer(gpu, "clusters to go on with", tiles * 4),
                looks: (0..most).map(|_| ListLength::unknown(gpu, "next look")).collect(),
            });
        }
        slot.as_ref()
    }

    /// Where this look notes that there must be another one; nothing is noted yet.
    pub fn next_look(&self, recorder: &mut Recorder, look: u32) -> &wgpu::Buffer {
        let next = &self.looks[look as usize + 1].0;
        recorder.encoder.clear_buffer(next, 0, None);
        next
    }

    /// The dispatch that the look before this one has asked for.
    pub fn work(&self, look: u32) -> Work<'_> {
        self.looks[look as usize].work()
    }

    /// GPU memory.
    pub fn bytes(&self) -> u64 {
        self.masks.size() + self.stopped_at.size() + self.looks.len() as u64 * 16
    }
}
