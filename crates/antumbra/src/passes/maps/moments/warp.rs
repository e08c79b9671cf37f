//! Meaning of the numbers in a moment map.

use crate::gpu_struct;
use crate::input::frame::Frame;
use crate::input::frustum::ShadowFrustum;
use glam::Vec2;

gpu_struct! {
    /// The mapping from depth to stored values; see `shaders/depth_warp.wesl`.
    #[derive(Default)]
    pub struct DepthWarp {
        /// Distance along the light's normal where the range begins, metres.
        nearest: f32,
        /// One over the length of the range, 1/metres.
        per_metre: f32,
        /// Inverse distance at the range's end, 1/metres.
        farthest_q: f32,
        /// One over the length of the range of inverse distances, metres.
        per_q: f32,
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

/// Where the range of depths begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Nearest {
    /// At the nearest receiver: nearer casters hide every receiver at any depth, and a short range bleeds less light.
    Receiver,
    /// At the nearest caster: the penumbra's width follows from the caster's distance.
    Caster,
}

impl DepthWarp {
    /// This warp over the range of a frame. Surfaces behind every receiver hide nothing, so they are clamped to the
    /// range's end.
    pub fn over(self, frame: &Frame, nearest: Nearest) -> DepthWarp {
        let ShadowFrustum { receivers: [first, farthest], nearest_caster, .. } = frame.frustum;
        let nearest = match nearest {
            Nearest::Receiver => first,
            Nearest::Caster => nearest_caster,
        };
        // An occluder that is clamped to the near end must stay before the nearest receiver by more than that is moved
        // by its computed errors, and empty space behind the farthest.
        let (nearest, farthest) = (nearest - 0.02 * farthest, farthest * 1.001);
        let nearest = nearest.max(1e-3 * farthest);
        let length = farthest - nearest;
        let (farthest_q, nearest_q) = (1.0 / (nearest + length), 1.0 / nearest);
        DepthWarp {
            nearest,
            per_metre: 1.0 / length,
            farthest_q,
            per_q: 1.0 / (nearest_q - farthest_q),
            map_near: frame.frustum.near,
            ..self
        }
    }
}
