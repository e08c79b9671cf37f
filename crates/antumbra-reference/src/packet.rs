//! Eight rays at a time through the hierarchy.
//!
//! Only plain products and sums are used, no fused ones, so every instruction set gives the same bits.

use crate::bvh::{Bvh, Node};
use crate::exact::{self, Shear};
use crate::geometry::{Geometry, Triangle};
use fearless_simd::{Level, Simd, dispatch, f32x8, mask32x8, prelude::*};
use glam::Vec3;

/// Rays of a packet.
pub(crate) const LANES: usize = 8;

/// No triangle.
pub(crate) const NONE: u32 = u32::MAX;

/// Eight rays `origin + t * direction`, component by component.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Packet {
    pub origin: [[f32; LANES]; 3],
    pub direction: [[f32; LANES]; 3],
    /// The triangle that each ray leaves, which it cannot meet again, or [`NONE`].
    pub leaves: [u32; LANES],
    /// Open end of the rays; negative infinity for a lane that is not used.
    pub t_max: [f32; LANES],
}

impl Packet {
    /// A packet of no rays.
    pub fn unused() -> Packet {
        Packet { leaves: [NONE; LANES], t_max: [f32::NEG_INFINITY; LANES], ..Packet::default() }
    }

    /// Puts a ray in a lane.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, origin: Vec3, direction: Vec3, t_max: f32, leaves: u32) {
        for k in 0..3 {
            self.origin[k][lane] = origin[k];
            self.direction[k][lane] = direction[k];
        }
        self.t_max[lane] = t_max;
        self.leaves[lane] = leaves;
    }

    #[inline(always)]
    fn origin(&self, lane: usize) -> Vec3 {
        Vec3::new(self.origin[0][lane], self.origin[1][lane], self.origin[2][lane])
    }

    #[inline(always)]
    fn direction(&self, lane: usize) -> Vec3 {
        Vec3::new(self.direction[0][lane], self.direction[1][lane], self.direction[2][lane])
    }
}

/// What packets are traced against.
#[derive(Clone, Copy)]
pub(crate) struct Target<'a> {
    pub bvh: &'a Bvh,
    pub geometry: &'a Geometry,
    pub level: Level,
}

/// What a traversal needs besides, kept from call to call.
#[derive(Default)]
pub(crate) struct Scratch {
    stack: Vec<u32>,
    /// The triangle that hid a light point last: likely to hide the next one too.
    last_occluder: Option<u32>,
}

/// The nearest hit of a lane: distance and triangle, or [`NONE`].
pub(crate) type Nearest = (f64, u32);

impl Target<'_> {
    /// The nearest triangle with a distance over `t_min` of every lane.
    pub fn nearest(&self, packet: &Packet, t_min: f32, scratch: &mut Scratch) -> [Nearest; LANES] {
        dispatch!(self.level, simd => nearest(simd, self, packet, t_min, scratch))
    }

    /// For each packet the lanes, a bit each, that meet a caster at a distance over zero. Only the subtrees `entries`
    /// are searched.
    pub fn occluded(&self, packets: &[Packet], entries: &[u32], scratch: &mut Scratch, out: &mut Vec<u8>) {
        dispatch!(self.level, simd => occluded(simd, self, packets, entries, scratch, out))
    }
}

#[inline(always)]
fn nearest<S: Simd>(simd: S, target: &Target, packet: &Packet, t_min: f32, scratch: &mut Scratch) -> [Nearest; LANES] {
    let mut best = [(f64::INFINITY, NONE); LANES];
    let entries: &[u32] = if target.bvh.nodes.is_empty() { &[] } else { &[0] };
    by_axis(
        packet,
        #[inline(always)]
        |axis, t_max| {
            let on_hit = |triangle: u32, lane: usize, t: f64| {
                // Of two surfaces at one distance the first in the tree's order wins, whatever the order of the search.
                if t > f64::from(t_min) && (t, triangle) < best[lane] && is_solid(target, packet, triangle, lane, t) {
                    best[lane] = (t, triangle);
                }
                // Rounded up, or an equal distance would be culled.
                (best[lane].0.min(f64::from(packet.t_max[lane])) as f32).next_up()
            };
            let search = Search { target, packet, entries, shadow: false };
            search.run(simd, axis, t_max, &mut scratch.stack, on_hit);
        },
    );
    best
}

