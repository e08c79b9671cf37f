//! A mesh under construction and the solids that scenes are made of.
//!
//! Solids are closed and wound counter-clockwise seen from outside. Each is built in the builder's current
//! [`Frame`], set by [`MeshBuilder::at`].

use super::maths::{Frame, TURN, on_circle, steps};
use crate::Mesh;
use glam::{Vec2, Vec3};

/// Collects triangles, then becomes a [`Mesh`].
pub(super) struct MeshBuilder {
    frame: Frame,
    positions: Vec<Vec3>,
    uvs: Vec<Vec2>,
    indices: Vec<u32>,
}

impl MeshBuilder {
    pub fn new() -> MeshBuilder {
        MeshBuilder { frame: Frame::IDENTITY, positions: Vec::new(), uvs: Vec::new(), indices: Vec::new() }
    }

    /// The frame of everything that follows.
    pub fn at(&mut self, frame: Frame) -> &mut MeshBuilder {
        self.frame = frame;
        self
    }

    pub fn triangle_count(&self) -> usize {
        self.indices.len() / 3
    }

    pub fn finish(self, name: &str, material: usize) -> Mesh {
        let MeshBuilder { positions, uvs, indices, .. } = self;
        Mesh { name: name.to_string(), positions, uvs, indices, material }
    }

    /// A vertex at a point of the current frame.
    pub fn vertex(&mut self, p: Vec3) -> u32 {
        self.positions.push(self.frame.point(p));
        (self.positions.len() - 1) as u32
    }

    /// A vertex with texture coordinates; a mesh has them for all of its vertices or for none.
    pub fn textured_vertex(&mut self, p: Vec3, uv: Vec2) -> u32 {
        self.uvs.push(uv);
        self.vertex(p)
    }

    pub fn triangle(&mut self, a: u32, b: u32, c: u32) {
        self.indices.extend([a, b, c]);
    }

    /// Two triangles on four vertices in counter-clockwise order.
    pub fn quad(&mut self, a: u32, b: u32, c: u32, d: u32) {
        self.indices.extend([a, b, c, a, c, d]);
    }

    /// A triangle with vertices of its own.
    pub fn facet(&mut self, points: [Vec3; 3]) {
        let [a, b, c] = points.map(|p| self.vertex(p));
        self.triangle(a, b, c);
    }

    /// A quad with vertices of its own.
    pub fn patch(&mut self, points: [Vec3; 4]) {
        let [a, b, c, d] = points.map(|p| self.vertex(p));
        self.quad(a, b, c, d);
    }

    /// Joins two rows of vertices by quads, triangles where a row is a single point: `upper` is left of `lower` for
    /// one who walks along it on the outer side.
    fn join(&mut self, lower: &[u32], upper: &[u32], closed: bool) {
        let count = lower.len().max(upper.len());
        let at = |row: &[u32], i: usize| row[if row.len() == 1 { 0 } else { i % count }];
        for i in 0..if closed { count } else { count - 1 } {
            let (a, b, c, d) = (at(lower, i), at(lower, i + 1), at(upper, i + 1), at(upper, i));
            match (a == b, c == d) {
                (false, false) => self.quad(a, b, c, d),
                (false, true) => self.triangle(a, b, c),
                (true, false) => self.triangle(a, c, d),
                (true, true) => {}
            }
        }
    }

    /// A surface over a `columns` × `rows` raster of cells; `point` gets (column, row).
    pub fn sheet(&mut self, columns: usize, rows: usize, mut point: impl FnMut(usize, usize) -> Vec3) {
        let mut previous: Vec<u32> = Vec::new();
        for row in 0..=rows {
            let current: Vec<u32> = (0..=columns).map(|column| self.vertex(point(column, row))).collect();
            if row > 0 {
                self.join(&previous, &current, false);
            }
            previous = current;
        }
    }

    /// A box of these edge lengths, centred.
    pub fn cuboid(&mut self, x: f32, y: f32, z: f32) {
        let lower = [Vec2::new(-0.5 * x, -0.5 * y), Vec2::new(0.5 * x, -0.5 * y)];
        let upper = lower.map(|p| p + Vec2::Y * y);
        self.slab(&lower, &upper, z);
    }

