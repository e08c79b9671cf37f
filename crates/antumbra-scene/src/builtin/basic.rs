//! One square, one disk, some spheres.

use super::maths::{Frame, TURN, on_circle};
use super::spec::Values;
use super::stage::{Stage, camera, light};
use super::{BuiltinInfo, Parameter};
use crate::Scene;
use glam::Vec3;

const LIGHT: Parameter = Parameter::real("light", 0.8, 0.0, 6.0, "edge length of the light in metres, 0 for a point");
const LIGHT_HEIGHT: f64 = 3.0;
const HEIGHT: Parameter = Parameter::real("height", 1.0, 0.01, 2.9, "height over the ground in metres");

pub(super) const SQUARE: BuiltinInfo = BuiltinInfo {
    name: "square",
    title: "A square over a plane",
    description: "A square parallel to a square light 3 m over the ground: visibility has a closed form",
    parameters: &[Parameter::real("size", 1.0, 0.01, 10.0, "edge length of the square in metres"), HEIGHT, LIGHT],
    triangles: 4,
    build: square,
};

pub(super) const DISK: BuiltinInfo = BuiltinInfo {
    name: "disk",
    title: "A disk over a plane",
    description: "A finely tessellated disk parallel to a square light: round umbra, smooth silhouette",
    parameters: &[
        Parameter::real("radius", 0.6, 0.01, 5.0, "radius of the disk in metres"),
        HEIGHT,
        LIGHT,
        Parameter::count("segments", 256, 8, 4096, "corners of the rim"),
    ],
    triangles: 7938,
    build: disk,
};

pub(super) const SPHERES: BuiltinInfo = BuiltinInfo {
    name: "spheres",
    title: "Spheres on and over the ground",
    description: "Spheres of several sizes that rest, float and shadow each other: contact, curved receivers",
    parameters: &[Parameter::count("segments", 128, 8, 1024, "quads around each sphere")],
    triangles: 322_562,
    build: spheres,
};

/// The ground, and the camera and light that both flat shapes share.
fn over_plane(values: &Values, add: impl FnOnce(&mut Stage, usize)) -> Scene {
    let mut stage = Stage::default();
    let ground = stage.color(0.62, 0.6, 0.56);
    let shape = stage.color(0.55, 0.2, 0.13);
    stage.ground(40.0, ground);
    add(&mut stage, shape);
    let edge = values.real("light");
    stage.finish(
        camera([1.9, 2.15, 3.1], [0.0, 0.3, 0.0], 40.0, 0.1, 60.0),
        light([0.0, LIGHT_HEIGHT as f32, 0.0], [0.0, 0.0, 0.0], edge, edge),
    )
}

fn square(values: &Values) -> Scene {
    let (half, height) = (0.5 * values.real("size"), values.real("height"));
    over_plane(values, |stage, material| {
        stage.solid("square", material, |m| {
            let corners = [(-half, half), (half, half), (half, -half), (-half, -half)];
            m.patch(corners.map(|(x, z)| Vec3::new(x, height, z)));
        });
    })
}

fn disk(values: &Values) -> Scene {
    /// Rings of quads around the middle fan.
    const RINGS: usize = 15;
    let (radius, segments) = (values.real("radius"), values.count("segments"));
    over_plane(values, |stage, material| {
        stage.solid("disk", material, |m| {
            m.at(Frame::at(0.0, values.real("height"), 0.0));
            let profile: Vec<(f32, f32)> =
                (0..=RINGS + 1).rev().map(|i| (radius * i as f32 / (RINGS + 1) as f32, 0.0)).collect();
            m.lathe(&profile, segments);
        });
    })
}

fn spheres(values: &Values) -> Scene {
    let mut stage = Stage::default();
    let segments = values.count("segments");
    let ground = stage.color(0.6, 0.58, 0.54);
    stage.ground(60.0, ground);
    let paints = [(0.5, 0.16, 0.1), (0.62, 0.5, 0.3), (0.16, 0.3, 0.36), (0.7, 0.68, 0.64)];
    let balls = paints.map(|(r, g, b)| {
        let paint = stage.color(r, g, b);
        stage.mesh("sphere", paint, |m| m.sphere(1.0, segments))
    });
    // (paint, x, z, radius, gap under it)
    let resting = [(0, -0.75, -0.35, 0.6, 0.0), (1, 0.55, 0.35, 0.36, 0.0), (2, -0.25, 0.7, 0.22, 0.0)];
    let small = [(3, 0.95, 0.95, 0.14, 0.0), (0, 0.3, 1.05, 0.1, 0.0)];
    let floating = [(2, 0.95, -0.75, 0.4, 0.5), (3, 0.2, -0.35, 0.2, 1.0), (1, -1.05, 0.85, 0.14, 0.35)];
    for (paint, x, z, radius, gap) in resting.into_iter().chain(small).chain(floating) {
        stage.place(balls[paint], Frame::at(x, radius + gap, z).scale(radius));
    }
    // A crown of beads over the largest: small casters on a curved receiver.
    let crown = Frame::along(Vec3::new(-0.75, 0.6, -0.35), Vec3::new(-0.3, 1.0, 0.55));
    for i in 0..12 {
        let p = on_circle(TURN * i as f32 / 12.0) * 0.36;
        stage.place(balls[if i % 3 == 0 { 2 } else { 3 }], crown.shift(p.x, 0.68, p.y).scale(0.05));
    }
    stage.finish(
        camera([0.5, 2.5, 4.5], [0.02, 0.48, 0.05], 38.0, 0.1, 80.0),
        light([-2.8, 4.6, 0.3], [-1.2, 0.0, 0.1], 1.0, 1.0),
    )
}
