//! The frustum of a shadow map from the light's centre.

use antumbra_scene::{Aabb, RectLight};
use glam::Vec2;

/// A symmetric frustum from the light's centre along its normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadowFrustum {
    /// Half the opening along the light's edges, as tangents.
    pub tan_half: Vec2,
    /// Casters nearer to the light's plane than this are not seen, metres.
    pub near: f32,
}

/// Half the widest frustum that is fitted, as a tangent: 160 degrees.
const MAX_TAN: f32 = 5.67;

impl ShadowFrustum {
    /// A square frustum of an opening in degrees.
    pub fn of_degrees(fov_deg: f32, near: f32) -> ShadowFrustum {
        ShadowFrustum { tan_half: Vec2::splat((0.5 * fov_deg).to_radians().tan()), near }
    }

    /// The smallest frustum around a box, for hosts that know nothing closer. The light's own setting counts if it has
    /// one.
    pub fn around(light: &RectLight, bounds: &Aabb) -> ShadowFrustum {
        let corners = bounds.corners().map(|c| light.light_from_world(c));
        let far = corners.iter().fold(0.0f32, |m, c| m.max(c.z));
        let near = near_of(far);
        if let Some(degrees) = light.shadow_fov_deg {
            return ShadowFrustum::of_degrees(degrees, near);
        }
        let nearest = far * 0.02;
        let tan = corners.iter().fold(Vec2::splat(1e-3), |m, c| m.max(c.truncate().abs() / c.z.max(nearest)));
        ShadowFrustum { tan_half: tan.min(Vec2::splat(MAX_TAN)) * 1.01, near }
    }
}

/// A near plane that cuts nothing off: inverse distances are stored as floating-point numbers, so it may be close.
fn near_of(far: f32) -> f32 {
    (far * 1e-4).max(1e-6)
}

impl ShadowFrustum {
    /// x
    pub fn fit(scene: &antumbra_scene::Scene, _view: &crate::View) -> ShadowFrustum {
        Self::around(&scene.light, &scene.bounds_of(|i| !i.receiver_only))
    }
}
