//! What the numbers of a moment map mean.

use crate::{Frame, gpu_struct};
use glam::Vec2;

gpu_struct! {
    /// How a depth becomes what is stored; see `shaders/depth_warp.wesl`.
    #[derive(Default)]
    pub struct DepthWarp {
        /// Distance along the light's normal where the range begins, metres.
        nearest: f32,
        /// One over the length of the range, 1/metres.
        per_metre: f32,
        /// Distance of the depth map's near plane, metres.
        map_near: f32,
        /// The part of a stored number that rounding may take or give.
        rounding: f32,
        /// Exponents of the warp, towards the light's side and away from it.
        exponents: Vec2,
        /// The bound on the visible part is scaled so that this much of it becomes 0.
        bleeding: f32,
        /// Terms of the Fourier series.
        terms: u32,
        /// The largest value that the series has where it should be 0.
        ripple: f32,
    }
}

/// Casters nearer than this part of the farthest distance count as there.
const NEAREST: f32 = 0.02;

impl DepthWarp {
    /// This warp over the range of a frame: from the nearest corner of what casts to the farthest receiver. What lies
    /// behind every receiver hides nothing, so it counts as at the range's end.
    pub fn over(self, frame: &Frame) -> DepthWarp {
        let corners = frame.casters.bounds().corners();
        let depths = corners.iter().map(|c| frame.light.light_from_world(*c).z);
        let farthest = frame.frustum.receivers[1];
        let nearest = depths.fold(farthest, f32::min).max(NEAREST * farthest).min(0.99 * farthest);
        // Nothing is at 1, so that a receiver at the end of the range is told from empty space by rounding only.
        let length = 1.001 * (farthest - nearest);
        DepthWarp { nearest, per_metre: 1.0 / length, map_near: frame.frustum.near, ..self }
    }
}
