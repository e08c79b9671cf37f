//! The ray-traced truth: the fraction of a one-sided rectangular light that every pixel sees.
//!
//! Primary rays go through a fixed grid of sub-pixels, shadow rays from what they hit to the points of a scrambled
//! (0,2)-net on the light. The image is the mean over the sub-pixels, so edges are box-filtered over the pixel; the
//! same seed gives the same bytes on any number of threads. [`Tracer`] holds the scene's triangles in a bounding
//! volume hierarchy and answers single rays too; [`View`] traces pixels and rows of one image; [`trace`] does all.
//!
//! Conventions: pixel (column x, row y) covers [x, x+1] × [y, y+1], row 0 on top. Surfaces are two-sided, their
//! geometric normal turned to the camera. A light point below the receiver's tangent plane is not seen, and a receiver
//! behind the light sees none of it. See `Reference::valid` for the pixels that errors should be measured on.
#![deny(missing_docs)]

mod bvh;
mod cutout;
mod exact;
mod geometry;
mod image;
mod packet;
mod parts;
mod pattern;
mod shaft;
mod tracer;
mod view;

pub mod cache;

pub use image::{Reference, ReferenceError, Settings, trace, trace_centre};
pub use tracer::{Hit, Ray, Tracer, TracerBuild};
pub use view::{Pixel, View};
