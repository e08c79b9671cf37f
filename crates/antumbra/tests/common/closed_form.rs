//! Visibility in closed form: a rectangle over the plane y = 0, parallel to a rectangular light that faces it. The
//! occluder projects from a point of the plane to a rectangle in the light's plane, and the hidden part of the light is
//! the overlap of two rectangles.

use antumbra_scene::{Camera, RectLight, Scene};
use glam::{DVec2, DVec3};

/// A horizontal rectangle; `half` is half its size along x and z.
#[derive(Clone, Copy, Debug)]
pub struct Occluder {
    pub center: [f32; 3],
    pub half: [f32; 2],
}

impl Occluder {
    /// A scene of the ground and this occluder.
    pub fn scene(&self, camera: Camera, light: RectLight) -> Scene {
        super::scene(vec![super::ground(20.0), super::quad(self.center, self.half)], camera, light)
    }

    /// Visible fraction of the light from a point of the plane. The light may be a line or a point.
    pub fn visibility(&self, light: &RectLight, p: DVec3) -> f64 {
        let (l, o) = (light.center.as_dvec3(), DVec3::from(self.center.map(f64::from)));
        let scale = l.y / o.y;
        let hidden = |p: f64, l: f64, o: f64, half: f32, edge: f32| {
            let (half, edge) = (f64::from(half), f64::from(edge));
            let (low, high) = (p + (o - half - p) * scale - l, p + (o + half - p) * scale - l);
            if edge == 0.0 {
                // The overlap's limit: all or nothing.
                return if low < 0.0 && high > 0.0 { 1.0 } else { 0.0 };
            }
            (high.min(edge / 2.0) - low.max(-edge / 2.0)).max(0.0) / edge
        };
        let (size, half) = (light.size, self.half);
        1.0 - hidden(p.x, l.x, o.x, half[0], size.x) * hidden(p.z, l.z, o.z, half[1], size.y)
    }

    /// The visibility at the centre of each pixel; `None` where the camera sees the occluder, or no ground.
    pub fn image(&self, scene: &Scene, size: [u32; 2]) -> Vec<Option<f64>> {
        let pixels = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y)));
        pixels
            .map(|(x, y)| {
                let (eye, d) = pixel_ray(&scene.camera, size, DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5));
                let t = (f64::from(self.center[1]) - eye.y) / d.y;
                let q = (eye + d * t - DVec3::from(self.center.map(f64::from))).abs();
                let blocked = t > 0.0 && q.x <= f64::from(self.half[0]) && q.z <= f64::from(self.half[1]);
                (d.y < 0.0 && !blocked).then(|| self.visibility(&scene.light, eye - d * (eye.y / d.y)))
            })
            .collect()
    }
}

/// Origin and direction of the camera's ray through `p`, in pixels.
pub fn pixel_ray(camera: &Camera, size: [u32; 2], p: DVec2) -> (DVec3, DVec3) {
    let (right, up, forward) = camera.basis();
    let tan = (f64::from(camera.fov_y_deg) / 2.0).to_radians().tan();
    let size = DVec2::new(f64::from(size[0]), f64::from(size[1]));
    let ndc = p / size * 2.0 - 1.0;
    let d = forward.as_dvec3() + right.as_dvec3() * (ndc.x * tan * size.x / size.y) - up.as_dvec3() * (ndc.y * tan);
    (camera.eye.as_dvec3(), d)
}

/// The point of the plane y = 0 at the centre of each pixel; `None` above the horizon.
pub fn ground_points(camera: &Camera, size: [u32; 2]) -> Vec<Option<DVec3>> {
    let pixels = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y)));
    pixels
        .map(|(x, y)| {
            let (eye, d) = pixel_ray(camera, size, DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5));
            (d.y < 0.0).then(|| eye - d * (eye.y / d.y))
        })
        .collect()
}
