//! A court between two floors of arcades, with cloth hung in it.

use super::maths::{Frame, TURN, mix, on_circle, sin, steps};
use super::shapes::{MeshBuilder, arc};
use super::spec::Values;
use super::stage::{Stage, camera, light};
use super::{BuiltinInfo, Parameter};
use crate::Scene;
use glam::{Vec2, Vec3};

pub(super) const ATRIUM: BuiltinInfo = BuiltinInfo {
    name: "atrium",
    title: "A court with arcades",
    description: "Two floors of columns and arches under the open sky, with banners and awnings of folded cloth",
    parameters: &[Parameter::count("bays", 7, 3, 60, "arches along the court")],
    triangles: 182_418,
    build,
};

/// Distance between columns, and the number of arches across the court.
const BAY: f32 = 2.5;
const ACROSS: usize = 3;
/// Depth of the galleries behind the arches.
const GALLERY: f32 = 3.0;
/// Half the thickness of the arcade walls.
const WALL: f32 = 0.26;

/// One floor of an arcade; heights are above the floor.
struct Storey {
    floor: f32,
    /// Where the arches spring, which is the top of the columns.
    spring: f32,
    radius: f32,
    top: f32,
}

const STOREYS: [Storey; 2] = [
    Storey { floor: 0.0, spring: 2.6, radius: 0.98, top: 4.3 },
    Storey { floor: 4.5, spring: 2.1, radius: 0.98, top: 3.7 },
];
/// Top of the walls, where the sky begins.
const EAVES: f32 = 8.2;

/// Half the inner size of the court in x and z.
fn court(bays: usize) -> Vec2 {
    Vec2::new(ACROSS as f32, bays as f32) * (0.5 * BAY)
}

fn build(values: &Values) -> Scene {
    let bays = values.count("bays");
    let half = court(bays);
    let mut stage = Stage::default();
    let floor = stage.color(0.52, 0.46, 0.38);
    let stone = stage.color(0.66, 0.6, 0.5);
    let wall = stage.color(0.58, 0.48, 0.36);
    let tiles = stage.color(0.44, 0.22, 0.14);
    let cloths = [(0.45, 0.09, 0.07), (0.09, 0.17, 0.34), (0.5, 0.36, 0.12)].map(|(r, g, b)| stage.color(r, g, b));
    stage.ground(4.0 * (half.x + half.y), floor);
    stage.solid("walls", wall, |m| shell(m, half));
    stage.solid("roof", tiles, |m| roof(m, half));
    stage.solid("floors", stone, |m| floors(m, half));
    arcades(&mut stage, stone, half, bays);
    stage.solid("fountain", stone, |m| fountain(m.at(Frame::at(-0.7, 0.0, half.y - 9.4))));
    hangings(&mut stage, cloths, half, bays);
    stage.finish(
        camera([0.9, 1.75, half.y - 0.6], [-0.45, 3.0, half.y - 9.0], 62.0, 0.1, 200.0),
        light([3.6, 20.0, half.y - 6.5], [-0.9, 1.0, half.y - 8.0], 3.2, 3.2),
    )
}

/// Calls `side` with the frame of each side of the court, +X along it and +Z into the court, and its bays.
fn sides(half: Vec2, bays: usize, mut side: impl FnMut(Frame, usize)) {
    for (turn, distance, count) in
        [(0.0, half.y, ACROSS), (0.25, half.x, bays), (0.5, half.y, ACROSS), (0.75, half.x, bays)]
    {
        side(Frame::IDENTITY.yaw(TURN * turn).shift(0.0, 0.0, -distance), count);
    }
}

/// The walls around everything: boxes that meet at the corners without overlap.
fn shell(m: &mut MeshBuilder, half: Vec2) {
    let outer = half + Vec2::splat(GALLERY);
    for s in [-1.0, 1.0] {
        m.at(Frame::at(s * (outer.x + 0.2), 0.0, 0.0)).block(0.4, EAVES, 2.0 * outer.y);
        m.at(Frame::at(0.0, 0.0, s * (outer.y + 0.2))).block(2.0 * outer.x + 0.8, EAVES, 0.4);
    }
}

/// A ring of four boxes around the court, from `inner` outside of its edge to `outer`, from `y` upwards.
fn ring(m: &mut MeshBuilder, half: Vec2, inner: f32, outer: f32, y: f32, height: f32) {
    let (a, b) = (half + Vec2::splat(inner), half + Vec2::splat(outer));
    for s in [-1.0, 1.0] {
        m.at(Frame::at(s * 0.5 * (a.x + b.x), y, 0.0)).block(b.x - a.x, height, 2.0 * a.y);
        m.at(Frame::at(0.0, y, s * 0.5 * (a.y + b.y))).block(2.0 * b.x, height, b.y - a.y);
    }
}

