//! Exact visibility at the pixel's own points, from lists of receivers and the triangles themselves.

// TODO(convert) pub mod hard;
pub mod soft;
// TODO(convert) pub mod subpixel;
