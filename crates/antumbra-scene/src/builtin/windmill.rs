//! A windmill in a field, with a cottage.

use super::maths::{Frame, TURN, cos, mix, on_circle, steps};
use super::shapes::MeshBuilder;
use super::spec::Values;
use super::stage::{Stage, camera, light};
use super::{BuiltinInfo, Parameter};
use crate::Scene;
use glam::{Vec2, Vec3};

pub(super) const WINDMILL: BuiltinInfo = BuiltinInfo {
    name: "windmill",
    title: "A windmill",
    description: "Lattice sails over a field: fine casters far from their receiver, a solid tower close to it",
    parameters: &[Parameter::real("angle", 22.0, -360.0, 360.0, "turn of the sails in degrees")],
    triangles: 6270,
    build,
};

/// Corners of the tower.
const SIDES: usize = 8;
/// Height of the gallery and of the tower's top, in metres.
const GALLERY: f32 = 3.6;
const TOP: f32 = 10.2;
/// Where the sails turn: height, and distance in front of the tower's axis.
const HUB: Vec2 = Vec2::new(11.2, 2.7);

/// Distance of the tower's corners from its axis.
fn girth(y: f32) -> f32 {
    mix(3.3, 1.75, y / TOP)
}

fn build(values: &Values) -> Scene {
    let mut stage = Stage::default();
    let field = stage.color(0.34, 0.36, 0.19);
    let plaster = stage.color(0.64, 0.6, 0.52);
    let thatch = stage.color(0.3, 0.22, 0.14);
    let timber = stage.color(0.38, 0.26, 0.16);
    let sail = stage.color(0.66, 0.62, 0.54);
    stage.ground(300.0, field);
    stage.solid("tower", plaster, tower);
    stage.solid("cap", thatch, cap);
    stage.solid("timber", timber, |m| {
        gallery(m);
        tail_pole(m);
        openings(m);
        m.at(Frame::at(0.0, HUB.x, 0.0)).rod(Vec3::Z * 0.5, Vec3::Z * (HUB.y + 0.35), 0.22, 24);
    });
    let blade = stage.mesh("sail", sail, lattice);
    let hub = Frame::at(0.0, HUB.x, HUB.y).roll(values.real("angle").to_radians());
    for quarter in 0..4 {
        stage.place(blade, hub.roll(0.25 * TURN * quarter as f32));
    }
    let yard = Frame::at(-8.6, 0.0, -2.5).yaw(0.5);
    stage.solid("cottage", plaster, |m| walls(m, yard));
    stage.solid("cottage roof", thatch, |m| roof(m, yard));
    stage.solid("joinery", timber, |m| cottage_openings(m, yard));
    stage.solid("fence", timber, paddock);
    stage.finish(
        camera([11.0, 10.0, 32.0], [3.0, 7.9, 0.0], 45.0, 0.1, 400.0),
        light([-25.0, 42.0, 20.0], [0.0, 4.0, 0.0], 2.0, 2.0),
    )
}

/// An eight-cornered tapering tower with a plinth, a door and windows.
fn tower(m: &mut MeshBuilder) {
    let profile: Vec<(f32, f32)> =
        [(0.0, 0.0)].into_iter().chain(steps(0.0, TOP, 13).map(|y| (girth(y), y))).chain([(0.0, TOP)]).collect();
    m.lathe(&profile, SIDES);
    m.at(Frame::IDENTITY).lathe(&[(0.0, 0.0), (3.5, 0.0), (3.42, 0.5), (0.0, 0.5)], SIDES);
}

/// The tower's door and shutters, on faces that the camera sees.
fn openings(m: &mut MeshBuilder) {
    // A face's middle is nearer to the axis than its corners.
    let inset = cos(0.5 * TURN / SIDES as f32);
    for (face, y, width, height) in [(1, 0.0, 1.1, 2.2), (1, 5.4, 0.7, 1.0), (1, 8.0, 0.6, 0.8), (2, 6.6, 0.7, 1.0)] {
        let turn = TURN * (face as f32 - 0.5) / SIDES as f32;
        let front = if y == 0.0 { 3.46 } else { girth(y + 0.5 * height) } * inset;
        m.at(Frame::at(0.0, y, 0.0).yaw(turn).shift(0.0, 0.0, front)).block(width, height, 0.16);
    }
}

/// A boat-shaped cap: a rounded ridge along z.
fn cap(m: &mut MeshBuilder) {
    m.at(Frame::at(0.0, TOP - 0.05, 0.0)).cylinder(2.0, 0.3, 32);
    let mut frame = Frame::at(0.0, TOP + 0.2, -0.15);
    frame.axes.z_axis *= 1.25;
    let dome: Vec<(f32, f32)> =
        steps(0.0, 0.25 * TURN, 17).map(on_circle).map(|c| (1.9 * c.x, 2.1 * c.y * (1.0 - 0.12 * c.x))).collect();
    let last = dome.len() - 1;
    let profile: Vec<(f32, f32)> =
        [(0.0, 0.0)].into_iter().chain(dome[..last].iter().copied()).chain([(0.0, dome[last].1)]).collect();
    m.at(frame).lathe(&profile, 40);
}

