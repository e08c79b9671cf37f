//! Exact visibility at the pixel's own points, from lists of receivers and the triangles themselves.

pub mod hard;
pub mod soft;
pub mod subpixel;
