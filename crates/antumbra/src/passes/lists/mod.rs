//! Lists whose length only the GPU knows: prefix sums, sorting, compaction, receivers of each texel.

pub mod compact;
pub mod list_length;
pub mod scan;
pub mod sort;
pub mod texel_lists;
