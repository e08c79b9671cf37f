//! Lists whose length only the GPU knows: prefix sums, sorting, compaction, receivers of each texel.

// TODO(convert) pub mod compact;
pub mod list_length;
// TODO(convert) pub mod scan;
// TODO(convert) pub mod sort;
// TODO(convert) pub mod texel_lists;
