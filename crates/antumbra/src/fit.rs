//! The frustum of a shadow map from the light's centre, as narrow as what can cast on what is seen.
//!
//! All is measured in the map's own coordinates, tangents xy / z and inverse distance 1 / z, in which planes are affine.

use crate::{View, passes::culling::MapView};
use antumbra_scene::{Aabb, RectLight, Scene};
use glam::{Vec2, Vec3, Vec4};

/// A symmetric frustum from the light's centre along its normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadowFrustum {
    /// Half the opening along the light's edges, as tangents.
    pub tan_half: Vec2,
    /// Casters nearer to the light's plane than this are not seen, metres.
    pub near: f32,
    /// Distance from the light's plane of the nearest and of the farthest surface that takes shadows, metres. Maps from
    /// other points of the light are made as much wider as these are apart; a receiver outside of its map counts as lit.
    pub receivers: [f32; 2],
    /// Distance from the light's plane of the nearest surface that casts, metres; surfaces that are nearer count as there
    /// for techniques that store depth as a part of a range.
    pub nearest_caster: f32,
}

/// Half the widest frustum that is fitted, as a tangent: 160 degrees.
const MAX_TAN: f32 = 5.67;

/// How much longer than wide a texel may be: techniques read square windows of texels, so that what the longer side lacks
/// is lost on the shorter one too.
const MAX_ELONGATION: f32 = 4.0;

/// Casters and receivers nearer to the light than this part of the farthest distance do not widen a frustum.
const NEAREST: f32 = 0.02;

/// Cells a side of the grid that remembers the deepest surface.
const CELLS: usize = 192;

/// A caster must be nearer to the light than the deepest surface behind it by this part of its distance.
const SEPARATION: f32 = 2e-3;

impl ShadowFrustum {
    /// A square frustum of an opening in degrees.
    pub fn of_degrees(fov_deg: f32, near: f32, receivers: [f32; 2]) -> ShadowFrustum {
        let tan_half = Vec2::splat((0.5 * fov_deg).to_radians().tan());
        ShadowFrustum { tan_half, near, receivers, nearest_caster: receivers[0] }
    }

    /// The smallest frustum around a box, for hosts that know nothing closer. The light's own setting counts if it has
    /// one.
    pub fn around(light: &RectLight, bounds: &Aabb) -> ShadowFrustum {
        let corners = bounds.corners().map(|c| light.light_from_world(c));
        let far = corners.iter().fold(0.0f32, |m, c| m.max(c.z));
        let nearest = far * NEAREST;
        let low = corners.iter().fold(far, |m, c| m.min(c.z)).max(nearest);
        let receivers = [low.max(1e-6), far.max(1e-6)];
        if let Some(degrees) = light.shadow_fov_deg {
            return ShadowFrustum::of_degrees(degrees, near_of(far), receivers);
        }
        let tan = corners.iter().fold(Vec2::splat(1e-3), |m, c| m.max(c.truncate().abs() / c.z.max(nearest)));
        ShadowFrustum {
            tan_half: tan.min(Vec2::splat(MAX_TAN)) * 1.01,
            near: near_of(far),
            receivers,
            nearest_caster: receivers[0],
        }
    }

    /// The frustum that holds what casts shadows on what a view sees, and these shadows. Surfaces with nothing behind
    /// them (the ground, as a rule) cast on nothing, so they do not widen it. Reads every triangle: a few hundred
    /// milliseconds for millions of them, once for a scene whose light and view rest.
    pub fn fit(scene: &Scene, view: &View) -> ShadowFrustum {
        let around = ShadowFrustum::around(&scene.light, &scene.bounds());
        if scene.light.shadow_fov_deg.is_some() {
            return around;
        }
        let seen = seen_range(scene, view);
        if seen.is_empty() {
            return around;
        }
        let half_light = scene.light.size * 0.5;
        let deepest = DeepestSurface::of(scene, &seen);
        let mut casting = Vec2::ZERO;
        for_each_triangle(scene, |corners, receiver_only| {
            if !receiver_only {
                casting = casting.max(deepest.reach_of_caster(corners, half_light));
            }
        });
        // Receivers beyond the reach of casters are lit, casters beyond that of receivers are of no use.
        let tan = casting.min(seen.reach(half_light, deepest.nearest_q));
        if tan.max_element() <= 0.0 {
            return around;
        }
        let tan = tan.max(Vec2::splat(tan.max_element() / MAX_ELONGATION));
        // What is nearer to the light than every caster takes no shadow.
        let near_q = seen.near_q.min(deepest.nearest_q).max(seen.far_q);
        let [low, high] = around.receivers;
        ShadowFrustum {
            tan_half: (tan * 1.01).clamp(Vec2::splat(1e-3), Vec2::splat(MAX_TAN)),
            near: around.near,
            receivers: [(1.0 / near_q).clamp(low, high), (1.0 / seen.far_q).clamp(low, high)],
            nearest_caster: (1.0 / deepest.nearest_q).clamp(low, high),
        }
    }
}