/// A walk around the tower on brackets, with a railing.
fn gallery(m: &mut MeshBuilder) {
    let (inner, outer) = (girth(GALLERY) - 0.3, girth(GALLERY) + 1.15);
    m.at(Frame::at(0.0, GALLERY, 0.0));
    m.lathe(&[(inner, -0.12), (outer, -0.12), (outer, 0.0), (inner, 0.0)], 24);
    let corner = |i: usize, r: f32, y: f32| {
        let c = on_circle(TURN * i as f32 / 24.0) * r;
        Vec3::new(c.x, y, c.y)
    };
    for i in 0..24 {
        let rail = |m: &mut MeshBuilder, y: f32| {
            m.bar(corner(i, outer - 0.08, y), corner(i + 1, outer - 0.08, y), 0.06, 0.06, Vec3::Y);
        };
        rail(m, 0.95);
        rail(m, 0.5);
        m.bar(corner(i, outer - 0.08, -0.05), corner(i, outer - 0.08, 1.0), 0.08, 0.08, corner(i, 1.0, 0.0));
        if i % 3 == 0 {
            m.bar(corner(i, girth(1.6) - 0.3, -2.0), corner(i, outer - 0.2, -0.08), 0.12, 0.12, Vec3::Y);
        }
    }
}

/// The beams by which the cap is turned into the wind.
fn tail_pole(m: &mut MeshBuilder) {
    m.at(Frame::IDENTITY);
    let foot = Vec3::new(0.0, GALLERY + 0.9, -4.1);
    m.rod(Vec3::new(0.0, TOP + 0.6, -1.6), foot, 0.12, 12);
    for side in [-1.0, 1.0] {
        m.rod(Vec3::new(1.6 * side, TOP + 0.3, -0.9), foot, 0.08, 10);
    }
}

/// One sail along +Y from the hub: stock, lattice on its trailing side, a board on its leading side.
fn lattice(m: &mut MeshBuilder) {
    const REACH: f32 = 8.6;
    const BARS: usize = 22;
    m.bar(Vec3::ZERO, Vec3::Y * REACH, 0.22, 0.22, Vec3::Z);
    // The lattice is tilted against the wind, most at the hub.
    let tilt = |y: f32| mix(0.34, 0.1, y / REACH);
    let at = |x: f32, y: f32| Vec3::new(x, y, 0.14 - x * tilt(y));
    for y in steps(1.5, REACH - 0.05, BARS) {
        m.bar(at(-0.45, y), at(1.75, y), 0.055, 0.05, Vec3::Z);
    }
    for x in [-0.45, 0.6, 1.15, 1.75] {
        let path: Vec<f32> = steps(1.45, REACH, 9).collect();
        for pair in path.windows(2) {
            m.bar(at(x, pair[0]), at(x, pair[1]), 0.06, 0.045, Vec3::Z);
        }
    }
}

/// Length, width and height of the cottage's walls, and the height of its ridge.
const COTTAGE: [f32; 4] = [6.0, 4.2, 2.3, 4.6];

/// Walls with gables, and a chimney.
fn walls(m: &mut MeshBuilder, yard: Frame) {
    let [length, width, height, ridge] = COTTAGE;
    let half = 0.5 * width;
    let lower = [Vec2::new(-half, 0.0), Vec2::ZERO, Vec2::new(half, 0.0)];
    let upper = [Vec2::new(-half, height), Vec2::new(0.0, ridge), Vec2::new(half, height)];
    m.at(yard.yaw(0.25 * TURN)).slab(&lower, &upper, length);
    m.at(yard.shift(-1.6, ridge - 1.2, 0.4)).block(0.7, 2.1, 0.7);
}

/// The cottage's door and shutters.
fn cottage_openings(m: &mut MeshBuilder, yard: Frame) {
    let front = 0.5 * COTTAGE[1];
    m.at(yard.shift(0.3, 0.0, front)).block(0.95, 1.9, 0.1);
    for x in [-1.8, 2.0] {
        m.at(yard.shift(x, 0.95, front)).block(0.9, 0.85, 0.08);
    }
}

/// A thick roof with eaves.
fn roof(m: &mut MeshBuilder, yard: Frame) {
    let [length, width, height, ridge] = COTTAGE;
    let half = 0.5 * width;
    let eaves = |rise: f32| {
        let (out, drop) = (0.45, 0.45 * (ridge - height) / half);
        [
            Vec2::new(-half - out, height - drop + rise),
            Vec2::new(0.0, ridge + rise),
            Vec2::new(half + out, height - drop + rise),
        ]
    };
    m.at(yard.yaw(0.25 * TURN)).slab(&eaves(-0.04), &eaves(0.26), length + 0.7);
}

/// A post-and-rail fence in front, along a gentle bend.
fn paddock(m: &mut MeshBuilder) {
    let posts: Vec<Vec3> = steps(-1.0, 1.0, 15).map(|t| Vec3::new(-4.0 + 13.0 * t, 0.0, 9.0 - 3.0 * t * t)).collect();
    m.at(Frame::IDENTITY);
    for pair in posts.windows(2) {
        for y in [0.45, 0.95] {
            m.bar(pair[0] + Vec3::Y * y, pair[1] + Vec3::Y * y, 0.05, 0.11, Vec3::Y);
        }
    }
    for post in posts {
        m.at(Frame { origin: post, ..Frame::IDENTITY }).block(0.14, 1.25, 0.14);
    }
}
