//! Pipes on random routes through a lattice that do not touch each other, and steel parts around them.

use super::maths::{Frame, Random, TURN, on_circle};
use super::shapes::MeshBuilder;
use glam::{IVec3, Vec3};

/// Edge of a cell of the lattice in which pipes are routed, in metres.
pub(super) const CELL: f32 = 0.25;

/// Which cells of a box-shaped space are taken.
pub(super) struct Space {
    origin: Vec3,
    size: IVec3,
    taken: Vec<bool>,
}

impl Space {
    /// A free space from `origin`, `size` metres along each axis.
    pub fn new(origin: Vec3, size: Vec3) -> Space {
        let size = (size / CELL).ceil().as_ivec3();
        Space { origin, size, taken: vec![false; (size.x * size.y * size.z) as usize] }
    }

    /// Middle of a cell.
    pub fn point(&self, cell: IVec3) -> Vec3 {
        self.origin + (cell.as_vec3() + Vec3::splat(0.5)) * CELL
    }

    /// The cells of a box given in metres, clipped to this space.
    fn cells(&self, min: Vec3, max: Vec3) -> impl Iterator<Item = usize> + use<> {
        let size = self.size;
        let low = ((min - self.origin) / CELL).floor().as_ivec3().max(IVec3::ZERO);
        let high = ((max - self.origin) / CELL).ceil().as_ivec3().min(size);
        (low.z..high.z).flat_map(move |z| {
            (low.y..high.y).flat_map(move |y| (low.x..high.x).map(move |x| ((z * size.y + y) * size.x + x) as usize))
        })
    }

    /// Marks the cells of a box as taken.
    pub fn take(&mut self, min: Vec3, max: Vec3) {
        for cell in self.cells(min, max) {
            self.taken[cell] = true;
        }
    }

    fn is_free(&self, min: Vec3, max: Vec3) -> bool {
        let inside = min.cmpge(self.origin).all() && max.cmple(self.origin + self.size.as_vec3() * CELL).all();
        inside && self.cells(min, max).all(|cell| !self.taken[cell])
    }

    fn random_cell(&self, random: &mut Random) -> IVec3 {
        IVec3::from_array(self.size.to_array().map(|n| random.below(n as usize) as i32))
    }
}

/// The corners of a pipe's path and its radius.
pub(super) struct Route {
    pub corners: Vec<Vec3>,
    pub radius: f32,
}

/// Marks a free route of up to `legs` straight legs along the axes. `None` if it has fewer than two.
pub(super) fn route(space: &mut Space, radius: f32, legs: usize, random: &mut Random) -> Option<Route> {
    let mut cell = space.random_cell(random);
    let around = Vec3::splat(radius + 0.03);
    let sweep = |a: Vec3, b: Vec3| (a.min(b) - around, a.max(b) + around);
    let mut corners = vec![space.point(cell)];
    // A leg is never shorter than the two elbows at its ends.
    let shortest = (5.0 * radius / CELL).ceil() as i32 + 1;
    let mut last_axis = 3;
    for _ in 0..legs {
        let leg = (0..6).find_map(|_| {
            // Along the plant (z) most often, vertically least often.
            let axis = [0, 0, 1, 2, 2, 2][random.below(6)];
            let reach = [22, 14, 60][axis];
            let length = shortest + random.below(reach) as i32;
            let step = if random.below(2) == 0 { length } else { -length };
            let next = cell + IVec3::AXES[axis] * step;
            let from = space.point(cell + IVec3::AXES[axis] * (step.signum() * (2.0 * radius / CELL).ceil() as i32));
            let (min, max) = sweep(from, space.point(next));
            (axis != last_axis && space.is_free(min, max)).then_some((axis, next))
        });
        let Some((axis, next)) = leg else { break };
        corners.push(space.point(next));
        (cell, last_axis) = (next, axis);
    }
    if corners.len() < 3 {
        return None;
    }
    for pair in corners.windows(2) {
        let (min, max) = sweep(pair[0], pair[1]);
        space.take(min, max);
    }
    Some(Route { corners, radius })
}

/// Adds rods from which the horizontal legs of a route hang, or posts where the ground is near. Rods and posts that
/// would touch something are left out. `level` is the distance between ceilings.
pub(super) fn hang(m: &mut MeshBuilder, space: &mut Space, route: &Route, level: f32) {
    const SPACING: f32 = 1.5;
    let clear = Vec3::new(0.02, 0.0, 0.02);
    for leg in route.corners.windows(2).filter(|leg| leg[0].y == leg[1].y) {
        let length = (leg[1] - leg[0]).length();
        let count = (length / SPACING).ceil() as usize;
        for i in 0..count {
            let p = leg[0].lerp(leg[1], (i as f32 + 0.5) / count as f32);
            let ceiling = (p.y / level).ceil() * level - 0.2;
            let stands = p.y < 0.45 * level;
            let (low, high) = if stands { (0.0, p.y - route.radius) } else { (p.y + route.radius, ceiling) };
            let outside = Vec3::new(0.0, if stands { CELL } else { 0.0 }, 0.0);
            let (min, max) = (Vec3::new(p.x, low, p.z) - clear, Vec3::new(p.x, high, p.z) + clear);
            // The cells that the pipe itself takes do not count.
            let gap = Vec3::Y * (CELL + 0.04);
            let (from, to) = if stands { (min + outside, max - gap) } else { (min + gap, max) };
            if high - low > 0.1 && (to.y <= from.y || space.is_free(from, to)) {
                space.take(from, to);
                let thick = if stands { 0.05 } else { 0.016 };
                m.at(Frame::at(p.x, low - 0.02, p.z)).cylinder(thick, high - low + 0.04, 12);
                m.at(Frame::along(p, leg[1] - leg[0]).shift(0.0, -0.03, 0.0)).cylinder(route.radius + 0.012, 0.06, 24);
            }
        }
    }
}

