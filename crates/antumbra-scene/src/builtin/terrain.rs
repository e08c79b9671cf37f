//! Finely tessellated receivers under a low light: where self-shadowing goes wrong first.

use super::maths::{Frame, TURN, cos, sin};
use super::shapes::{MeshBuilder, arc};
use super::spec::Values;
use super::stage::{Stage, camera, light};
use super::{BuiltinInfo, Parameter};
use crate::Scene;
use glam::{Vec2, Vec3};

pub(super) const BUMPY: BuiltinInfo = BuiltinInfo {
    name: "bumpy",
    title: "Smooth hills in grazing light",
    description: "A finely tessellated height field that shadows itself: shadow acne shows at once",
    parameters: &[Parameter::count("side", 512, 16, 1600, "cells along a side of the height field")],
    triangles: 548_516,
    build: bumpy,
};

pub(super) const GRID: BuiltinInfo = BuiltinInfo {
    name: "grid",
    title: "A plain to the horizon",
    description: "A large finely tessellated plane at a grazing angle with poles and arches: acne and aliasing",
    parameters: &[Parameter::count("side", 400, 16, 1500, "cells along a side of the plane")],
    triangles: 349_472,
    build: grid,
};

/// Height of the hills: a few crossing waves.
fn hill(x: f32, z: f32) -> f32 {
    let long = 0.32 * sin(0.9 * x + 0.5) * cos(0.8 * z - 0.3) + 0.14 * sin(1.7 * z + 0.9 * x);
    long + 0.05 * sin(3.1 * x - 1.3 * z + 1.0) * cos(2.7 * z + 0.6 * x)
}

fn bumpy(values: &Values) -> Scene {
    const EDGE: f32 = 16.0;
    let side = values.count("side");
    let mut stage = Stage::default();
    let sand = stage.color(0.6, 0.5, 0.36);
    let clay = stage.color(0.5, 0.2, 0.12);
    let slate = stage.color(0.24, 0.3, 0.34);
    stage.solid("hills", sand, |m| {
        m.sheet(side, side, |column, row| {
            let (x, z) = (EDGE * (column as f32 / side as f32 - 0.5), EDGE * (0.5 - row as f32 / side as f32));
            Vec3::new(x, hill(x, z), z)
        });
    });
    let on = |x: f32, z: f32, up: f32| Frame::at(x, hill(x, z) + up, z);
    stage.solid("stones", slate, |m| {
        for (x, z, height, turn) in [(-1.9, -0.4, 1.0, 0.1), (-0.7, -1.5, 1.4, 0.35), (0.9, -2.3, 1.0, 0.62)] {
            m.at(on(x, z, -0.3).yaw(TURN * turn)).block(0.34, height + 0.3, 0.22);
        }
    });
    stage.solid("balls", clay, |m| {
        m.at(on(0.1, 0.2, 0.28)).sphere(0.3, 96);
        m.at(on(-0.9, 1.5, 0.6)).sphere(0.18, 96);
        m.at(on(1.5, -0.5, 0.8).roll(0.9).pitch(0.5)).torus(0.34, 0.08, 96, 32);
    });
    stage.finish(
        camera([0.9, 3.3, 6.0], [0.25, 0.1, -0.35], 40.0, 0.1, 60.0),
        light([-9.0, 4.2, -1.5], [0.0, 0.2, 0.0], 0.9, 0.9),
    )
}

fn grid(values: &Values) -> Scene {
    const EDGE: f32 = 400.0;
    let side = values.count("side");
    let mut stage = Stage::default();
    let plain = stage.color(0.56, 0.52, 0.42);
    let stone = stage.color(0.62, 0.57, 0.5);
    let rust = stage.color(0.42, 0.17, 0.1);
    stage.solid("plain", plain, |m| {
        m.sheet(side, side, |column, row| {
            let (x, z) = (column as f32 / side as f32 - 0.5, 0.5 - row as f32 / side as f32);
            Vec3::new(EDGE * x, 0.0, EDGE * (z - 0.4))
        });
    });
    let arch = stage.mesh("arch", stone, gate);
    let pole = stage.mesh("pole", rust, |m| {
        m.cylinder(0.09, 4.6, 24);
        m.at(Frame::at(0.0, 4.6, 0.0)).sphere(0.22, 32);
    });
    for i in 0..12 {
        let z = -1.0 - 9.0 * i as f32;
        stage.place(arch, Frame::at(0.4 * i as f32, 0.0, z));
        stage.place(pole, Frame::at(-4.2, 0.0, z + 3.5));
        stage.place(pole, Frame::at(5.0 + 0.6 * i as f32, 0.0, z - 1.0));
    }
    stage.finish(
        camera([-2.4, 2.3, 12.0], [1.3, 1.1, -12.0], 45.0, 0.1, 500.0),
        light([-46.0, 19.0, 22.0], [0.0, 0.0, -14.0], 3.0, 3.0),
    )
}

/// A free-standing arch of cut stone across the x axis.
fn gate(m: &mut MeshBuilder) {
    let lower: Vec<Vec2> = arc(Vec2::new(0.0, 2.6), 1.5, 0.5 * TURN, 0.0, 33);
    let upper: Vec<Vec2> = arc(Vec2::new(0.0, 2.6), 2.05, 0.5 * TURN, 0.0, 33);
    m.slab(&lower, &upper, 0.7);
    for x in [-1.775, 1.775] {
        m.at(Frame::at(x, 0.0, 0.0)).block(0.55, 2.6, 0.7);
        m.at(Frame::at(x, 2.5, 0.0)).block(0.7, 0.18, 0.85);
        m.at(Frame::at(x, 0.0, 0.0)).block(0.75, 0.22, 0.9);
    }
    m.at(Frame::at(0.0, 4.0, 0.0)).slab(
        &[Vec2::new(-0.14, 0.0), Vec2::new(0.14, 0.0)],
        &[Vec2::new(-0.24, 0.8), Vec2::new(0.24, 0.8)],
        0.8,
    );
}
