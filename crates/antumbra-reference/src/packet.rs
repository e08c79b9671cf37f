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

/// The hierarchy that packets are traced against.
#[derive(Clone, Copy)]
pub(crate) struct Target<'a> {
    pub bvh: &'a Bvh,
    pub geometry: &'a Geometry,
    pub level: Level,
}

/// Buffers of a traversal, kept from call to call.
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
    let mut on_hit = |triangle: u32, lane: usize, t: f64| {
        let in_reach = t > f64::from(t_min) && t < f64::from(packet.t_max[lane]);
        // Of two surfaces at one distance the first in the tree's order wins, whatever the order of the search.
        if in_reach && (t, triangle) < best[lane] && is_solid(target, packet, triangle, lane, t) {
            best[lane] = (t, triangle);
        }
        // Rounded up, or an equal distance would be culled.
        packet.t_max[lane].min((best[lane].0 as f32).next_up())
    };
    Search { target, packet, entries, first: None, shadow: false }.run(simd, &mut scratch.stack, &mut on_hit);
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
        let first = scratch.last_occluder;
        let mut on_hit = |triangle: u32, lane: usize, t: f64| {
            if t > 0.0 && t < f64::from(packet.t_max[lane]) && is_solid(target, packet, triangle, lane, t) {
                hidden |= 1 << lane;
                scratch.last_occluder = Some(triangle);
                return f32::NEG_INFINITY;
            }
            packet.t_max[lane]
        };
        Search { target, packet, entries, first, shadow: true }.run(simd, &mut scratch.stack, &mut on_hit);
        out.push(hidden);
    }
}

/// Is the triangle there where the ray meets it, or cut out?
#[inline(always)]
fn is_solid(target: &Target, packet: &Packet, triangle: u32, lane: usize, t: f64) -> bool {
    let surface = &target.geometry.triangles[triangle as usize];
    surface.cutout().is_none_or(|c| {
        let p = packet.origin(lane).as_dvec3() + packet.direction(lane).as_dvec3() * t;
        target.geometry.cutouts[c].is_solid(exact::barycentric(surface, p))
    })
}

struct Search<'a> {
    target: &'a Target<'a>,
    packet: &'a Packet,
    entries: &'a [u32],
    /// A triangle to try before all others.
    first: Option<u32>,
    /// Leave out triangles that cast no shadow, and stop when all rays have hit something.
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
    /// Serves the lanes in groups that share an axis for their shear; coherent rays are one group.
    ///
    /// `on_hit` gets triangle, lane and distance, and gives the ray's new end.
    #[inline(always)]
    fn run<S: Simd>(&self, simd: S, stack: &mut Vec<u32>, on_hit: &mut impl FnMut(u32, usize, f64) -> f32) {
        let used = f32x8::load_array(simd, self.packet.t_max);
        let none = f32x8::splat(simd, f32::NEG_INFINITY);
        let [dx, dy, dz] = self.packet.direction;
        let d = [f32x8::load_array(simd, dx), f32x8::load_array(simd, dy), f32x8::load_array(simd, dz)];
        let size = [d[0].abs(), d[1].abs(), d[2].abs()];
        let enough = size[0].max(size[1]).max(size[2]) * 0.5;
        let mut waiting = used.simd_gt(none);
        while waiting.any_true() {
            let lane = waiting.to_bitmask().trailing_zeros() as usize;
            let axis = self.packet.direction(lane).abs().max_position();
            let group = size[axis].simd_ge(enough) & waiting;
            waiting &= !group;
            let t_max = group.select(used, none);
            match axis {
                0 => self.walk::<S, 0>(simd, Rays::new::<0>(simd, self.packet, d, t_max), stack, on_hit),
                1 => self.walk::<S, 1>(simd, Rays::new::<1>(simd, self.packet, d, t_max), stack, on_hit),
                _ => self.walk::<S, 2>(simd, Rays::new::<2>(simd, self.packet, d, t_max), stack, on_hit),
            }
        }
    }

    /// Depth first; where the order matters, of two children the one first that some ray meets first.
    #[inline(always)]
    fn walk<S: Simd, const Z: usize>(
        &self,
        simd: S,
        mut rays: Rays<S>,
        stack: &mut Vec<u32>,
        on_hit: &mut impl FnMut(u32, usize, f64) -> f32,
    ) {
        if let Some(k) = self.first
            && self.test::<S, Z>(simd, k, &mut rays, on_hit)
            && rays.are_done()
        {
            return;
        }
        let nodes = &self.target.bvh.nodes;
        stack.clear();
        stack.extend_from_slice(self.entries);
        while let Some(index) = stack.pop() {
            let node = &nodes[index as usize];
            if node.count > 0 {
                let mut hit = false;
                for k in node.first..node.first + node.count {
                    hit |= self.test::<S, Z>(simd, k, &mut rays, on_hit);
                }
                if self.shadow && hit && rays.are_done() {
                    return;
                }
                continue;
            }
            let (t0, hit0) = rays.meets(simd, &nodes[node.first as usize]);
            let (t1, hit1) = rays.meets(simd, &nodes[node.first as usize + 1]);
            match (hit0.any_true(), hit1.any_true()) {
                (true, true) => {
                    let near = u32::from(!self.shadow && t1.simd_lt(t0).any_true());
                    stack.push(node.first + 1 - near);
                    stack.push(node.first + near);
                }
                (true, false) => stack.push(node.first),
                (false, true) => stack.push(node.first + 1),
                (false, false) => {}
            }
        }
    }

    /// Eight rays against one triangle; true if `on_hit` was asked.
    #[inline(always)]
    fn test<S: Simd, const Z: usize>(
        &self,
        simd: S,
        index: u32,
        rays: &mut Rays<S>,
        on_hit: &mut impl FnMut(u32, usize, f64) -> f32,
    ) -> bool {
        let triangle = &self.target.geometry.triangles[index as usize];
        if self.shadow && triangle.is_receiver_only() {
            return false;
        }
        let (inside, unsure) = rays.inside::<Z>(simd, triangle);
        let mut lanes = inside.to_bitmask();
        if lanes == 0 {
            return false;
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
        true
    }
}

impl<S: Simd> Rays<S> {
    // Arrays are built by hand here: closures in `map` are not always compiled for the instruction set.
    #[inline(always)]
    fn new<const Z: usize>(simd: S, packet: &Packet, d: [f32x8<S>; 3], t_max: f32x8<S>) -> Rays<S> {
        let [ox, oy, oz] = packet.origin;
        Rays {
            origin: [f32x8::load_array(simd, ox), f32x8::load_array(simd, oy), f32x8::load_array(simd, oz)],
            reciprocal: [reciprocal(simd, d[0]), reciprocal(simd, d[1]), reciprocal(simd, d[2])],
            shear_x: d[(Z + 1) % 3] / d[Z],
            shear_y: d[(Z + 2) % 3] / d[Z],
            t_max,
        }
    }

    /// True if no ray needs anything more.
    #[inline(always)]
    fn are_done(&self) -> bool {
        !self.t_max.simd_gt(f32::NEG_INFINITY).any_true()
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
    /// out as zero, which double precision decides [Woop 2013].
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

/// A direction of zero becomes tiny: the box's padding keeps triangles in a face inside.
#[inline(always)]
fn reciprocal<S: Simd>(simd: S, d: f32x8<S>) -> f32x8<S> {
    f32x8::splat(simd, 1.0) / d.abs().max(f32x8::splat(simd, 1e-30)).copysign(d)
}