    /// A box that stands on the frame's origin.
    pub fn block(&mut self, x: f32, y: f32, z: f32) {
        let lower = [Vec2::new(-0.5 * x, 0.0), Vec2::new(0.5 * x, 0.0)];
        self.slab(&lower, &lower.map(|p| p + Vec2::Y * y), z);
    }

    /// A bar of rectangular section from `a` to `b`; `up` is the direction of its `height`.
    pub fn bar(&mut self, a: Vec3, b: Vec3, width: f32, height: f32, up: Vec3) {
        let along = (b - a).normalize();
        let side = along.cross(up).normalize() * (0.5 * width);
        let up = side.cross(along).normalize() * (0.5 * height);
        let ring = |p: Vec3| [p - side - up, p + side - up, p + side + up, p - side + up];
        let (near, far) = (ring(a).map(|p| self.vertex(p)), ring(b).map(|p| self.vertex(p)));
        self.join(&far, &near, true);
        self.quad(near[0], near[1], near[2], near[3]);
        self.quad(far[3], far[2], far[1], far[0]);
    }

    /// The solid between two outlines in x and y that run from left to right, of thickness `depth` about z = 0.
    pub fn slab(&mut self, lower: &[Vec2], upper: &[Vec2], depth: f32) {
        let z = 0.5 * depth;
        let mut row =
            |points: &[Vec2], z: f32| -> Vec<u32> { points.iter().map(|p| self.vertex(p.extend(z))).collect() };
        let (front_low, front_high) = (row(lower, z), row(upper, z));
        let (back_low, back_high) = (row(lower, -z), row(upper, -z));
        self.join(&front_low, &front_high, false);
        self.join(&front_high, &back_high, false);
        self.join(&back_high, &back_low, false);
        self.join(&back_low, &front_low, false);
        let last = lower.len() - 1;
        self.quad(back_low[0], front_low[0], front_high[0], back_high[0]);
        self.quad(front_low[last], back_low[last], back_high[last], front_high[last]);
    }

    /// A body of revolution about Y from a profile of (radius, height) that runs upwards on the outer side. A radius
    /// of 0 closes it; a profile whose ends have a radius stays open.
    pub fn lathe(&mut self, profile: &[(f32, f32)], segments: usize) {
        let circle: Vec<Vec2> = (0..segments).map(|i| on_circle(-TURN * i as f32 / segments as f32)).collect();
        let mut previous: Vec<u32> = Vec::new();
        for &(radius, y) in profile {
            let current: Vec<u32> = if radius == 0.0 {
                vec![self.vertex(Vec3::Y * y)]
            } else {
                circle.iter().map(|c| self.vertex(Vec3::new(c.x * radius, y, c.y * radius))).collect()
            };
            if !previous.is_empty() {
                self.join(&previous, &current, true);
            }
            previous = current;
        }
    }

    /// A closed cylinder of the frame's Y axis that stands on the origin.
    pub fn cylinder(&mut self, radius: f32, height: f32, segments: usize) {
        self.lathe(&[(0.0, 0.0), (radius, 0.0), (radius, height), (0.0, height)], segments);
    }

    /// A sphere about the origin, twice as many segments around as from pole to pole.
    pub fn sphere(&mut self, radius: f32, segments: usize) {
        let rings = (segments / 2).max(2);
        let mut profile: Vec<(f32, f32)> = (0..=rings)
            .map(|i| on_circle(TURN * (i as f32 / rings as f32 - 0.5) * 0.5))
            .map(|c| (c.x * radius, c.y * radius))
            .collect();
        profile[0].0 = 0.0;
        profile[rings].0 = 0.0;
        self.lathe(&profile, segments);
    }

    /// A closed tube along a path; `radius` gets the index of the point.
    pub fn tube(&mut self, path: &[Vec3], sides: usize, radius: impl Fn(usize) -> f32) {
        let mut rings = self.rings(path, sides, false, radius);
        let (first, last) = (vec![self.vertex(path[0])], vec![self.vertex(path[path.len() - 1])]);
        rings.insert(0, first);
        rings.push(last);
        for pair in rings.windows(2) {
            self.join(&pair[0], &pair[1], true);
        }
    }

