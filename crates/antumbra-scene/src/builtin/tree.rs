//! Trees: trunk, branches, twigs and leaves.

use super::maths::{Frame, Random, TURN, across, cos, mix, on_circle, power, sin, steps};
use super::shapes::MeshBuilder;
use glam::Vec3;

/// Triangles of every tree, wood and leaves together, so that a forest's count is exact.
pub(super) const TRIANGLES: usize = 9_194;

/// How trees of a kind grow. Lengths are in metres.
#[derive(Clone, Copy)]
pub(super) struct Species {
    pub height: f32,
    pub trunk: f32,
    /// Height where the crown begins, as a share of the whole.
    pub crown_from: f32,
    /// Reach of the longest branches.
    pub crown_radius: f32,
    /// How steeply branches rise, 0 level.
    pub rise: f32,
    pub branches: usize,
    pub twigs: usize,
    pub leaf: f32,
}

/// The kinds that a forest mixes.
pub(super) const SPECIES: [Species; 5] = [
    Species {
        height: 9.0,
        trunk: 0.3,
        crown_from: 0.38,
        crown_radius: 3.3,
        rise: 0.45,
        branches: 15,
        twigs: 5,
        leaf: 0.26,
    },
    Species {
        height: 11.5,
        trunk: 0.26,
        crown_from: 0.45,
        crown_radius: 2.4,
        rise: 0.8,
        branches: 17,
        twigs: 4,
        leaf: 0.24,
    },
    Species {
        height: 10.0,
        trunk: 0.16,
        crown_from: 0.35,
        crown_radius: 2.0,
        rise: 0.65,
        branches: 18,
        twigs: 4,
        leaf: 0.19,
    },
    Species {
        height: 7.5,
        trunk: 0.22,
        crown_from: 0.33,
        crown_radius: 2.8,
        rise: 0.3,
        branches: 14,
        twigs: 5,
        leaf: 0.25,
    },
    Species {
        height: 12.5,
        trunk: 0.36,
        crown_from: 0.42,
        crown_radius: 3.0,
        rise: 0.6,
        branches: 16,
        twigs: 5,
        leaf: 0.27,
    },
];

/// Grows a tree that stands on the origin and returns its wood and its leaves.
pub(super) fn grow(species: &Species, random: &mut Random) -> (MeshBuilder, MeshBuilder) {
    let mut wood = MeshBuilder::new();
    let trunk = trunk(species, random);
    let flare = |i: usize| [1.7, 1.15].get(i).copied().unwrap_or(1.0);
    let taper = |i: usize| mix(species.trunk, 0.02, power(i as f32 / (trunk.len() - 1) as f32, 0.9));
    wood.tube(&trunk, 10, |i| flare(i) * taper(i));
    let mut twigs: Vec<Vec<Vec3>> = Vec::new();
    for i in 0..species.branches {
        let branch = branch(species, &trunk, i, random);
        let thick = 0.34 * species.trunk * mix(1.0, 0.35, i as f32 / species.branches as f32);
        wood.tube(&branch, 6, |k| mix(thick, 0.012, k as f32 / (branch.len() - 1) as f32));
        for k in 0..species.twigs {
            let twig = self::twig(&branch, (k as f32 + 0.7) / species.twigs as f32, random);
            wood.tube(&twig, 4, |k| mix(0.02, 0.005, k as f32 / (twig.len() - 1) as f32));
            twigs.push(twig);
        }
        twigs.push(branch[branch.len() / 2..].to_vec());
    }
    let mut leaves = MeshBuilder::new();
    for i in 0..(TRIANGLES - wood.triangle_count()) / 2 {
        let path = &twigs[i % twigs.len()];
        leaf(&mut leaves, species.leaf, path, random);
    }
    (wood, leaves)
}

/// A path from below the ground to the tip.
fn trunk(species: &Species, random: &mut Random) -> Vec<Vec3> {
    let mut sway = Vec3::ZERO;
    let heights = [-0.15, 0.25].into_iter().chain(steps(0.9, species.height, 9));
    let mut previous = 0.0;
    heights
        .map(|y: f32| {
            sway += random.cube() * (0.06 * (y - previous).max(0.0));
            previous = y;
            Vec3::new(sway.x, y, sway.z)
        })
        .collect()
}