/// A near plane that cuts nothing off: inverse distances are stored as floating-point numbers, so it may be close.
fn near_of(far: f32) -> f32 {
    (far * 1e-4).max(1e-6)
}

/// Calls with the world-space corners of every triangle.
fn for_each_world_triangle(scene: &Scene, mut call: impl FnMut([Vec3; 3], bool)) {
    let mut moved = Vec::new();
    for instance in &scene.instances {
        let mesh = &scene.meshes[instance.mesh];
        moved.clear();
        moved.extend(mesh.positions.iter().map(|p| instance.world_from_object.transform_point3(*p)));
        for t in mesh.indices.chunks_exact(3) {
            call([t[0], t[1], t[2]].map(|i| moved[i as usize]), instance.receiver_only);
        }
    }
}

/// Calls with every triangle that lies in front of the light: three corners in light space.
fn for_each_triangle(scene: &Scene, mut call: impl FnMut([Vec3; 3], bool)) {
    let light = scene.light;
    let (right, up, forward) = light.basis();
    for_each_world_triangle(scene, |corners, receiver_only| {
        let corners = corners.map(|p| {
            let d = p - light.center;
            Vec3::new(d.dot(right), d.dot(up), d.dot(forward))
        });
        if corners.iter().any(|c| c.z > 0.0) {
            call(corners, receiver_only);
        }
    });
}

/// The part of the map that visible surfaces take.
#[derive(Clone, Copy, Debug)]
struct Seen {
    low: Vec2,
    high: Vec2,
    /// Inverse distance of the farthest, and of the nearest.
    far_q: f32,
    near_q: f32,
}

impl Seen {
    fn is_empty(&self) -> bool {
        self.low.x > self.high.x
    }

    /// Half the frustum that holds all that can hide any of the light from them, casters being as near as `nearest_q`.
    fn reach(&self, half_light: Vec2, nearest_q: f32) -> Vec2 {
        self.low.abs().max(self.high.abs()) + half_light * (nearest_q - self.far_q).max(0.0)
    }
}

/// Where the surfaces within the view's frustum lie in the map.
fn seen_range(scene: &Scene, view: &View) -> Seen {
    let planes = MapView::new(view.clip_from_world()).planes_ws;
    let mut seen = Seen { low: Vec2::INFINITY, high: Vec2::NEG_INFINITY, far_q: f32::INFINITY, near_q: 0.0 };
    for_each_world_triangle(scene, |corners, _| {
        for p in clipped(&corners, &planes) {
            let l = scene.light.light_from_world(p);
            if l.z > 0.0 {
                let t = (l.truncate() / l.z).clamp(Vec2::splat(-MAX_TAN), Vec2::splat(MAX_TAN));
                seen.low = seen.low.min(t);
                seen.high = seen.high.max(t);
                seen.far_q = seen.far_q.min(1.0 / l.z);
                seen.near_q = seen.near_q.max(1.0 / l.z);
            }
        }
    });
    seen
}