    /// A straight closed tube.
    pub fn rod(&mut self, a: Vec3, b: Vec3, radius: f32, sides: usize) {
        self.tube(&[a, b], sides, |_| radius);
    }

    /// A tube along a flat path whose end meets its start.
    pub fn hoop(&mut self, path: &[Vec3], sides: usize, radius: f32) {
        let rings = self.rings(path, sides, true, |_| radius);
        for i in 0..rings.len() {
            self.join(&rings[i], &rings[(i + 1) % rings.len()], true);
        }
    }

    /// A torus about Y.
    pub fn torus(&mut self, radius: f32, thickness: f32, segments: usize, sides: usize) {
        let path: Vec<Vec3> = (0..segments)
            .map(|i| on_circle(TURN * i as f32 / segments as f32) * radius)
            .map(|c| Vec3::new(c.x, 0.0, c.y))
            .collect();
        self.hoop(&path, sides, thickness);
    }

    /// Circles across a path; each is turned as little as possible against the one before.
    fn rings(&mut self, path: &[Vec3], sides: usize, closed: bool, radius: impl Fn(usize) -> f32) -> Vec<Vec<u32>> {
        let count = path.len();
        let mut side = Vec3::ZERO;
        (0..count)
            .map(|i| {
                let (before, after) = if closed {
                    (path[(i + count - 1) % count], path[(i + 1) % count])
                } else {
                    (path[i.saturating_sub(1)], path[(i + 1).min(count - 1)])
                };
                let along = (after - before).normalize();
                if side == Vec3::ZERO {
                    side = super::maths::across(along).0;
                }
                side = (side - along * side.dot(along)).normalize();
                let other = along.cross(side);
                let r = radius(i);
                (0..sides)
                    .map(|k| on_circle(TURN * k as f32 / sides as f32) * r)
                    .map(|c| self.vertex(path[i] + side * c.x + other * c.y))
                    .collect()
            })
            .collect()
    }

    /// A square plate of side `cell` × `count`, its top at y = 0, with a round hole in the middle of every cell.
    pub fn perforated(&mut self, count: usize, cell: f32, hole: f32, thickness: f32) {
        /// Segments along a side of a cell; the circle has four times as many.
        const SIDE: usize = 8;
        let square: Vec<Vec2> = (0..4 * SIDE)
            .map(|i| {
                let t = (i % SIDE) as f32 / SIDE as f32 * 2.0 - 1.0;
                let p = Vec2::new(1.0, t);
                [p, Vec2::new(-p.y, p.x), -p, Vec2::new(p.y, -p.x)][i / SIDE] * (0.5 * cell)
            })
            .collect();
        let edge = 0.5 * cell * count as f32;
        let start = 0.5 * cell - edge;
        for i in 0..count * count {
            let middle = Vec2::new((i % count) as f32, (i / count) as f32) * cell + Vec2::splat(start);
            let mut ring = |scale: &dyn Fn(&Vec2) -> Vec2, y: f32| -> Vec<u32> {
                let at = |p: &Vec2| middle + scale(p);
                square.iter().rev().map(at).map(|p| self.vertex(Vec3::new(p.x, y, p.y))).collect()
            };
            let round = |p: &Vec2| p.normalize() * hole;
            let loops = [ring(&|p| *p, -thickness), ring(&|p| *p, 0.0), ring(&round, 0.0), ring(&round, -thickness)];
            self.join(&loops[1], &loops[2], true);
            self.join(&loops[2], &loops[3], true);
            self.join(&loops[3], &loops[0], true);
        }
        let rim: Vec<Vec3> = [(-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)]
            .map(|(x, z)| Vec3::new(x * edge, 0.0, z * edge))
            .into();
        for i in 0..4 {
            let (a, b, down) = (rim[i], rim[(i + 1) % 4], Vec3::Y * -thickness);
            self.patch([a + down, b + down, b, a]);
        }
    }
}

/// Points of an arc in the x-y plane about `center`, from angle `a` to `b`.
pub(super) fn arc(center: Vec2, radius: f32, a: f32, b: f32, count: usize) -> Vec<Vec2> {
    steps(a, b, count).map(|t| center + on_circle(t) * radius).collect()
}