/// Upper floor, ceiling and the mouldings that run around the court.
fn floors(m: &mut MeshBuilder, half: Vec2) {
    ring(m, half, -0.34, GALLERY, 4.3, 0.2);
    ring(m, half, -0.4, 0.4, 4.22, 0.09);
    ring(m, half, -0.34, GALLERY, EAVES, 0.2);
    ring(m, half, -0.42, 0.36, EAVES - 0.1, 0.11);
}

/// A single-pitch roof over each gallery, mitred at the corners.
fn roof(m: &mut MeshBuilder, half: Vec2) {
    let (a, b) = (half - Vec2::splat(0.6), half + Vec2::splat(GALLERY + 0.5));
    let corner = |k: usize, r: Vec2, y: f32| {
        let (x, z) = [(-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)][k % 4];
        Vec3::new(x * r.x, y, z * r.y)
    };
    let (low, high) = (EAVES + 0.2, EAVES + 1.2);
    let profile = [(a, low), (b, high), (b, high + 0.12), (a, low + 0.12)];
    m.at(Frame::IDENTITY);
    for k in 0..4 {
        for i in 0..4 {
            let ((r, y), (s, z)) = (profile[i], profile[(i + 1) % 4]);
            m.patch([corner(k, r, y), corner(k + 1, r, y), corner(k + 1, s, z), corner(k, s, z)]);
        }
    }
}

/// Columns, arches and balustrades on every side and floor.
fn arcades(stage: &mut Stage, stone: usize, half: Vec2, bays: usize) {
    let baluster = stage.mesh("baluster", stone, |m| {
        m.lathe(
            &[
                (0.0, 0.0),
                (0.055, 0.0),
                (0.055, 0.06),
                (0.03, 0.1),
                (0.058, 0.24),
                (0.028, 0.46),
                (0.05, 0.56),
                (0.0, 0.56),
            ],
            16,
        );
    });
    let rail = stage.mesh("rail", stone, |m| {
        m.block(BAY, 0.1, 0.2);
        m.at(Frame::at(0.0, 0.66, 0.0)).block(BAY, 0.12, 0.22);
    });
    for storey in &STOREYS {
        let arch = stage.mesh("arch", stone, |m| arch(m, storey));
        let column = stage.mesh("column", stone, |m| column(m, storey.spring));
        let pier = stage.mesh("pier", stone, |m| pier(m, storey));
        sides(half, bays, |side, count| {
            let side = side.shift(0.0, storey.floor, 0.0);
            for i in 0..count {
                let middle = side.shift((i as f32 + 0.5 - 0.5 * count as f32) * BAY, 0.0, 0.0);
                stage.place(arch, middle);
                if i > 0 {
                    stage.place(column, middle.shift(-0.5 * BAY, 0.0, 0.0));
                }
                if storey.floor > 0.0 {
                    stage.place(rail, middle);
                    for x in steps(-0.5 * BAY + 0.36, 0.5 * BAY - 0.36, 9) {
                        stage.place(baluster, middle.shift(x, 0.1, 0.0));
                    }
                }
            }
            stage.place(pier, side.shift(-0.5 * BAY * count as f32, 0.0, 0.0));
        });
    }
}

/// The wall of one bay above its columns.
fn arch(m: &mut MeshBuilder, storey: &Storey) {
    let (spring, r) = (Vec2::Y * storey.spring, storey.radius);
    let half = 0.5 * BAY;
    let mut lower = vec![spring - Vec2::X * half];
    lower.extend(arc(spring, r, 0.5 * TURN, 0.0, 41));
    lower.push(spring + Vec2::X * half);
    let upper: Vec<Vec2> = lower.iter().map(|p| Vec2::new(p.x, storey.top)).collect();
    m.slab(&lower, &upper, 2.0 * WALL);
    // An archivolt stands out of the wall on both faces.
    let inner = arc(spring, r - 0.02, 0.5 * TURN, 0.0, 41);
    let outer = arc(spring, r + 0.14, 0.5 * TURN, 0.0, 41);
    m.slab(&inner, &outer, 2.0 * WALL + 0.08);
}

