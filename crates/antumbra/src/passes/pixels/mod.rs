//! Passes over the image's pixels: geometry buffer, classification, sparse shading, shaded image.

pub mod classify;
pub mod geometry_buffer;
pub mod penumbra_widths;
pub mod shading;
pub mod sparse;
