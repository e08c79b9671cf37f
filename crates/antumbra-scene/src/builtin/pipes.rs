//! A power plant: a steel lattice full of pipes, with tanks beside it.

use super::maths::{Frame, Random, TURN, mix, on_circle, steps};
use super::piping::{Space, beam, hang, ladder, pipe, railing, route};
use super::shapes::MeshBuilder;
use super::spec::Values;
use super::stage::{Stage, camera, light};
use super::{BuiltinInfo, Parameter};
use crate::Scene;
use glam::Vec3;

pub(super) const PIPES: BuiltinInfo = BuiltinInfo {
    name: "pipes",
    title: "Pipes of a power plant",
    description: "A steel lattice packed with pipes, elbows, bolted flanges, gratings, ladders, railings and tanks",
    parameters: &[
        Parameter::count("triangles", 2_000_000, 300_000, 10_000_000, "triangles, kept within 2 %"),
        Parameter::count("seed", 1, 0, 1_000_000, "which plant of its kind"),
    ],
    triangles: 2_002_818,
    build,
};

/// Edge of a bay, height of a level, bays across, levels.
const BAY: f32 = 4.5;
const LEVEL: f32 = 3.6;
const ACROSS: usize = 3;
const LEVELS: usize = 4;
/// Triangles that a row of bays takes, pipes included.
const PER_ROW: usize = 190_000;

/// The lattice: columns stand at x = -BAY·ACROSS … 0 and z = 0 … -BAY·rows.
struct Lattice {
    rows: usize,
}

impl Lattice {
    fn x(&self, i: usize) -> f32 {
        BAY * (i as f32 - ACROSS as f32)
    }

    fn z(&self, k: usize) -> f32 {
        -BAY * k as f32
    }

    fn point(&self, i: usize, level: usize, k: usize) -> Vec3 {
        Vec3::new(self.x(i), LEVEL * level as f32, self.z(k))
    }

    /// True for bays whose floor is a grating; the others are open, so that light falls through.
    fn is_floored(&self, i: usize, level: usize, k: usize) -> bool {
        i == ACROSS - 1 || (i + 2 * level + k).is_multiple_of(3)
    }
}

fn build(values: &Values) -> Scene {
    let budget = values.count("triangles");
    let mut random = Random::new(values.seed());
    let lattice = Lattice { rows: (budget / PER_ROW).max(1) };
    let mut stage = Stage::default();
    let concrete = stage.color(0.5, 0.48, 0.45);
    let steel = stage.color(0.22, 0.27, 0.32);
    let zinc = stage.color(0.5, 0.51, 0.52);
    let yellow = stage.color(0.62, 0.44, 0.07);
    let paints = [(0.6, 0.6, 0.58), (0.42, 0.15, 0.09), (0.2, 0.36, 0.3), (0.55, 0.42, 0.22), (0.16, 0.28, 0.42)]
        .map(|(r, g, b)| stage.color(r, g, b));
    stage.ground(2000.0, concrete);
    stage.solid("frame", steel, |m| frame(m, &lattice));
    gratings(&mut stage, zinc, &lattice);
    stage.solid("railings", yellow, |m| railings(m, &lattice));
    tanks(&mut stage, paints[0], yellow);
    fill(&mut stage, paints, &lattice, budget, &mut random);
    stage.finish(
        camera([12.5, 7.0, 18.0], [0.1, 5.6, -1.0], 48.0, 0.1, 900.0),
        light([-34.0, 52.0, 26.0], [-5.0, 2.0, -7.0], 3.0, 3.0),
    )
}

/// Columns, beams and braces.
fn frame(m: &mut MeshBuilder, lattice: &Lattice) {
    for k in 0..=lattice.rows {
        for i in 0..=ACROSS {
            let (foot, head) = (lattice.point(i, 0, k), lattice.point(i, LEVELS, k));
            beam(m, foot, head + Vec3::Y * 0.15, 0.3, 0.32, Vec3::Z);
            m.at(Frame { origin: foot, ..Frame::IDENTITY }).block(0.6, 0.12, 0.6);
            for level in 1..=LEVELS {
                let a = lattice.point(i, level, k);
                if i < ACROSS {
                    beam(m, a, lattice.point(i + 1, level, k), 0.2, 0.34, Vec3::Y);
                }
                if k < lattice.rows {
                    beam(m, a - Vec3::Y * 0.01, lattice.point(i, level, k + 1) - Vec3::Y * 0.01, 0.2, 0.3, Vec3::Y);
                }
            }
        }
        braces(m, lattice, k);
        joists(m, lattice, k);
    }
}

