//! The perspective camera.

use crate::axes::axes;
use glam::{Mat4, Vec3};

/// A perspective camera; lengths in metres, in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Position.
    pub eye: Vec3,
    /// The point at the centre of the image.
    pub target: Vec3,
    /// Up direction. Where it is parallel to the view direction, -Z takes its place.
    pub up: Vec3,
    /// Vertical field of view in degrees, in (0, 180).
    pub fov_y_deg: f32,
    /// Distance of the near plane along the view direction, > 0.
    pub near: f32,
    /// Distance of the far plane, > near.
    pub far: f32,
}

impl Camera {
    /// Unit vectors (right, up, forward).
    pub fn basis(&self) -> (Vec3, Vec3, Vec3) {
        axes(self.target - self.eye, self.up)
    }

    /// World to view space: right-handed, looking along -Z.
    pub fn view_from_world(&self) -> Mat4 {
        let (right, up, forward) = self.basis();
        Mat4::from_cols(
            glam::vec4(right.x, up.x, -forward.x, 0.0),
            glam::vec4(right.y, up.y, -forward.y, 0.0),
            glam::vec4(right.z, up.z, -forward.z, 0.0),
            glam::vec4(-right.dot(self.eye), -up.dot(self.eye), forward.dot(self.eye), 1.0),
        )
    }

    /// View to clip space with reversed depth: 1 at the near plane, 0 at the far plane.
    pub fn clip_from_view(&self, aspect: f32) -> Mat4 {
        let focal = 1.0 / (0.5 * self.fov_y_deg.to_radians()).tan();
        let (n, f) = (self.near, self.far);
        Mat4::from_cols(
            glam::vec4(focal / aspect, 0.0, 0.0, 0.0),
            glam::vec4(0.0, focal, 0.0, 0.0),
            glam::vec4(0.0, 0.0, n / (f - n), -1.0),
            glam::vec4(0.0, 0.0, n * f / (f - n), 0.0),
        )
    }

    /// World to clip space, `aspect` = width / height.
    pub fn clip_from_world(&self, aspect: f32) -> Mat4 {
        self.clip_from_view(aspect) * self.view_from_world()
    }
}
