//! Handles of the light: positions, and the effect of dragging.

use antumbra::View;
use antumbra_scene::RectLight;
use glam::{Vec2, Vec3};

/// A handle of the light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Handle {
    /// The centre: moves the light parallel to the image.
    Move,
    /// An arrow: moves the light along x, y or z.
    Along(usize),
    /// The middle of an edge: changes the width; +1 and -1 are the two edges.
    Width(i8),
    /// The middle of an edge: changes the height.
    Height(i8),
    /// The target: turns the light.
    Aim,
}

/// Length of the arrows and offset of size handles from the edges, points.
const ARROW: f32 = 58.0;
const OFFSET: f32 = 9.0;

/// Projection between world and screen.
#[derive(Clone, Copy, Debug)]
pub struct Screen {
    /// Camera of the image.
    pub view: View,
    /// Upper left corner, in points.
    pub min: Vec2,
    /// Width and height, in points.
    pub size: Vec2,
}

impl Screen {
    /// The screen position of a world position; none behind the camera.
    pub fn project(&self, p: Vec3) -> Option<Vec2> {
        let clip = self.view.clip_from_world() * p.extend(1.0);
        let ndc = clip.truncate().truncate() / clip.w;
        (clip.w > 1e-6 && ndc.is_finite()).then(|| self.min + (ndc * Vec2::new(0.5, -0.5) + 0.5) * self.size)
    }

    /// Direction of the ray from the eye through a screen position.
    pub fn ray(&self, at: Vec2) -> Vec3 {
        let ndc = ((at - self.min) / self.size - 0.5) * Vec2::new(2.0, -2.0);
        let c = self.view.clip_from_view;
        let in_view = Vec3::new(ndc.x / c.x_axis.x, ndc.y / c.y_axis.y, -1.0);
        (self.view.view_from_world.inverse().transform_vector3(in_view)).normalize()
    }

    /// Metres per screen point at `p`.
    pub fn metres_per_point(&self, p: Vec3) -> f32 {
        let depth = -self.view.view_from_world.transform_point3(p).z;
        2.0 * depth.max(1e-6) / (self.view.clip_from_view.y_axis.y * self.size.y)
    }

    fn forward(&self) -> Vec3 {
        -self.view.view_from_world.inverse().z_axis.truncate()
    }

    /// Where the ray meets the plane through `p` that faces the camera.
    fn on_plane(&self, at: Vec2, p: Vec3) -> Vec3 {
        let (eye, ray, normal) = (self.view.eye(), self.ray(at), self.forward());
        eye + ray * ((p - eye).dot(normal) / ray.dot(normal).max(1e-6))
    }

    /// Distance along the line through `p` to the position nearest to the ray.
    fn along_line(&self, at: Vec2, p: Vec3, direction: Vec3) -> Option<f32> {
        let (ray, between) = (self.ray(at), self.view.eye() - p);
        let b = ray.dot(direction);
        let denominator = 1.0 - b * b;
        // A line towards the eye has no length on the screen.
        (denominator > 1e-3).then(|| (between.dot(direction) - b * between.dot(ray)) / denominator)
    }
}

/// Visible handles with their screen positions.
pub fn handles(light: &RectLight, screen: &Screen) -> Vec<(Handle, Vec2)> {
    let (right, up, _) = light.basis();
    let metres = screen.metres_per_point(light.center);
    let beside = |direction: Vec3, half: f32| light.center + direction * (half + OFFSET * metres);
    let sides = [1i8, -1].into_iter().flat_map(|s| {
        let sign = f32::from(s);
        [
            (Handle::Width(s), beside(right * sign, 0.5 * light.size.x)),
            (Handle::Height(s), beside(up * sign, 0.5 * light.size.y)),
        ]
    });
    let arrows = Vec3::AXES.into_iter().enumerate();
    let arrows = arrows.map(|(i, axis)| (Handle::Along(i), light.center + axis * ARROW * metres));
    let all = [(Handle::Aim, light.target), (Handle::Move, light.center)];
    // Later handles are on top: centre and edges before arrows.
    arrows.chain(all).chain(sides).filter_map(|(h, p)| Some((h, screen.project(p)?))).collect()
}

/// The light after a drag of `handle` between two screen positions.
pub fn dragged(light: &RectLight, handle: Handle, screen: &Screen, start: Vec2, at: Vec2, largest: f32) -> RectLight {
    let (right, up, _) = light.basis();
    let along = |direction: Vec3| {
        let from = screen.along_line(start, light.center, direction);
        from.zip(screen.along_line(at, light.center, direction)).map_or(0.0, |(from, to)| to - from)
    };
    let shifted = |by: Vec3| RectLight { center: light.center + by, target: light.target + by, ..*light };
    let resized = |size: Vec2| RectLight { size: size.clamp(Vec2::ZERO, Vec2::splat(largest)), ..*light };
    match handle {
        Handle::Move => shifted(screen.on_plane(at, light.center) - screen.on_plane(start, light.center)),
        Handle::Along(axis) => shifted(Vec3::AXES[axis] * along(Vec3::AXES[axis])),
        Handle::Width(side) => resized(light.size + Vec2::X * 2.0 * along(right * f32::from(side))),
        Handle::Height(side) => resized(light.size + Vec2::Y * 2.0 * along(up * f32::from(side))),
        Handle::Aim => {
            let shift = screen.on_plane(at, light.target) - screen.on_plane(start, light.target);
            aimed(light, light.target + shift)
        }
    }
}