/// Crossed rods in the outer bays of a row.
fn braces(m: &mut MeshBuilder, lattice: &Lattice, k: usize) {
    for level in 0..LEVELS {
        if k < lattice.rows && k % 3 == 1 {
            for i in [0, ACROSS] {
                m.rod(lattice.point(i, level, k), lattice.point(i, level + 1, k + 1), 0.045, 10);
                m.rod(lattice.point(i, level, k + 1), lattice.point(i, level + 1, k), 0.04, 10);
            }
        }
        if k == 0 && level > 0 {
            m.rod(lattice.point(0, level, 0), lattice.point(1, level + 1, 0), 0.045, 10);
            m.rod(lattice.point(1, level, 0), lattice.point(0, level + 1, 0), 0.04, 10);
        }
    }
}

/// Light beams under every floor of a row, from which pipes hang.
fn joists(m: &mut MeshBuilder, lattice: &Lattice, k: usize) {
    for level in (1..=LEVELS).filter(|_| k < lattice.rows) {
        for i in 0..ACROSS {
            for third in [1.0, 2.0] {
                let down = Vec3::new(0.0, -0.01, -BAY * third / 3.0);
                let (a, b) = (lattice.point(i, level, k) + down, lattice.point(i + 1, level, k) + down);
                beam(m, a + Vec3::X * 0.1, b - Vec3::X * 0.1, 0.1, 0.2, Vec3::Y);
            }
        }
    }
}

/// Bar gratings, one mesh placed in every floored bay.
fn gratings(stage: &mut Stage, zinc: usize, lattice: &Lattice) {
    const BARS: usize = 76;
    let panel = stage.mesh("grating", zinc, |m| {
        let half = 0.5 * BAY - 0.06;
        for x in steps(-half, half, BARS) {
            m.bar(Vec3::new(x, 0.0, -half), Vec3::new(x, 0.0, half), 0.006, 0.035, Vec3::Y);
        }
        for z in steps(-half + 0.04, half - 0.04, 38) {
            m.bar(Vec3::new(-half, 0.008, z), Vec3::new(half, 0.008, z), 0.008, 0.008, Vec3::Y);
        }
    });
    for level in 1..=LEVELS {
        for k in 0..lattice.rows {
            for i in (0..ACROSS).filter(|&i| lattice.is_floored(i, level, k)) {
                let middle = (lattice.point(i, level, k) + lattice.point(i + 1, level, k + 1)) * 0.5;
                stage.place(panel, Frame::at(middle.x, middle.y + 0.2, middle.z));
            }
        }
    }
}

/// Railings around every level, each run ending where the next begins, and ladders between levels.
fn railings(m: &mut MeshBuilder, lattice: &Lattice) {
    for level in 1..=LEVELS {
        let up = Vec3::Y * 0.18;
        for k in 0..lattice.rows {
            railing(m, lattice.point(ACROSS, level, k) + up, lattice.point(ACROSS, level, k + 1) + up);
            railing(m, lattice.point(0, level, k + 1) + up, lattice.point(0, level, k) + up);
        }
        for i in 0..ACROSS {
            let far = lattice.rows;
            railing(m, lattice.point(i, level, 0) + up, lattice.point(i + 1, level, 0) + up);
            railing(m, lattice.point(i + 1, level, far) + up, lattice.point(i, level, far) + up);
        }
    }
    for k in (0..lattice.rows).step_by(4) {
        let foot = Vec3::new(0.32, 0.0, lattice.z(k) - 0.5 * BAY);
        ladder(m, Frame { origin: foot, ..Frame::IDENTITY }.yaw(0.25 * TURN), LEVEL * LEVELS as f32);
    }
}

/// Upright tanks, a lying vessel and a chimney beside the lattice.
fn tanks(stage: &mut Stage, white: usize, yellow: usize) {
    stage.solid("tanks", white, |m| {
        for (x, z, radius, height) in [(6.6, -7.5, 2.3, 6.5), (6.9, -14.5, 2.6, 8.5), (6.3, -21.5, 2.0, 5.5)] {
            m.at(Frame::at(x, 0.0, z));
            tank(m, radius, height);
            for y in steps(1.6, height - 0.4, 4) {
                m.at(Frame::at(x, y, z)).torus(radius, 0.05, 96, 10);
            }
        }
        vessel(m, Vec3::new(5.6, 1.5, -1.2), 0.95, 3.4);
    });
    stage.solid("tank ladders", yellow, |m| {
        for (x, z, height) in [(6.6, -7.5 + 2.36, 6.5), (6.9, -14.5 + 2.66, 8.5)] {
            ladder(m, Frame::at(x, 0.0, z), height);
        }
    });
}

