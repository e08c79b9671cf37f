//! Lists whose length only the GPU knows: prefix sums, sorting, receivers of each texel.

pub mod list_length;
pub mod scan;
pub mod sort;
pub mod texel_lists;