/// A round column with base and capital.
fn column(m: &mut MeshBuilder, height: f32) {
    m.block(0.56, 0.12, 0.56);
    m.at(Frame::at(0.0, height - 0.12, 0.0)).block(0.62, 0.13, 0.62);
    let shaft = steps(0.0, 1.0, 9).map(|t| (0.185 - 0.03 * t * t, mix(0.26, height - 0.5, t)));
    let base = [(0.0, 0.1), (0.27, 0.1), (0.285, 0.14), (0.27, 0.18), (0.22, 0.2), (0.23, 0.235), (0.2, 0.25)];
    let capital = [
        (0.185, height - 0.48),
        (0.185, height - 0.44),
        (0.16, height - 0.42),
        (0.2, height - 0.3),
        (0.29, height - 0.13),
        (0.0, height - 0.1),
    ];
    let profile: Vec<(f32, f32)> = base.into_iter().chain(shaft).chain(capital).collect();
    m.at(Frame::IDENTITY).lathe(&profile, 40);
}

/// The square pier in a corner of the court.
fn pier(m: &mut MeshBuilder, storey: &Storey) {
    m.block(0.66, storey.top, 0.66);
    m.block(0.78, 0.16, 0.78);
    m.at(Frame::at(0.0, storey.spring - 0.1, 0.0)).block(0.76, 0.12, 0.76);
}

/// An eight-cornered basin with a bowl on a stem.
fn fountain(m: &mut MeshBuilder) {
    m.lathe(
        &[
            (0.0, 0.0),
            (1.15, 0.0),
            (1.15, 0.12),
            (1.0, 0.14),
            (1.0, 0.46),
            (1.1, 0.5),
            (1.1, 0.56),
            (0.86, 0.56),
            (0.84, 0.2),
            (0.0, 0.2),
        ],
        8,
    );
    let stem = [(0.0, 0.15), (0.2, 0.15), (0.14, 0.3), (0.09, 0.6), (0.12, 0.85), (0.07, 0.98)];
    let bowl = [
        (0.2, 1.02),
        (0.42, 1.14),
        (0.52, 1.26),
        (0.54, 1.27),
        (0.5, 1.27),
        (0.38, 1.17),
        (0.05, 1.1),
        (0.05, 1.3),
        (0.0, 1.34),
    ];
    let profile: Vec<(f32, f32)> = stem.into_iter().chain(bowl).collect();
    m.lathe(&profile, 64);
}

/// Banners in front of the upper arches and awnings across the court.
fn hangings(stage: &mut Stage, cloths: [usize; 3], half: Vec2, bays: usize) {
    for i in 0..bays {
        let z = (i as f32 + 0.5 - 0.5 * bays as f32) * BAY;
        for (side, shift) in [(-1.0, 0), (1.0, 1)] {
            if (i + shift) % 2 == 0 {
                let place = Frame::at(side * (half.x - 0.5), 7.7, z).yaw(-side * 0.25 * TURN);
                stage.solid("banner", cloths[(i / 2 + shift) % 3], |m| banner(m.at(place), i as f32));
            }
        }
    }
    let first = 0.5 * bays as f32 - 2.0;
    for (k, z) in (0..bays.saturating_sub(2)).step_by(2).map(|k| (k, (first - k as f32 - 0.1) * BAY)) {
        let place = Frame::at(0.0, 7.6 - 0.25 * (k % 4) as f32, z);
        stage.solid("awning", cloths[(k / 2 + 1) % 3], |m| awning(m.at(place), half.x - 0.3));
    }
}

/// Cloth that hangs from a pole along x, its folds deeper towards the hem.
fn banner(m: &mut MeshBuilder, phase: f32) {
    const SIZE: Vec2 = Vec2::new(1.3, 3.4);
    m.sheet(64, 48, |column, row| {
        let (u, v) = (column as f32 / 64.0 - 0.5, 1.0 - row as f32 / 48.0);
        let fold = sin(TURN * (3.1 * u + 0.15 * v) + phase) + 0.35 * sin(TURN * (5.3 * u - 0.2 * v) + 2.0 * phase);
        let narrow = 1.0 - 0.08 * v;
        Vec3::new(SIZE.x * u * narrow, -SIZE.y * v, 0.02 + (0.015 + 0.075 * v) * fold)
    });
    m.rod(Vec3::new(-0.75, 0.0, 0.02), Vec3::new(0.75, 0.0, 0.02), 0.028, 16);
}

/// Cloth that sags between both sides of the court.
fn awning(m: &mut MeshBuilder, reach: f32) {
    const WIDTH: f32 = 1.5;
    m.sheet(96, 40, |column, row| {
        let (u, v) = (2.0 * column as f32 / 96.0 - 1.0, row as f32 / 40.0 - 0.5);
        let gather = mix(1.0, 0.62, u * u * u * u);
        let sag =
            -1.1 * (1.0 - u * u) + 0.05 * sin(TURN * 2.5 * v) * (0.3 + u * u) - 0.12 * on_circle(TURN * 0.5 * v).x;
        Vec3::new(reach * u, sag, -WIDTH * v * gather)
    });
}
