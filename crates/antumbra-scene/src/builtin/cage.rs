//! A bird in a cage of thin wires.

use super::maths::{Frame, TURN, cos, mix, on_circle, sin, steps};
use super::shapes::MeshBuilder;
use super::spec::Values;
use super::stage::{Stage, camera, light};
use super::{BuiltinInfo, Parameter};
use crate::Scene;
use glam::Vec3;

pub(super) const CAGE: BuiltinInfo = BuiltinInfo {
    name: "cage",
    title: "A bird cage",
    description: "Thin wires that fall between the texels of a shadow map, with a bird inside",
    parameters: &[
        Parameter::count("wires", 28, 4, 400, "upright wires"),
        Parameter::real("thickness", 3.0, 0.2, 20.0, "diameter of a wire in millimetres"),
    ],
    triangles: 39_378,
    build,
};

const RADIUS: f32 = 0.24;
/// Height where the wall ends and the dome begins.
const WALL: f32 = 0.36;

fn build(values: &Values) -> Scene {
    let (wires, wire) = (values.count("wires"), 0.0005 * values.real("thickness"));
    let mut stage = Stage::default();
    let table = stage.color(0.58, 0.53, 0.46);
    let brass = stage.color(0.52, 0.36, 0.14);
    let wood = stage.color(0.3, 0.17, 0.09);
    let feather = stage.color(0.16, 0.34, 0.42);
    let breast = stage.color(0.62, 0.3, 0.12);
    stage.ground(12.0, table);
    stage.solid("wires", brass, |m| bars(m, wires, wire));
    stage.solid("tray", wood, tray);
    stage.solid("perch", wood, |m| {
        m.rod(Vec3::new(-RADIUS, 0.17, 0.0), Vec3::new(RADIUS, 0.17, 0.0), 0.007, 20);
        m.at(Frame::at(0.0, WALL + 0.3, 0.0)).sphere(0.018, 32);
    });
    let perched = Frame::at(-0.02, 0.232, 0.0).yaw(-0.5);
    stage.solid("bird", feather, |m| bird(m, perched));
    stage.solid("breast", breast, |m| {
        m.at(stretched(perched.shift(0.024, -0.008, 0.0), 0.9)).sphere(0.05, 48);
        beak(m, perched);
    });
    stage.finish(
        camera([0.6, 1.15, 1.62], [0.13, 0.25, 0.03], 34.0, 0.05, 20.0),
        light([-1.15, 2.1, -0.2], [0.05, 0.05, 0.0], 0.2, 0.2),
    )
}

/// Upright wires that bend into a dome, the hoops that hold them, and the ring on top.
fn bars(m: &mut MeshBuilder, wires: usize, wire: f32) {
    for i in 0..wires {
        let c = on_circle(TURN * (i as f32 + 0.5) / wires as f32);
        let wall = steps(0.0, WALL, 7).map(|y| (RADIUS, y));
        let dome = steps(0.0, 0.25 * TURN, 25).skip(1).map(|t| (mix(0.006, RADIUS, cos(t)), WALL + 0.28 * sin(t)));
        let path: Vec<Vec3> = wall.chain(dome).map(|(r, y)| Vec3::new(c.x * r, y + 0.02, c.y * r)).collect();
        m.tube(&path, 8, |_| wire);
    }
    for (radius, y) in [(RADIUS, 0.13), (RADIUS, 0.25), (RADIUS, WALL + 0.02), (RADIUS * 0.79, WALL + 0.19)] {
        m.at(Frame::at(0.0, y, 0.0)).torus(radius, 1.5 * wire, 96, 10);
    }
    let top = Frame::at(0.0, WALL + 0.352, 0.0).pitch(0.25 * TURN);
    m.at(top).torus(0.035, 0.004, 64, 16);
    m.at(Frame::IDENTITY);
}

/// A shallow tray on four ball feet.
fn tray(m: &mut MeshBuilder) {
    let (outer, inner) = (RADIUS + 0.02, RADIUS - 0.012);
    m.lathe(
        &[
            (0.0, 0.012),
            (outer - 0.01, 0.012),
            (outer, 0.02),
            (outer, 0.046),
            (inner, 0.046),
            (inner, 0.028),
            (0.0, 0.028),
        ],
        96,
    );
    for i in 0..4 {
        let c = on_circle(TURN * (i as f32 + 0.5) / 4.0) * (RADIUS - 0.03);
        m.at(Frame::at(c.x, 0.012, c.y)).sphere(0.013, 24);
    }
}

/// Longer along x than across.
fn stretched(frame: Frame, factor: f32) -> Frame {
    let mut axes = frame.axes;
    axes.x_axis *= 1.35;
    Frame { axes: axes * factor, ..frame }
}

/// Body, head, wings, tail and legs of a bird that looks along the frame's +X, its middle at the origin.
fn bird(m: &mut MeshBuilder, frame: Frame) {
    m.at(stretched(frame.roll(0.45), 1.0)).sphere(0.05, 64);
    m.at(frame.shift(0.052, 0.062, 0.0)).sphere(0.034, 48);
    let tail = |t: f32, r: f32| (Vec3::new(-0.045 - 0.11 * t, -0.015 - 0.075 * t, 0.0), r);
    let (path, radii): (Vec<Vec3>, Vec<f32>) =
        [tail(0.0, 0.026), tail(0.5, 0.018), tail(1.0, 0.013)].into_iter().unzip();
    m.at(frame).tube(&path, 16, |i| radii[i]);
    for side in [-1.0, 1.0] {
        let mut wing = frame.shift(-0.02, 0.0, side * 0.04).roll(0.6);
        wing.axes.x_axis *= 1.9;
        wing.axes.z_axis *= 0.4;
        m.at(wing).sphere(0.034, 40);
        m.at(frame).rod(Vec3::new(0.005, -0.03, side * 0.018), Vec3::new(0.012, -0.06, side * 0.018), 0.004, 10);
    }
}

/// A pointed beak.
fn beak(m: &mut MeshBuilder, frame: Frame) {
    m.at(frame.shift(0.08, 0.058, 0.0).roll(-0.27 * TURN)).lathe(&[(0.0, 0.0), (0.011, 0.0), (0.0, 0.032)], 24);
}