#[inline(always)]
fn occluded<S: Simd>(
    simd: S,
    target: &Target,
    packets: &[Packet],
    entries: &[u32],
    scratch: &mut Scratch,
    out: &mut Vec<u8>,
) {
    for packet in packets {
        let mut hidden = 0u8;
        by_axis(
            packet,
            #[inline(always)]
            |axis, t_max| {
                let mut last = scratch.last_occluder;
                let on_hit = |triangle: u32, lane: usize, t: f64| {
                    if t > 0.0 && t < f64::from(packet.t_max[lane]) && is_solid(target, packet, triangle, lane, t) {
                        hidden |= 1 << lane;
                        last = Some(triangle);
                        return f32::NEG_INFINITY;
                    }
                    packet.t_max[lane]
                };
                let search = Search { target, packet, entries, shadow: true };
                search.run(simd, axis, t_max, &mut scratch.stack, on_hit);
                scratch.last_occluder = last;
            },
        );
        out.push(hidden);
    }
}

/// Is the triangle there where the ray meets it, or cut out?
#[inline(always)]
fn is_solid(target: &Target, packet: &Packet, triangle: u32, lane: usize, t: f64) -> bool {
    let t_ = &target.geometry.triangles[triangle as usize];
    t_.cutout().is_none_or(|c| {
        let p = packet.origin(lane).as_dvec3() + packet.direction(lane).as_dvec3() * t;
        target.geometry.cutouts[c].is_solid(exact::barycentric(t_, p))
    })
}

/// Calls `run` with an axis that is good for the shear of some lanes, and with the ends of the rays, the other lanes'
/// being negative infinity, until every used lane has been served. Coherent rays are served in one call.
#[inline(always)]
fn by_axis(packet: &Packet, mut run: impl FnMut(usize, [f32; LANES])) {
    let mut waiting = packet.t_max;
    while let Some(lane) = (0..LANES).find(|&i| waiting[i] > f32::NEG_INFINITY) {
        let axis = packet.direction(lane).abs().max_position();
        let mut now = [f32::NEG_INFINITY; LANES];
        for i in 0..LANES {
            let d = packet.direction(i).abs();
            if i == lane || d[axis] >= 0.5 * d.max_element() {
                now[i] = std::mem::replace(&mut waiting[i], f32::NEG_INFINITY);
            }
        }
        run(axis, now);
    }
}

struct Search<'a> {
    target: &'a Target<'a>,
    packet: &'a Packet,
    entries: &'a [u32],
    /// Leave out triangles that cast no shadow.
    shadow: bool,
}

/// The rays in registers.
struct Rays<S: Simd> {
    origin: [f32x8<S>; 3],
    reciprocal: [f32x8<S>; 3],
    shear_x: f32x8<S>,
    shear_y: f32x8<S>,
    t_max: f32x8<S>,
}

impl Search<'_> {
    #[inline(always)]
    fn run<S: Simd>(
        &self,
        simd: S,
        axis: usize,
        t_max: [f32; LANES],
        stack: &mut Vec<u32>,
        on_hit: impl FnMut(u32, usize, f64) -> f32,
    ) {
        match axis {
            0 => self.run_along::<S, 0>(simd, t_max, stack, on_hit),
            1 => self.run_along::<S, 1>(simd, t_max, stack, on_hit),
            _ => self.run_along::<S, 2>(simd, t_max, stack, on_hit),
        }
    }

    /// Depth first, of two children the one first that the first ray meets first.
    #[inline(always)]
    fn run_along<S: Simd, const Z: usize>(
        &self,
        simd: S,
        t_max: [f32; LANES],
        stack: &mut Vec<u32>,
        mut on_hit: impl FnMut(u32, usize, f64) -> f32,
    ) {
        let mut rays = Rays::load::<Z>(simd, self.packet, t_max);
        let nodes = &self.target.bvh.nodes;
        stack.clear();
        stack.extend_from_slice(self.entries);
        while let Some(index) = stack.pop() {
            let node = &nodes[index as usize];
            if node.count > 0 {
                for k in node.first..node.first + node.count {
                    self.test::<S, Z>(simd, k, &mut rays, &mut on_hit);
                }
                if self.shadow && !rays.t_max.simd_gt(f32::NEG_INFINITY).any_true() {
                    return;
                }
                continue;
            }
            let (t0, hit0) = rays.meets(simd, &nodes[node.first as usize]);
            let (t1, hit1) = rays.meets(simd, &nodes[node.first as usize + 1]);
            let near_last = t1.simd_lt(t0).any_true();
            let (first, second) = if near_last { (0, 1) } else { (1, 0) };
            let hit = [hit0.any_true(), hit1.any_true()];
            for child in [first, second] {
                if hit[child] {
                    stack.push(node.first + child as u32);
                }
            }
        }
    }

    /// Eight rays against one triangle.
    #[inline(always)]
    fn test<S: Simd, const Z: usize>(
        &self,
        simd: S,
        index: u32,
        rays: &mut Rays<S>,
        on_hit: &mut impl FnMut(u32, usize, f64) -> f32,
    ) {
        let triangle = &self.target.geometry.triangles[index as usize];
        if self.shadow && triangle.is_receiver_only() {
            return;
        }
        let (inside, unsure) = rays.inside::<Z>(simd, triangle);
        let mut lanes = inside.to_bitmask();
        if lanes == 0 {
            return;
        }
        let unsure = unsure.to_bitmask();
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize;
            lanes &= lanes - 1;
            if self.packet.leaves[lane] == index {
                continue;
            }
            let (origin, direction) = (self.packet.origin(lane), self.packet.direction(lane));
            let shear = Shear { x: rays.shear_x.as_array()[lane], y: rays.shear_y.as_array()[lane] };
            if unsure >> lane & 1 == 0 || exact::is_inside::<Z>(triangle, origin, shear) {
                let t = exact::distance::<Z>(triangle, origin, direction);
                rays.t_max.as_mut_array()[lane] = on_hit(index, lane, t);
            }
        }
    }
}