/// A cylinder with a domed roof.
fn tank(m: &mut MeshBuilder, radius: f32, height: f32) {
    let dome = steps(0.0, 0.25 * TURN, 13).map(on_circle);
    let profile: Vec<(f32, f32)> = [(0.0, 0.0)]
        .into_iter()
        .chain(steps(0.0, height, 9).map(|y| (radius, y)))
        .chain(dome.skip(1).take(11).map(|c| (radius * c.x, height + 0.35 * radius * c.y)))
        .chain([(0.0, height + 0.35 * radius)])
        .collect();
    m.lathe(&profile, 96);
}

/// A lying pressure vessel on two saddles, along z.
fn vessel(m: &mut MeshBuilder, middle: Vec3, radius: f32, length: f32) {
    let cap = |sign: f32| {
        steps(-0.25 * TURN, 0.0, 13)
            .map(on_circle)
            .skip(1)
            .map(move |c| (radius * c.x, sign * (0.5 * length - 0.5 * radius * c.y)))
    };
    let top: Vec<(f32, f32)> = cap(1.0).collect();
    let profile: Vec<(f32, f32)> = [(0.0, -0.5 * (length + radius))]
        .into_iter()
        .chain(cap(-1.0))
        .chain(top.into_iter().rev())
        .chain([(0.0, 0.5 * (length + radius))])
        .collect();
    m.at(Frame { origin: middle, ..Frame::IDENTITY }.pitch(0.25 * TURN)).lathe(&profile, 72);
    for z in [-1.1, 1.1] {
        m.at(Frame::at(middle.x, 0.0, middle.z + z)).block(1.5, middle.y - 0.5 * radius, 0.3);
    }
}

/// Packs pipes into the lattice until the budget is spent.
fn fill(stage: &mut Stage, paints: [usize; 5], lattice: &Lattice, budget: usize, random: &mut Random) {
    let mut space = free_space(lattice);
    let mut meshes: Vec<MeshBuilder> = paints.iter().map(|_| MeshBuilder::new()).collect();
    let mut hangers = MeshBuilder::new();
    let start = stage.triangle_count();
    let mut spent = start;
    let mut failures = 0;
    while spent < budget && failures < 400_000 {
        // Wide pipes first: later they do not fit.
        let share = (spent - start) as f32 / budget.saturating_sub(start).max(1) as f32;
        let radius = mix(0.34, 0.05, share.min(1.0).sqrt()) * random.between(0.7, 1.15);
        let legs = 3 + random.below(6);
        let Some(route) = route(&mut space, radius, legs, random) else {
            failures += 1;
            continue;
        };
        let mesh = &mut meshes[random.below(paints.len())];
        let before = mesh.triangle_count() + hangers.triangle_count();
        pipe(mesh, &route);
        hang(&mut hangers, &mut space, &route, LEVEL);
        spent += mesh.triangle_count() + hangers.triangle_count() - before;
    }
    let steel = stage.color(0.22, 0.27, 0.32);
    stage.solid("hangers", steel, |m| *m = hangers);
    for (mesh, paint) in meshes.into_iter().zip(paints) {
        stage.solid("pipes", paint, |m| *m = mesh);
    }
}

/// The lattice's inside without its beams, columns and the walkway on every level.
fn free_space(lattice: &Lattice) -> Space {
    let far = lattice.point(0, 0, lattice.rows);
    let (width, height) = (BAY * ACROSS as f32, LEVEL * LEVELS as f32);
    let mut space = Space::new(far + Vec3::new(0.1, 0.15, 0.1), Vec3::new(width - 0.2, height, -far.z - 0.2));
    for level in 1..=LEVELS {
        let y = LEVEL * level as f32;
        for i in 0..=ACROSS {
            let x = lattice.x(i);
            space.take(Vec3::new(x - 0.15, y - 0.2, far.z), Vec3::new(x + 0.15, y + 0.2, 0.0));
        }
        for k in 0..=lattice.rows {
            let z = lattice.z(k);
            space.take(Vec3::new(far.x, y - 0.2, z - 0.15), Vec3::new(0.0, y + 0.2, z + 0.15));
            for third in [1.0, 2.0] {
                let z = z - BAY * third / 3.0;
                space.take(Vec3::new(far.x, y - 0.12, z - 0.06), Vec3::new(0.0, y + 0.1, z + 0.06));
            }
        }
    }
    for k in 0..=lattice.rows {
        for i in 0..=ACROSS {
            let p = lattice.point(i, 0, k);
            space.take(p - Vec3::new(0.2, 0.0, 0.2), p + Vec3::new(0.2, height, 0.2));
        }
    }
    space
}
