//! A potted plant whose leaves are cut out of quads by a texture.

use super::maths::{Frame, Random, TURN, cos, mix, on_circle, power, sin, smoothstep, steps};
use super::shapes::MeshBuilder;
use super::spec::Values;
use super::stage::{Stage, camera, light};
use super::{BuiltinInfo, Parameter};
use crate::{Material, Scene, Texture, Wrap};
use glam::{Vec2, Vec3};
use std::sync::Arc;

pub(super) const PLANT: BuiltinInfo = BuiltinInfo {
    name: "plant",
    title: "A potted plant",
    description: "Leaves with slits, cut out of curved strips by an alpha-masked texture",
    parameters: &[
        Parameter::count("leaves", 26, 1, 2000, "number of leaves"),
        Parameter::count("seed", 1, 0, 1_000_000, "which plant of its kind"),
    ],
    triangles: 10_498,
    build,
};

/// Height of the earth in the pot.
const EARTH: f32 = 0.36;

fn build(values: &Values) -> Scene {
    let mut stage = Stage::default();
    let floor = stage.color(0.6, 0.55, 0.48);
    let clay = stage.color(0.5, 0.22, 0.13);
    let soil = stage.color(0.1, 0.07, 0.05);
    let stem = stage.color(0.2, 0.3, 0.1);
    let leaf = stage.material(Material {
        texture: Some(Arc::new(leaf_texture())),
        alpha_cutoff: Some(0.5),
        ..Material::of_color(1.0, 1.0, 1.0)
    });
    stage.ground(20.0, floor);
    stage.solid("pot", clay, pot);
    stage.solid("soil", soil, |m| {
        m.at(Frame::at(0.0, EARTH - 0.1, 0.0)).lathe(&[(0.0, 0.0), (0.19, 0.0), (0.21, 0.1), (0.0, 0.115)], 64);
    });
    let mut random = Random::new(values.seed());
    let stalks: Vec<Vec<Vec3>> =
        (0..values.count("leaves")).map(|i| stalk(i, values.count("leaves"), &mut random)).collect();
    stage.solid("stems", stem, |m| {
        for path in &stalks {
            m.tube(path, 10, |i| mix(0.0085, 0.0035, i as f32 / (path.len() - 1) as f32));
        }
    });
    stage.solid("leaves", leaf, |m| {
        for path in &stalks {
            blade(m, path, &mut random);
        }
    });
    stage.finish(
        camera([0.7, 2.3, 2.7], [0.16, 0.5, 0.0], 36.0, 0.05, 40.0),
        light([-1.7, 3.6, 1.3], [0.0, 0.3, 0.0], 0.42, 0.42),
    )
}

/// A pot with a lip, hollow down to the earth.
fn pot(m: &mut MeshBuilder) {
    let profile = [
        (0.0, 0.0),
        (0.15, 0.0),
        (0.158, 0.01),
        (0.215, 0.31),
        (0.235, 0.312),
        (0.24, 0.32),
        (0.245, 0.395),
        (0.24, 0.4),
        (0.215, 0.4),
        (0.208, 0.39),
        (0.19, 0.27),
        (0.0, 0.27),
    ];
    m.lathe(&profile, 96);
}

/// The path of a leaf's stalk: out of the earth, upwards, bending outwards.
fn stalk(index: usize, count: usize, random: &mut Random) -> Vec<Vec3> {
    // The golden angle spreads directions evenly; inner stalks are steeper and longer.
    let angle = TURN * (0.381_966 * index as f32 + random.between(-0.03, 0.03));
    let outward = on_circle(angle);
    let age = (index as f32 + 0.5) / count as f32;
    let length = mix(0.85, 0.35, age) * random.between(0.9, 1.1);
    let lean = mix(0.25, 1.15, power(age, 0.8));
    let foot = outward * mix(0.01, 0.11, age);
    let mut p = Vec3::new(foot.x, EARTH - 0.02, foot.y);
    let mut path = vec![p];
    for t in steps(0.0, 1.0, 9) {
        let tilt = lean * (0.25 + 1.0 * t);
        let step = length / 9.0;
        p += Vec3::new(outward.x * sin(tilt), cos(tilt), outward.y * sin(tilt)) * step;
        path.push(p);
    }
    path
}

