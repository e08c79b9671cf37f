//! Camera navigation: orbit, pan, zoom, fly.

use antumbra_scene::{Aabb, Camera};
use glam::{Quat, Vec2, Vec3};

/// Steepest view up or down: sine of the elevation.
const STEEPEST: f32 = 0.995;
/// Smallest distance of the eye from its target, in radii of the scene.
const NEAREST: f32 = 1e-3;

/// Turns the eye around the target: radians to the right and up.
pub fn orbit(camera: &mut Camera, angles: Vec2) {
    let offset = turned(camera.eye - camera.target, camera, -angles.x, angles.y);
    camera.eye = camera.target + offset;
}

/// Turns the view about the eye: radians to the right and up.
pub fn look(camera: &mut Camera, angles: Vec2) {
    let offset = turned(camera.target - camera.eye, camera, -angles.x, -angles.y);
    camera.target = camera.eye + offset;
}

/// `offset` rotated about the up direction and the camera's right, not beyond a pole.
fn turned(offset: Vec3, camera: &Camera, yaw: f32, pitch: f32) -> Vec3 {
    let up = camera.up.normalize();
    let right = camera.basis().0;
    let pitched = Quat::from_axis_angle(right, -pitch) * offset;
    let sine = |v: Vec3| v.normalize().dot(up).abs();
    // A scene's camera that looks straight down can still leave that direction.
    let allowed = sine(pitched) < STEEPEST || sine(pitched) < sine(offset);
    Quat::from_axis_angle(up, yaw) * if allowed { pitched } else { offset }
}

/// Moves eye and target across the view; `delta`, right and up, in image heights at the target's distance.
pub fn pan(camera: &mut Camera, delta: Vec2) {
    let (right, up, _) = camera.basis();
    let height = 2.0 * (camera.eye - camera.target).length() * (0.5 * camera.fov_y_deg.to_radians()).tan();
    let shift = (right * delta.x + up * delta.y) * height;
    camera.eye += shift;
    camera.target += shift;
}

/// Divides the distance to the target by `factor`.
pub fn zoom(camera: &mut Camera, factor: f32, radius: f32) {
    let offset = camera.eye - camera.target;
    let distance = (offset.length() / factor).clamp(NEAREST * radius, 1e3 * radius);
    camera.eye = camera.target + offset.normalize() * distance;
}

/// Moves eye and target by metres along the view's right, up and forward.
pub fn fly(camera: &mut Camera, metres: Vec3) {
    let (right, up, forward) = camera.basis();
    let shift = right * metres.x + up * metres.y + forward * metres.z;
    camera.eye += shift;
    camera.target += shift;
}

/// Widens the depth range to the current need; it is never narrower than the scene's `range`.
pub fn fit_depth(camera: &mut Camera, range: [f32; 2], bounds: &Aabb) {
    let forward = camera.basis().2;
    let reach = bounds.corners().iter().map(|c| (*c - camera.eye).dot(forward)).fold(0.0f32, f32::max);
    camera.near = range[0].min(0.05 * (camera.eye - camera.target).length());
    camera.far = range[1].max(reach * 1.01);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        Camera {
            eye: Vec3::new(0.0, 1.0, 5.0),
            target: Vec3::new(0.0, 1.0, 0.0),
            up: Vec3::Y,
            fov_y_deg: 90.0,
            near: 0.1,
            far: 100.0,
        }
    }

    #[test]
    fn orbiting_keeps_the_distance_and_stops_at_the_pole() {
        let mut c = camera();
        orbit(&mut c, Vec2::new(0.5, 0.2));
        assert!(c.eye.x < 0.0 && c.eye.y > 1.0, "a drag to the right turns the scene to the right: {:?}", c.eye);
        for _ in 0..100 {
            orbit(&mut c, Vec2::new(0.0, 0.1));
        }
        assert!(c.basis().0.is_finite() && c.eye.y < 6.0);
        assert!(((c.eye - c.target).length() - 5.0).abs() < 1e-4, "{:?}", c.eye);
    }

    #[test]
    fn a_camera_that_looks_straight_down_can_be_raised() {
        let mut c =
            Camera { eye: Vec3::new(0.0, 5.0, 0.0), target: Vec3::ZERO, up: Vec3::new(0.0, 1.0, 1e-4), ..camera() };
        let before = c.eye;
        orbit(&mut c, Vec2::new(0.0, -0.3));
        orbit(&mut c, Vec2::new(0.0, 0.3));
        assert!(c.eye != before && c.basis().0.is_finite());
    }

    #[test]
    fn panning_by_the_images_height_moves_by_what_it_shows() {
        let mut c = camera();
        pan(&mut c, Vec2::new(0.0, 1.0));
        // 90 degrees at 5 metres: 10 metres high.
        assert!((c.eye.y - 11.0).abs() < 1e-4 && (c.target.y - 11.0).abs() < 1e-4, "{c:?}");
    }

    #[test]
    fn zooming_never_reaches_the_target() {
        let mut c = camera();
        for _ in 0..200 {
            zoom(&mut c, 2.0, 1.0);
        }
        assert!((c.eye - c.target).length() >= 0.9e-3 && c.basis().2.is_finite());
    }

    #[test]
    fn flying_forward_takes_the_target_along() {
        let mut c = camera();
        fly(&mut c, Vec3::new(0.0, 0.0, 2.0));
        assert_eq!((c.eye.z, c.target.z), (3.0, -2.0));
        look(&mut c, Vec2::new(0.1, 0.0));
        assert!(c.target.x > 0.0, "looking to the right: {:?}", c.target);
    }
}
