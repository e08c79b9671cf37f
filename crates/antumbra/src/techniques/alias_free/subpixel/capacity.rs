//! The capacity of the lists of facets, learned from the counts of earlier frames up to a budget. Beyond it, the image
//! is processed in strips.

use crate::gpu::recorder::Recorder;
use crate::gpu_struct;

gpu_struct! {
    /// Rows of the image that are processed together.
    pub(crate) struct StripUniform {
        first_row: u32,
        end_row: u32,
        /// End of the rows whose masks are made: a filter that reaches into neighbours needs the row below too.
        end_of_masks: u32,
        /// Entries that the lists can hold.
        capacity: u32,
        /// Number of strips of the frame.
        count: u32,
    }
}

/// Entries of the first frame: per pixel, and at least in all.
const FIRST_ENTRIES: (u32, u32) = (8, 1 << 20);
const MOST_STRIPS: u32 = 64;
/// Bytes of an entry.
const ENTRY_BYTES: u64 = 4;

/// Capacity and strips of the next frame.
pub(super) struct CapacityPlan {
    /// Bytes for all lists.
    budget: u64,
    size: [u32; 2],
    entries: u32,
    strips: u32,
}

impl CapacityPlan {
    /// For lists of about `budget` bytes at most.
    pub fn new(budget: u64) -> CapacityPlan {
        CapacityPlan { budget, size: [0; 2], entries: 0, strips: 1 }
    }

    /// Most entries: a quarter of the budget.
    fn most(&self) -> u32 {
        (self.budget / 4 / ENTRY_BYTES).min(1 << 28) as u32
    }

    /// Bytes of the budget for pairs of triangles and texels.
    pub fn pair_bytes(&self) -> u64 {
        self.budget * 3 / 4
    }

    /// Number of strips.
    pub fn strip_count(&self) -> u32 {
        self.strips
    }

    /// The strips of an image from top to bottom, and the capacity of their lists; a filter reads masks of `reach` rows
    /// below a strip.
    pub fn strips(&mut self, size: [u32; 2], reach: u32) -> (Vec<StripUniform>, u32) {
        if size != self.size {
            let first = (size[0] * size[1]).saturating_mul(FIRST_ENTRIES.0).max(FIRST_ENTRIES.1);
            (self.size, self.entries, self.strips) = (size, first.min(self.most()), 1);
        }
        let rows = size[1].div_ceil(self.strips);
        let strip = |first_row: u32| StripUniform {
            first_row,
            end_row: (first_row + rows).min(size[1]),
            end_of_masks: (first_row + rows + reach).min(size[1]),
            capacity: self.entries,
            count: self.strips,
        };
        ((0..size[1]).step_by(rows as usize).map(strip).collect(), self.entries)
    }

    /// Ends a frame: requests its counts (entries of its longest strip, number of strips) and takes those of an earlier
    /// one.
    pub fn learn(&mut self, recorder: &mut Recorder, counts: &wgpu::Buffer) {
        let counts = recorder.read_back::<2>("counts of entries", counts);
        let Some([needed, strips]) = counts.filter(|[needed, _]| *needed > self.entries) else { return };
        self.entries = needed.saturating_add(needed / 4).min(self.most());
        if needed > self.entries {
            // An estimate for entries that are spread evenly; counts of later frames correct it.
            let more = strips.saturating_mul(needed / self.entries + 1);
            self.strips = more.max(self.strips).min(MOST_STRIPS).min(self.size[1]);
        }
    }
}