/// A leaf at the end of its stalk: a strip that hangs and folds along its middle.
fn blade(m: &mut MeshBuilder, path: &[Vec3], random: &mut Random) {
    const COLUMNS: usize = 6;
    const ROWS: usize = 10;
    let end = path[path.len() - 1];
    let along = (end - path[path.len() - 2]).normalize();
    let level = Vec3::new(along.x, 0.0, along.z).normalize();
    let side = Vec3::Y.cross(level);
    let size = random.between(0.24, 0.36);
    let (twist, droop) = (random.between(-0.35, 0.35), random.between(0.9, 1.5));
    let side = (side * cos(twist) + Vec3::Y * sin(twist)).normalize();
    let mut spine = end - level * (0.12 * size);
    let mut previous: Vec<u32> = Vec::new();
    for row in 0..=ROWS {
        let t = row as f32 / ROWS as f32;
        let pitch = 0.35 - droop * t;
        let forward = level * cos(pitch) + Vec3::Y * sin(pitch);
        let normal = forward.cross(side).normalize() * -1.0;
        let current: Vec<u32> = (0..=COLUMNS)
            .map(|column| {
                let u = column as f32 / COLUMNS as f32 - 0.5;
                let p = spine + side * (u * size) - normal * (0.9 * u * u * size);
                m.textured_vertex(p, Vec2::new(u + 0.5, t))
            })
            .collect();
        if row > 0 {
            for k in 0..COLUMNS {
                m.quad(previous[k], current[k], current[k + 1], previous[k + 1]);
            }
        }
        previous = current;
        spine += forward * (1.1 * size / ROWS as f32);
    }
}

/// A heart-shaped leaf with slits between its veins, its stalk at v = 0.12.
fn leaf_texture() -> Texture {
    const SIDE: u32 = 512;
    let mut rgba = Vec::with_capacity((SIDE * SIDE * 4) as usize);
    for y in 0..SIDE {
        for x in 0..SIDE {
            let uv = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) / SIDE as f32;
            let (inside, vein) = leaf(uv);
            let tone = |dark: f32, light: f32| mix(dark, light, vein) as u8;
            rgba.extend([tone(52.0, 118.0), tone(104.0, 150.0), tone(46.0, 78.0), (255.0 * inside) as u8]);
        }
    }
    Texture { width: SIDE, height: SIDE, rgba, wrap: [Wrap::Clamp; 2], nearest: false }
}

/// Cover and strength of the veins at a point of the leaf, both in [0, 1].
fn leaf(uv: Vec2) -> (f32, f32) {
    let (x, t) = ((uv.x - 0.5).abs() * 2.0, (uv.y - 0.02) / 0.96);
    // Half width: two round lobes behind the stalk, then a long taper to the tip.
    let lobe = 0.12;
    let width = if t < 0.3 {
        0.92 * (1.0 - power(((0.3 - t) / 0.3).clamp(0.0, 1.0), 2.0)).max(0.0).sqrt()
    } else {
        0.92 * cos(0.25 * TURN * power((t - 0.3) / 0.7, 1.25).min(1.0))
    };
    let notch = if t < lobe { 0.35 * (lobe - t) / lobe } else { 0.0 };
    let outline = (width - x).min((x - notch) + if t < lobe { 0.0 } else { 1.0 });
    // Veins leave the middle at a slant; slits lie half-way between them and open at the edge.
    let slant = t - 0.42 * x;
    let phase = (slant * 8.5 + 0.25).rem_euclid(1.0) - 0.5;
    let slit_from = 0.38 + 0.1 * sin(slant * 40.0);
    let slit = if (-0.05..0.72).contains(&slant) { 0.2 * smoothstep(slit_from, 0.8, x) + 0.05 } else { 0.0 };
    let gap = if x > slit_from && (0.5 - phase.abs()) < slit { -0.05 } else { 1.0 };
    let edge = outline.min(gap);
    let vein = (1.0 - smoothstep(0.012, 0.03, x)).max(0.7 * (1.0 - smoothstep(0.02, 0.07, phase.abs())));
    (smoothstep(-0.012, 0.012, edge), vein)
}
