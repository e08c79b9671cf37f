//! The one-sided rectangular light.

use crate::axes::axes;
use glam::{Vec2, Vec3};

/// A one-sided rectangular light. A zero height makes a line, zero width and height a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RectLight {
    /// Centre of the rectangle in world space, metres.
    pub center: Vec3,
    /// A point that the light faces; the normal is `normalize(target - center)`.
    pub target: Vec3,
    /// Fixes the rotation about the normal: the first edge is `normalize(cross(forward, up))`. Where it is parallel to
    /// the normal, -Z takes its place.
    pub up: Vec3,
    /// Edge lengths in metres, each >= 0.
    pub size: Vec2,
    /// Opening of the shadow frustum in degrees, or `None` to fit it to the casters of visible shadows.
    pub shadow_fov_deg: Option<f32>,
}

impl RectLight {
    /// Unit vectors (first edge, second edge, normal). The normal points away from the light's front.
    pub fn basis(&self) -> (Vec3, Vec3, Vec3) {
        axes(self.target - self.center, self.up)
    }

    /// The two edge vectors, in metres.
    pub fn edges(&self) -> (Vec3, Vec3) {
        let (right, up, _) = self.basis();
        (right * self.size.x, up * self.size.y)
    }

    /// The point of the light at `(u, v)` in [-1/2, 1/2]².
    pub fn point(&self, u: f32, v: f32) -> Vec3 {
        let (a, b) = self.edges();
        self.center + a * u + b * v
    }

    /// World to light space: x and y along the edges, z the distance from the light's plane along its normal.
    pub fn light_from_world(&self, p: Vec3) -> Vec3 {
        let (right, up, forward) = self.basis();
        let d = p - self.center;
        Vec3::new(d.dot(right), d.dot(up), d.dot(forward))
    }
}
