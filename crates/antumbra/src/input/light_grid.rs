//! A coarse light-space grid over the part of a shadow map that surfaces take, for analysing a scene on the CPU.
//!
//! Coordinates are the map's own, tangents xy / z and inverse distance 1 / z, in which planes are affine.

use antumbra_scene::Scene;
use glam::{Vec2, Vec3, Vec4};

/// Cells per side.
const SIDE: usize = 192;

/// Position and size of the cells.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LightGrid {
    low: Vec2,
    cell: Vec2,
}

impl LightGrid {
    /// Number of cells.
    pub const COUNT: usize = SIDE * SIDE;

    /// Cells over this range of tangents, and a little beyond.
    pub fn over(low: Vec2, high: Vec2) -> LightGrid {
        let margin = (high - low) * 0.02 + 1e-4;
        LightGrid { low: low - margin, cell: (high - low + 2.0 * margin) / SIDE as f32 }
    }

    /// Planes in light space around all cells, and a little in front of the light.
    pub fn border(&self) -> [Vec4; 5] {
        window(self.low, self.low + self.cell * SIDE as f32, LEAST_DISTANCE)
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

    /// The cells up to `reach` cells away from that of a tangent, within the grid.
    pub fn around(&self, t: Vec2, reach: i32) -> impl Iterator<Item = usize> {
        let at = ((t - self.low) / self.cell).floor();
        let inside = move |v: f32, d: i32| Some(v as i32 + d).filter(|v| (0..SIDE as i32).contains(v));
        let of_row =
            move |y: i32| (-reach..=reach).filter_map(move |dx| Some(y as usize * SIDE + inside(at.x, dx)? as usize));
        (-reach..=reach).filter_map(move |dy| inside(at.y, dy)).flat_map(of_row)
    }
}

/// Nothing is nearer to the light's plane, metres: distances are divided by.
const LEAST_DISTANCE: f32 = 1e-9;

/// Planes in light space around a range of tangents, from a distance on.
pub(crate) fn window(low: Vec2, high: Vec2, near: f32) -> [Vec4; 5] {
    [
        Vec4::new(0.0, 0.0, 1.0, -near),
        Vec4::new(1.0, 0.0, -low.x, 0.0),
        Vec4::new(-1.0, 0.0, high.x, 0.0),
        Vec4::new(0.0, 1.0, -low.y, 0.0),
        Vec4::new(0.0, -1.0, high.y, 0.0),
    ]
}

/// Triangles of a run: some milliseconds of work.
const RUN: usize = 1 << 14;

/// A run of triangles of one instance.
pub(crate) struct Run<'a> {
    scene: &'a Scene,
    /// Index of the instance.
    pub instance: usize,
    indices: &'a [u32],
}

/// The triangles of all instances in runs, so that work over a large scene can be done piece by piece.
pub(crate) fn runs(scene: &Scene) -> impl Iterator<Item = Run<'_>> {
    scene.instances.iter().enumerate().flat_map(move |(index, instance)| {
        let indices = &scene.meshes[instance.mesh].indices;
        indices.chunks(3 * RUN).map(move |indices| Run { scene, instance: index, indices })
    })
}

impl Run<'_> {
    /// World-space corners.
    pub fn in_world(&self) -> impl Iterator<Item = [Vec3; 3]> {
        let instance = &self.scene.instances[self.instance];
        let positions = &self.scene.meshes[instance.mesh].positions;
        let corner = move |i: u32| instance.world_from_object.transform_point3(positions[i as usize]);
        self.indices.chunks_exact(3).map(move |t| [t[0], t[1], t[2]].map(corner))
    }

    /// Corners in light space of the triangles that lie in front of the light.
    pub fn in_light_space(&self) -> impl Iterator<Item = [Vec3; 3]> {
        let center = self.scene.light.center;
        let (right, up, forward) = self.scene.light.basis();
        let to_light = move |p: Vec3| {
            let d = p - center;
            Vec3::new(d.dot(right), d.dot(up), d.dot(forward))
        };
        self.in_world().map(move |corners| corners.map(to_light)).filter(|corners| corners.iter().any(|c| c.z > 0.0))
    }
}

/// Work in stages, each of them over all runs of a scene's triangles.
pub(crate) struct Stages<'a> {
    scene: &'a Scene,
    runs: Box<dyn Iterator<Item = Run<'a>> + 'a>,
    stage: usize,
    count: usize,
}

impl<'a> Stages<'a> {
    pub fn new(scene: &'a Scene, count: usize) -> Stages<'a> {
        Stages { scene, runs: Box::new(runs(scene)), stage: 0, count }
    }
}

impl<'a> Iterator for Stages<'a> {
    /// The stage, counted from 0, and the run that is next.
    type Item = (usize, Run<'a>);

    fn next(&mut self) -> Option<Self::Item> {
        while self.stage < self.count {
            if let Some(run) = self.runs.next() {
                return Some((self.stage, run));
            }
            (self.runs, self.stage) = (Box::new(runs(self.scene)), self.stage + 1);
        }
        None
    }
}

/// The corners of the part of a convex polygon that lies on the upper side of all planes [Sutherland, Hodgman 1974].
pub(crate) fn clipped(corners: &[Vec3], planes: &[Vec4]) -> Vec<Vec3> {
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