impl<S: Simd> Rays<S> {
    // Arrays are built by hand here: closures in `map` are not always compiled for the instruction set.
    #[inline(always)]
    fn load<const Z: usize>(simd: S, packet: &Packet, t_max: [f32; LANES]) -> Rays<S> {
        let [ox, oy, oz] = packet.origin;
        let [dx, dy, dz] = packet.direction;
        let d = [f32x8::load_array(simd, dx), f32x8::load_array(simd, dy), f32x8::load_array(simd, dz)];
        Rays {
            origin: [f32x8::load_array(simd, ox), f32x8::load_array(simd, oy), f32x8::load_array(simd, oz)],
            reciprocal: [reciprocal(simd, d[0]), reciprocal(simd, d[1]), reciprocal(simd, d[2])],
            shear_x: d[(Z + 1) % 3] / d[Z],
            shear_y: d[(Z + 2) % 3] / d[Z],
            t_max: f32x8::load_array(simd, t_max),
        }
    }

    /// Where the rays enter the box, and which do: never misses a box that a ray touches [Ize 2013].
    #[inline(always)]
    fn meets(&self, simd: S, node: &Node) -> (f32x8<S>, mask32x8<S>) {
        let mut enter = f32x8::splat(simd, 0.0);
        let mut leave = self.t_max;
        for k in 0..3 {
            let t0 = (f32x8::splat(simd, node.min[k]) - self.origin[k]) * self.reciprocal[k];
            let t1 = (f32x8::splat(simd, node.max[k]) - self.origin[k]) * self.reciprocal[k];
            enter = enter.max(t0.min(t1));
            leave = leave.min(t0.max(t1));
        }
        // Each bound is off by at most three roundings, and the triangle test shears with three more.
        (enter, enter.simd_le(leave * (1.0 + 8.0 * f32::EPSILON)))
    }

    /// A point in the rays' own spaces, in which they run along +z through the origin.
    #[inline(always)]
    fn sheared<const Z: usize>(&self, simd: S, p: Vec3) -> (f32x8<S>, f32x8<S>) {
        let (kx, ky) = ((Z + 1) % 3, (Z + 2) % 3);
        let x = f32x8::splat(simd, p[kx]) - self.origin[kx];
        let y = f32x8::splat(simd, p[ky]) - self.origin[ky];
        let z = f32x8::splat(simd, p[Z]) - self.origin[Z];
        (x - self.shear_x * z, y - self.shear_y * z)
    }

    /// The rays that pass inside of the triangle's edges, from either side, and those for which an edge function came
    /// out as zero, so that only double precision tells [Woop 2013].
    #[inline(always)]
    fn inside<const Z: usize>(&self, simd: S, triangle: &Triangle) -> (mask32x8<S>, mask32x8<S>) {
        let a = self.sheared::<Z>(simd, triangle.vertices[0]);
        let b = self.sheared::<Z>(simd, triangle.vertices[1]);
        let c = self.sheared::<Z>(simd, triangle.vertices[2]);
        let u = c.0 * b.1 - c.1 * b.0;
        let v = a.0 * c.1 - a.1 * c.0;
        let w = b.0 * a.1 - b.1 * a.0;
        let zero = f32x8::splat(simd, 0.0);
        let lowest = u.min(v).min(w);
        let highest = u.max(v).max(w);
        let inside = (lowest.simd_ge(zero) | highest.simd_le(zero)) & self.t_max.simd_gt(f32::NEG_INFINITY);
        (inside, u.simd_eq(zero) | v.simd_eq(zero) | w.simd_eq(zero))
    }
}

/// A direction of zero becomes tiny: the box's padding keeps what lies in a face inside.
#[inline(always)]
fn reciprocal<S: Simd>(simd: S, d: f32x8<S>) -> f32x8<S> {
    f32x8::splat(simd, 1.0) / d.abs().max(f32x8::splat(simd, 1e-30)).copysign(d)
}
