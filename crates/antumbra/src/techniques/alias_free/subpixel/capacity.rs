//! How much room the lists of facets have. They are counted before they are written; a later frame has as much room as
//! the counts say, up to a budget, beyond which the picture is made in strips.

use crate::gpu::growth::Growth;
use crate::passes::lists::scan::ListLength;
use crate::gpu::recorder::Recorder;
use crate::technique::Memory;
use crate::gpu::device::Gpu;
use crate::gpu_struct;

gpu_struct! {
    /// Rows of the picture that are looked at together.
    pub(crate) struct StripUniform {
        first_row: u32,
        end_row: u32,
        /// Entries that the lists have room for.
        capacity: u32,
    }
}

/// Entries that there is room for at first: a pixel, and in all.
const FIRST_ENTRIES: (u32, u32) = (8, 1 << 20);
/// Most strips.
const MOST_STRIPS: u32 = 64;
/// Bytes of an entry.
const ENTRY_BYTES: u64 = 4;

/// Room for the lists of a technique.
pub(super) struct Room {
    budget: u64,
    growth: Growth,
    size: [u32; 2],
    entries: u32,
    strips: u32,
}

/// How a frame is made.
pub(super) struct Plan {
    /// Entries that there is room for.
    pub entries: u32,
    /// From top to bottom.
    pub strips: Vec<StripUniform>,
}

impl Room {
    /// For at most about so many MiB.
    pub fn new(gpu: &Gpu, budget: u32) -> Room {
        let growth = Growth::new(gpu, "needed room for facets", MOST_STRIPS);
        Room { budget: u64::from(budget) << 20, growth, size: [0; 2], entries: 0, strips: 1 }
    }

    /// Most entries: a quarter of the budget.
    fn most(&self) -> u32 {
        (self.budget / 4 / ENTRY_BYTES).min(1 << 28) as u32
    }

    /// What of the budget is for pairs of triangles and texels.
    pub fn pair_bytes(&self) -> u64 {
        self.budget * 3 / 4
    }

    /// Strips of the last frame.
    pub fn strips(&self) -> u32 {
        self.strips
    }

    /// The next frame, after what earlier ones have needed.
    pub fn plan(&mut self, size: [u32; 2]) -> Plan {
        let pixels = size[0] * size[1];
        if size != self.size {
            let first = pixels.saturating_mul(FIRST_ENTRIES.0).max(FIRST_ENTRIES.1);
            (self.size, self.entries, self.strips) = (size, first.min(self.most()), 1);
        }
        let needed = self.growth.take().and_then(|n| n.into_iter().max());
        if let Some(needed) = needed.filter(|n| *n > self.entries) {
            self.entries = needed.saturating_add(needed / 4).min(self.most());
            if needed > self.entries {
                // As if what is needed were spread evenly; the frame after the next knows better.
                self.strips = (self.strips * (needed / self.entries + 1)).min(MOST_STRIPS).min(size[1]);
            }
        }
        let rows = size[1].div_ceil(self.strips);
        let strip = |first_row: u32| StripUniform {
            first_row,
            end_row: (first_row + rows).min(size[1]),
            capacity: self.entries,
        };
        Plan { entries: self.entries, strips: (0..size[1]).step_by(rows as usize).map(strip).collect() }
    }

    /// Notes how long the lists of a strip are.
    pub fn count(&self, recorder: &mut Recorder, strip: u32, length: &ListLength) {
        // The count is the last of the four words.
        let slot = u64::from(strip.min(MOST_STRIPS - 1)) * 4;
        recorder.encoder.copy_buffer_to_buffer(&length.0, 12, &self.growth.counts, slot, 4);
    }

    /// Sends what was noted on its way.
    pub fn learn(&self, recorder: &mut Recorder) {
        self.growth.record(recorder);
    }

    /// GPU memory.
    pub fn memory(&self) -> Memory {
        Memory::new("lists of receivers", self.growth.bytes())
    }
}