/// The pipe of a route: straight legs, round elbows, flanges where the two meet and along the way.
pub(super) fn pipe(m: &mut MeshBuilder, route: &Route) {
    const ELBOW: usize = 10;
    let Route { corners, radius } = route;
    let bend = 1.6 * radius;
    let mut path = Vec::new();
    let mut joints = Vec::new();
    for (i, &corner) in corners.iter().enumerate() {
        let before = i.checked_sub(1).map(|k| (corners[k] - corner).normalize());
        let after = corners.get(i + 1).map(|next| (*next - corner).normalize());
        match (before, after) {
            (Some(a), Some(b)) => {
                // A quarter circle from one leg to the next.
                let center = corner + (a + b) * bend;
                path.extend((0..=ELBOW).map(|k| {
                    let c = on_circle(0.25 * TURN * k as f32 / ELBOW as f32) * bend;
                    center - b * c.x - a * c.y
                }));
                joints.push((corner + a * (bend + 0.02), a));
                joints.push((corner + b * (bend + 0.02), b));
            }
            (a, b) => {
                path.push(corner);
                joints.extend(a.or(b).map(|d| (corner + d * 0.03, d)));
            }
        }
    }
    let sides = 12 + 2 * (radius / 0.03) as usize;
    m.at(Frame::IDENTITY).tube(&subdivided(&path, 0.6), sides, |_| *radius);
    for (point, direction) in joints {
        flange(m, Frame::along(point, direction), *radius, sides);
    }
}

/// The path with points added so that none are further apart than `longest`.
fn subdivided(path: &[Vec3], longest: f32) -> Vec<Vec3> {
    let mut result = vec![path[0]];
    for pair in path.windows(2) {
        let pieces = ((pair[1] - pair[0]).length() / longest).ceil().max(1.0);
        result.extend((1..=pieces as usize).map(|i| pair[0].lerp(pair[1], i as f32 / pieces)));
    }
    result
}

/// A flange: two collars around the frame's Y axis, bolted together.
fn flange(m: &mut MeshBuilder, frame: Frame, radius: f32, sides: usize) {
    let (outer, half) = (radius * 1.28 + 0.025, 0.012 + 0.12 * radius);
    m.at(frame).lathe(
        &[
            (0.0, -half),
            (outer, -half),
            (outer, -0.004),
            (outer - 0.008, -0.003),
            (outer - 0.008, 0.003),
            (outer, 0.004),
            (outer, half),
            (0.0, half),
        ],
        sides,
    );
    let bolts = 6 + 2 * (radius / 0.05) as usize;
    for i in 0..bolts {
        let c = on_circle(TURN * (i as f32 + 0.5) / bolts as f32) * (0.5 * (radius + outer));
        m.at(frame.shift(c.x, -half - 0.012, c.y)).cylinder(0.16 * (outer - radius) + 0.006, 2.0 * half + 0.024, 6);
    }
}

/// A ladder from the frame's origin up along Y, its rungs along X, with safety hoops from 2.2 m on.
pub(super) fn ladder(m: &mut MeshBuilder, frame: Frame, height: f32) {
    m.at(frame);
    for side in [-0.22, 0.22] {
        m.rod(Vec3::new(side, 0.0, 0.0), Vec3::new(side, height + 1.0, 0.0), 0.022, 10);
    }
    for i in 1..=(height / 0.28) as usize {
        let y = 0.28 * i as f32;
        m.rod(Vec3::new(-0.22, y, 0.0), Vec3::new(0.22, y, 0.0), 0.013, 8);
    }
    let hoop = |k: usize, y: f32| {
        let c = on_circle(0.5 * TURN * k as f32 / 12.0);
        Vec3::new(0.22 * c.x * 1.6, y, 0.62 * c.y)
    };
    let first = 2.2;
    for i in 0..((height + 1.0 - first) / 0.8).max(0.0) as usize + 1 {
        let path: Vec<Vec3> = (0..=12).map(|k| hoop(k, first + 0.8 * i as f32)).collect();
        m.tube(&path, 8, |_| 0.014);
    }
    for k in [2, 4, 6, 8, 10] {
        m.rod(hoop(k, first), hoop(k, height + 1.0), 0.01, 6);
    }
}

/// Handrails and posts from `a` to `b`; the post at `b` belongs to the next run.
pub(super) fn railing(m: &mut MeshBuilder, a: Vec3, b: Vec3) {
    m.at(Frame::IDENTITY);
    let pieces = ((b - a).length() / 1.2).ceil() as usize;
    for i in 0..pieces {
        let p = a.lerp(b, i as f32 / pieces as f32);
        m.rod(p - Vec3::Y * 0.05, p + Vec3::Y * 1.1, 0.022, 10);
    }
    for y in [0.6, 1.1] {
        m.rod(a + Vec3::Y * y, b + Vec3::Y * y, 0.02, 10);
    }
    m.bar(a + Vec3::Y * 0.1, b + Vec3::Y * 0.1, 0.008, 0.14, Vec3::Y);
}

/// An I-section beam from `a` to `b`, `height` along the direction nearest to `up`.
pub(super) fn beam(m: &mut MeshBuilder, a: Vec3, b: Vec3, width: f32, height: f32, up: Vec3) {
    m.at(Frame::IDENTITY);
    let along = (b - a).normalize();
    let up = (up - along * up.dot(along)).normalize();
    let flange = 0.12 * height;
    let offset = up * (0.5 * (height - flange));
    m.bar(a + offset, b + offset, width, flange, up);
    m.bar(a - offset, b - offset, width, flange, up);
    m.bar(a, b, 0.12 * width, height - 1.9 * flange, up);
}