/// The corners of the part of a triangle that lies on the upper side of all planes [Sutherland, Hodgman 1974].
fn clipped(corners: &[Vec3; 3], planes: &[Vec4]) -> Vec<Vec3> {
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

/// The surface that is farthest from the light, for each cell of the map: what is nearer casts on it.
struct DeepestSurface {
    low: Vec2,
    cell: Vec2,
    /// Inverse distance as an affine function of the tangent: (x, y, constant); infinite where there is nothing.
    planes: Vec<Vec3>,
    /// Of the nearest surface of all.
    nearest_q: f32,
}

impl DeepestSurface {
    fn of(scene: &Scene, seen: &Seen) -> DeepestSurface {
        // Shadows reach visible surfaces from casters that project a little beside them.
        let margin = (seen.high - seen.low) * 0.02 + 1e-4;
        let low = seen.low - margin;
        let cell = (seen.high + margin - low) / CELLS as f32;
        let nothing = Vec3::new(0.0, 0.0, f32::INFINITY);
        let mut grid = DeepestSurface { low, cell, planes: vec![nothing; CELLS * CELLS], nearest_q: 0.0 };
        for_each_triangle(scene, |corners, receiver_only| grid.add(corners, receiver_only));
        grid
    }

    fn add(&mut self, corners: [Vec3; 3], receiver_only: bool) {
        let Some(plane) = plane_of(&corners) else { return };
        let polygon = clipped(&corners, &self.rim());
        if !receiver_only {
            self.nearest_q = polygon.iter().fold(self.nearest_q, |q, c| q.max(1.0 / c.z));
        }
        let mut planes = std::mem::take(&mut self.planes);
        self.for_each_cell(&polygon, |cell, t| {
            if plane.dot(t.extend(1.0)) < planes[cell].dot(t.extend(1.0)) {
                planes[cell] = plane;
            }
        });
        self.planes = planes;
    }

    /// Planes in light space around the part of the map that the grid covers, and a little in front of the light.
    fn rim(&self) -> [Vec4; 5] {
        let high = self.low + self.cell * CELLS as f32;
        [
            Vec4::new(0.0, 0.0, 1.0, -1e-5),
            Vec4::new(1.0, 0.0, -self.low.x, 0.0),
            Vec4::new(-1.0, 0.0, high.x, 0.0),
            Vec4::new(0.0, 1.0, -self.low.y, 0.0),
            Vec4::new(0.0, -1.0, high.y, 0.0),
        ]
    }

    /// Half the frustum that holds a caster and the shadow that it casts on the deepest surface; 0 if it casts on
    /// nothing that the grid covers.
    fn reach_of_caster(&self, corners: [Vec3; 3], half_light: Vec2) -> Vec2 {
        let mut reach = Vec2::ZERO;
        let mut cast = |t: Vec2, q: f32, behind: f32| {
            if behind.is_finite() && q > behind * (1.0 + SEPARATION) {
                reach = reach.max(t.abs() + half_light * (q - behind));
            }
        };
        let polygon = clipped(&corners, &self.rim());
        for c in &polygon {
            let t = c.truncate() / c.z;
            cast(t, 1.0 / c.z, self.deepest_q(t));
        }
        // A large triangle may cast with its middle where its corners hang over nothing.
        if let Some(plane) = plane_of(&corners) {
            self.for_each_cell(&polygon, |cell, t| {
                cast(t, plane.dot(t.extend(1.0)), self.planes[cell].dot(t.extend(1.0)))
            });
        }
        reach
    }

    /// Calls with the number and the middle of each cell whose middle lies in a convex polygon in light space.
    fn for_each_cell(&self, polygon: &[Vec3], mut call: impl FnMut(usize, Vec2)) {
        let t: Vec<Vec2> = polygon.iter().map(|c| (c.truncate() / c.z - self.low) / self.cell - 0.5).collect();
        let low = t.iter().fold(Vec2::INFINITY, |m, p| m.min(*p)).ceil().max(Vec2::ZERO);
        let high = t.iter().fold(Vec2::NEG_INFINITY, |m, p| m.max(*p)).floor().min(Vec2::splat((CELLS - 1) as f32));
        for j in low.y as i32..=high.y as i32 {
            for i in low.x as i32..=high.x as i32 {
                let p = Vec2::new(i as f32, j as f32);
                let side = |k: usize| (t[(k + 1) % t.len()] - t[k]).perp_dot(p - t[k]);
                if (0..t.len()).all(|k| side(k) >= 0.0) || (0..t.len()).all(|k| side(k) <= 0.0) {
                    call(j as usize * CELLS + i as usize, self.low + (p + 0.5) * self.cell);
                }
            }
        }
    }

    /// Inverse distance of the deepest surface at a tangent, the smallest of the cells around it: what hangs over an
    /// edge casts on what lies beside it.
    fn deepest_q(&self, t: Vec2) -> f32 {
        let at = ((t - self.low) / self.cell).floor();
        let mut deepest = f32::INFINITY;
        for dy in -1..=1 {
            for dx in -1..=1 {
                let (x, y) = (at.x as i32 + dx, at.y as i32 + dy);
                if x >= 0 && y >= 0 && (x as usize) < CELLS && (y as usize) < CELLS {
                    let q = self.planes[y as usize * CELLS + x as usize].dot(t.extend(1.0));
                    deepest = if q > 0.0 { deepest.min(q) } else { deepest };
                }
            }
        }
        deepest
    }
}

/// The inverse distance of a triangle's plane as an affine function of the tangent; none if it is edge-on to the light.
fn plane_of(corners: &[Vec3; 3]) -> Option<Vec3> {
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    let height = normal.dot(corners[0]);
    (height != 0.0).then(|| normal / height)
}