/// The point of a path at `t` in [0, 1].
fn along(path: &[Vec3], t: f32) -> Vec3 {
    let s = t.clamp(0.0, 1.0) * (path.len() - 1) as f32;
    let i = (s as usize).min(path.len() - 2);
    path[i].lerp(path[i + 1], s - i as f32)
}

/// Branch `index` of a tree, counted upwards.
fn branch(species: &Species, trunk: &[Vec3], index: usize, random: &mut Random) -> Vec<Vec3> {
    let t = (index as f32 + random.unit()) / species.branches as f32;
    let y = mix(species.crown_from, 0.97, t) * species.height;
    // The trunk's first point lies below the ground; heights are even after the second.
    let foot = trunk
        .windows(2)
        .find(|w| w[1].y >= y)
        .map_or(trunk[trunk.len() - 1], |w| w[0].lerp(w[1], (y - w[0].y) / (w[1].y - w[0].y)));
    let outward = on_circle(TURN * (0.381_966 * index as f32 + random.between(-0.06, 0.06)));
    let outward = Vec3::new(outward.x, 0.0, outward.y);
    // Longest a little above the crown's foot, short at the top.
    let reach = species.crown_radius * sin(0.5 * TURN * mix(0.24, 0.93, t)) * random.between(0.8, 1.12);
    let rise = mix(species.rise, 1.3, t * t);
    let bend = random.cube() * 0.12;
    steps(0.0, 1.0, 6)
        .map(|s| {
            let lift = rise * (0.55 * s + 0.45 * s * s);
            foot + (outward * s + Vec3::Y * lift + bend * sin(0.5 * TURN * s)) * reach
        })
        .collect()
}

/// A twig that leaves a branch at `t`.
fn twig(branch: &[Vec3], t: f32, random: &mut Random) -> Vec<Vec3> {
    let t = mix(0.3, 1.0, t.min(1.0));
    let foot = along(branch, t - 0.02);
    let length = (branch[branch.len() - 1] - branch[0]).length() * mix(0.48, 0.26, t);
    let forward = (along(branch, t + 0.1) - along(branch, t - 0.1)).normalize();
    let (a, b) = across(forward);
    let c = on_circle(TURN * random.unit());
    let side = a * c.x + b * (0.6 * c.y) + Vec3::Y * 0.15;
    let direction = (forward * 0.7 + side * 0.8).normalize();
    steps(0.0, 1.0, 3).map(|s| foot + (direction * s + Vec3::Y * (0.14 * s * s)) * length).collect()
}

/// Grows a round bush of `leaves` leaves.
pub(super) fn bush(leaves: usize, random: &mut Random) -> MeshBuilder {
    let mut m = MeshBuilder::new();
    for _ in 0..leaves {
        let d = random.direction();
        let p = Vec3::new(1.3 * d.x, 0.62 + 0.75 * d.y, 1.3 * d.z) * (0.7 + 0.3 * random.unit());
        leaf(&mut m, 0.24, &[p, p + Vec3::Y * 0.1], random);
    }
    m
}

/// A leaf of two triangles, folded along its middle, near a twig.
fn leaf(m: &mut MeshBuilder, size: f32, path: &[Vec3], random: &mut Random) {
    let foot = along(path, random.unit()) + random.direction() * (size * random.unit());
    let out = random.direction();
    let forward = (out + Vec3::Y * -0.25).normalize();
    let (side, up) = across(forward);
    let roll = TURN * random.unit();
    let side = side * cos(roll) + up * sin(roll);
    let normal = forward.cross(side);
    let length = size * random.between(0.75, 1.2);
    let wide = |s: f32| foot + (forward * 0.45 + side * (0.3 * s) + normal * 0.08) * length;
    m.at(Frame::IDENTITY);
    let [base, right, tip, left] = [foot, wide(1.0), foot + forward * length, wide(-1.0)].map(|p| m.vertex(p));
    m.quad(base, right, tip, left);
}