/// The light turned to a target.
pub fn aimed(light: &RectLight, target: Vec3) -> RectLight {
    let forward = target - light.center;
    if forward.length() < 1e-4 {
        return *light;
    }
    let up = if forward.normalize().cross(light.up.normalize()).length() > 0.05 { light.up } else { light.basis().1 };
    RectLight { target, up, ..*light }
}

/// The light after an orbit about its target: radians of azimuth and elevation.
pub fn swung(light: &RectLight, angles: Vec2) -> RectLight {
    let (azimuth, elevation, distance) = placed(light);
    at(light, azimuth + angles.x, elevation + angles.y, distance)
}

/// Position relative to the target: azimuth from +Z towards +X and elevation in radians, distance in metres.
pub fn placed(light: &RectLight) -> (f32, f32, f32) {
    let from = light.center - light.target;
    (from.x.atan2(from.z), from.y.atan2(from.x.hypot(from.z)), from.length())
}

/// The light at that relative position.
pub fn at(light: &RectLight, azimuth: f32, elevation: f32, distance: f32) -> RectLight {
    let elevation = elevation.clamp(0.02, 1.565);
    let horizontal = elevation.cos();
    let from = Vec3::new(azimuth.sin() * horizontal, elevation.sin(), azimuth.cos() * horizontal);
    // Rotated as a whole, so its edges keep their angle to the line of sight.
    let old = (light.center - light.target).normalize();
    let turn = glam::Quat::from_rotation_arc(old, from);
    RectLight { center: light.target + from * distance, up: turn * light.up, ..*light }
}

#[cfg(test)]
mod tests {
    use super::*;
    use antumbra_scene::Camera;

    fn screen() -> Screen {
        let camera = Camera {
            eye: Vec3::new(0.0, 2.0, 10.0),
            target: Vec3::new(0.0, 2.0, 0.0),
            up: Vec3::Y,
            fov_y_deg: 60.0,
            near: 0.1,
            far: 100.0,
        };
        Screen {
            view: View::of_camera(&camera, [800, 600]),
            min: Vec2::new(100.0, 50.0),
            size: Vec2::new(800.0, 600.0),
        }
    }

    fn light() -> RectLight {
        RectLight {
            center: Vec3::new(1.0, 4.0, 0.0),
            target: Vec3::ZERO,
            up: Vec3::NEG_Z,
            size: Vec2::new(1.0, 0.5),
            shadow_fov_deg: None,
        }
    }

    #[test]
    fn a_ray_goes_through_what_is_seen_there() {
        let (s, p) = (screen(), Vec3::new(1.5, 3.0, -2.0));
        let at = s.project(p).unwrap();
        let ray = s.ray(at);
        assert!(((p - s.view.eye()).normalize() - ray).length() < 1e-5, "{ray:?}");
        assert!(s.project(Vec3::new(0.0, 2.0, 11.0)).is_none(), "behind the camera");
    }

    #[test]
    fn moving_follows_the_pointer_and_keeps_the_direction() {
        let (s, l) = (screen(), light());
        let start = s.project(l.center).unwrap();
        let moved = dragged(&l, Handle::Move, &s, start, start + Vec2::new(60.0, -40.0), 100.0);
        let seen = s.project(moved.center).unwrap();
        assert!((seen - start - Vec2::new(60.0, -40.0)).length() < 0.1, "{seen:?}");
        assert!((moved.basis().2 - l.basis().2).length() < 1e-5);
    }

    #[test]
    fn an_arrow_moves_along_its_axis_alone() {
        let (s, l) = (screen(), light());
        for axis in 0..2 {
            let start = s.project(l.center).unwrap();
            let by =
                dragged(&l, Handle::Along(axis), &s, start, start + Vec2::new(50.0, -50.0), 100.0).center - l.center;
            assert!(by[axis] > 0.1 && by[(axis + 1) % 3].abs() < 1e-6 && by[(axis + 2) % 3].abs() < 1e-6, "{by:?}");
        }
    }

    #[test]
    fn an_edge_resizes_on_both_sides_and_stops_at_nothing() {
        let (s, l) = (screen(), light());
        let start = s.project(l.point(0.5, 0.0)).unwrap();
        let to = s.project(l.point(1.0, 0.0)).unwrap();
        let wider = dragged(&l, Handle::Width(1), &s, start, to, 100.0);
        assert!((wider.size.x - 2.0).abs() < 0.02 && wider.size.y == 0.5, "{:?}", wider.size);
        let away = start + (start - to) * 9.0;
        assert_eq!(dragged(&l, Handle::Width(1), &s, start, away, 100.0).size.x, 0.0);
    }

    #[test]
    fn turning_never_loses_the_basis() {
        let mut l = light();
        for i in 0..200 {
            l = swung(&l, Vec2::new(0.3, 0.1 * (i as f32).sin()));
            assert!(l.basis().0.is_finite() && ((l.center - l.target).length() - 17f32.sqrt()).abs() < 1e-3, "{l:?}");
        }
        let down = aimed(&l, l.center + l.up * 3.0);
        assert!(down.basis().0.is_finite() && down.basis().0.length() > 0.5, "aimed along its own up: {down:?}");
    }
}
