//! Perforated sheets and rows of bars, one over the other.

use super::maths::{Frame, TURN};
use super::spec::Values;
use super::stage::{Stage, camera, light};
use super::{BuiltinInfo, Parameter};
use crate::Scene;
use glam::Vec3;

pub(super) const LAYERS: BuiltinInfo = BuiltinInfo {
    name: "layers",
    title: "Stacked occluders",
    description: "Bars and perforated sheets at several heights: light leaks through where only moments are kept",
    parameters: &[Parameter::count("layers", 3, 1, 8, "number of sheets")],
    triangles: 7978,
    build,
};

/// Edge of the lowest sheet; each is smaller than the one below, so that all are seen.
const EDGE: f32 = 2.4;

fn build(values: &Values) -> Scene {
    let layers = values.count("layers");
    let mut stage = Stage::default();
    let ground = stage.color(0.64, 0.62, 0.58);
    let steel = stage.color(0.3, 0.34, 0.38);
    let paints = [(0.56, 0.42, 0.24), (0.3, 0.42, 0.42), (0.55, 0.24, 0.16)].map(|(r, g, b)| stage.color(r, g, b));
    stage.ground(40.0, ground);
    let gap = 2.2 / (layers as f32 + 0.5);
    for i in 0..layers {
        let (y, edge) = (gap * (i as f32 + 0.75), EDGE - 1.2 * i as f32 / layers as f32);
        let name = format!("layer {}", i + 1);
        stage.solid(&name, paints[i % 3], |m| {
            m.at(Frame::at(0.0, y, 0.0).yaw(TURN * 0.02 * i as f32));
            if i % 2 == 0 { bars(m, edge) } else { m.perforated(6, edge / 6.0, edge / 18.0, 0.03) }
        });
    }
    stage.solid("posts", steel, |m| {
        for i in 0..layers {
            let (y, edge) = (gap * (i as f32 + 0.75), EDGE - 1.2 * i as f32 / layers as f32);
            for (x, z) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                let inset = 0.5 * edge - 0.04;
                m.at(Frame::IDENTITY.yaw(TURN * 0.02 * i as f32).shift(x * inset, 0.0, z * inset));
                m.cylinder(0.016, y - 0.01, 16);
            }
        }
    });
    stage.finish(
        camera([2.5, 3.6, 4.4], [0.0, 0.68, 0.1], 40.0, 0.1, 60.0),
        light([-1.7, 6.5, -1.0], [0.0, 0.0, 0.0], 1.2, 1.2),
    )
}

/// A square frame with bars across, its top at y = 0.
fn bars(m: &mut super::shapes::MeshBuilder, edge: f32) {
    const COUNT: usize = 9;
    let half = 0.5 * edge;
    for i in 0..=COUNT {
        let x = edge * (i as f32 / COUNT as f32 - 0.5) * 0.965;
        m.bar(Vec3::new(x, -0.02, -half), Vec3::new(x, -0.02, half), 0.08, 0.04, Vec3::Y);
    }
    for z in [-half + 0.06, half - 0.06] {
        m.bar(Vec3::new(-half, -0.045, z), Vec3::new(half, -0.045, z), 0.08, 0.04, Vec3::Y);
    }
}
