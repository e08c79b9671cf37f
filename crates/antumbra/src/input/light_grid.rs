//! A coarse grid over the part of a shadow map that surfaces take, for questions about a scene that are asked on the
//! CPU.
//!
//! All is measured in the map's own coordinates, tangents xy / z and inverse distance 1 / z, in which planes are
//! affine.

use antumbra_scene::Scene;
use antumbra_scene::slices::RUN;
use glam::{Vec2, Vec3, Vec4};

/// Cells a side.
const SIDE: usize = 192;

/// Where the cells lie.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cells {
    low: Vec2,
    cell: Vec2,
}

impl Cells {
    /// How many there are.
    pub const COUNT: usize = SIDE * SIDE;

    /// Cells over this range of tangents, and a little beyond.
    pub fn over(low: Vec2, high: Vec2) -> Cells {
        let margin = (high - low) * 0.02 + 1e-4;
        Cells { low: low - margin, cell: (high - low + 2.0 * margin) / SIDE as f32 }
    }

    /// Planes in light space around all cells, and a little in front of the light.
    pub fn rim(&self) -> [Vec4; 5] {
        let high = self.low + self.cell * SIDE as f32;
        [
            Vec4::new(0.0, 0.0, 1.0, -1e-5),
            Vec4::new(1.0, 0.0, -self.low.x, 0.0),
            Vec4::new(-1.0, 0.0, high.x, 0.0),
            Vec4::new(0.0, 1.0, -self.low.y, 0.0),
            Vec4::new(0.0, -1.0, high.y, 0.0),
        ]
    }

    /// Calls with the number and the middle of each cell whose middle lies in a convex polygon in light space.
    pub fn for_each(&self, polygon: &[Vec3], mut call: impl FnMut(usize, Vec2)) {
        let t: Vec<Vec2> = polygon.iter().map(|c| (c.truncate() / c.z - self.low) / self.cell - 0.5).collect();
        let low = t.iter().fold(Vec2::INFINITY, |m, p| m.min(*p)).ceil().max(Vec2::ZERO);
        let high = t.iter().fold(Vec2::NEG_INFINITY, |m, p| m.max(*p)).floor().min(Vec2::splat((SIDE - 1) as f32));
        for j in low.y as i32..=high.y as i32 {
            for i in low.x as i32..=high.x as i32 {
                let p = Vec2::new(i as f32, j as f32);
                let side = |k: usize| (t[(k + 1) % t.len()] - t[k]).perp_dot(p - t[k]);
                if (0..t.len()).all(|k| side(k) >= 0.0) || (0..t.len()).all(|k| side(k) <= 0.0) {
                    call(j as usize * SIDE + i as usize, self.low + (p + 0.5) * self.cell);
                }
            }
        }
    }

    /// The cells that lie up to `reach` cells from a tangent's own; those that there are.
    pub fn around(&self, t: Vec2, reach: i32) -> impl Iterator<Item = usize> {
        let at = ((t - self.low) / self.cell).floor();
        let inside = move |v: f32, d: i32| Some(v as i32 + d).filter(|v| (0..SIDE as i32).contains(v));
        let of_row =
            move |y: i32| (-reach..=reach).filter_map(move |dx| Some(y as usize * SIDE + inside(at.x, dx)? as usize));
        (-reach..=reach).filter_map(move |dy| inside(at.y, dy)).flat_map(of_row)
    }
}

/// Calls with the world-space corners of every triangle and the place of its instance, with a pause after every few
/// thousand.
pub(crate) async fn each_world_triangle(
    scene: &Scene,
    mut call: impl FnMut([Vec3; 3], usize),
    pause: &mut impl AsyncFnMut(),
) {
    let mut moved = Vec::new();
    for (place, instance) in scene.instances.iter().enumerate() {
        let mesh = &scene.meshes[instance.mesh];
        moved.clear();
        moved.extend(mesh.positions.iter().map(|p| instance.world_from_object.transform_point3(*p)));
        for run in mesh.indices.chunks(3 * RUN) {
            for t in run.chunks_exact(3) {
                call([t[0], t[1], t[2]].map(|i| moved[i as usize]), place);
            }
            pause().await;
        }
    }
}

/// Calls with every triangle that lies in front of the light: three corners in light space, and its instance; with a pause
/// after every few thousand.
pub(crate) async fn each_triangle(
    scene: &Scene,
    mut call: impl FnMut([Vec3; 3], usize),
    pause: &mut impl AsyncFnMut(),
) {
    let light = scene.light;
    let (right, up, forward) = light.basis();
    let towards_light = |corners: [Vec3; 3], instance: usize| {
        let corners = corners.map(|p| {
            let d = p - light.center;
            Vec3::new(d.dot(right), d.dot(up), d.dot(forward))
        });
        if corners.iter().any(|c| c.z > 0.0) {
            call(corners, instance);
        }
    };
    each_world_triangle(scene, towards_light, pause).await;
}

/// The corners of the part of a triangle that lies on the upper side of all planes [Sutherland, Hodgman 1974].
pub(crate) fn clipped(corners: &[Vec3; 3], planes: &[Vec4]) -> Vec<Vec3> {
    let distance = |p: &Vec3, plane: &Vec4| plane.dot(p.extend(1.0));
    if planes.iter().any(|plane| corners.iter().all(|c| distance(c, plane) < 0.0)) {
        return Vec::new();
    }
    let mut polygon = corners.to_vec();
    for plane in planes {
        if polygon.iter().all(|c| distance(c, plane) >= 0.0) {
            continue;
        }
        let mut kept = Vec::with_capacity(polygon.len() + 1);
        for i in 0..polygon.len() {
            let (a, b) = (polygon[i], polygon[(i + 1) % polygon.len()]);
            let (da, db) = (distance(&a, plane), distance(&b, plane));
            if da >= 0.0 {
                kept.push(a);
            }
            if (da >= 0.0) != (db >= 0.0) {
                kept.push(a.lerp(b, da / (da - db)));
            }
        }
        polygon = kept;
    }
    polygon
}

/// The inverse distance of a triangle's plane as an affine function of the tangent; none if it is edge-on to the light.
pub(crate) fn plane_of(corners: &[Vec3; 3]) -> Option<Vec3> {
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    let height = normal.dot(corners[0]);
    (height != 0.0).then(|| normal / height)
}
