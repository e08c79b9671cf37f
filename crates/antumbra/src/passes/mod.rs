//! Passes that several techniques share.

pub mod lists;
pub mod maps;
pub mod pixels;
pub mod triangles;
