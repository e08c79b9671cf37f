//! A picket fence with its shadow on the ground.

use super::maths::Frame;
use super::spec::Values;
use super::stage::{Stage, camera, light};
use super::{BuiltinInfo, Parameter};
use crate::Scene;
use glam::Vec2;

pub(super) const FENCE: BuiltinInfo = BuiltinInfo {
    name: "fence",
    title: "A picket fence",
    description: "The shadow runs from contact to a wide penumbra towards the camera",
    parameters: &[Parameter::count("slats", 31, 3, 2000, "number of slats over the fence's 6 m")],
    triangles: 4662,
    build,
};

const WIDTH: f32 = 6.0;
const HEIGHT: f32 = 1.25;

fn build(values: &Values) -> Scene {
    let slats = values.count("slats");
    let mut stage = Stage::default();
    let earth = stage.color(0.5, 0.47, 0.38);
    let paint = stage.color(0.72, 0.7, 0.64);
    let wood = stage.color(0.42, 0.28, 0.17);
    let clay = stage.color(0.5, 0.2, 0.11);
    stage.ground(60.0, earth);

    let pitch = WIDTH / slats as f32;
    let picket = stage.mesh("slat", paint, |m| slat(m, 0.5 * pitch));
    for i in 0..slats {
        stage.place(picket, Frame::at((i as f32 + 0.5) * pitch - 0.5 * WIDTH, 0.0, 0.0));
    }
    stage.solid("rails", wood, |m| {
        for y in [0.3, 0.95] {
            m.at(Frame::at(0.0, y, -0.0375)).cuboid(WIDTH, 0.09, 0.045);
        }
        for x in [-2.9, -0.97, 0.97, 2.9] {
            m.at(Frame::at(x, 0.0, -0.1)).block(0.1, 1.1, 0.1);
        }
    });
    stage.solid("ball", clay, |m| m.at(Frame::at(-1.0, 0.16, 1.0)).sphere(0.16, 64));
    stage.finish(
        camera([2.5, 2.75, 4.4], [-0.1, 0.2, 0.5], 41.0, 0.1, 80.0),
        light([5.5, 8.5, -12.0], [1.2, 0.0, -2.8], 2.1, 2.1),
    )
}

/// A slat with a pointed head.
fn slat(m: &mut super::shapes::MeshBuilder, width: f32) {
    let half = 0.5 * width.min(0.14);
    let columns = [-half, 0.0, half];
    let row = |y: f32, tip: f32| columns.map(|x| Vec2::new(x, y + tip * (1.0 - x.abs() / half)));
    m.slab(&row(0.0, 0.0), &row(HEIGHT - 0.08, 0.08), 0.03);
}
