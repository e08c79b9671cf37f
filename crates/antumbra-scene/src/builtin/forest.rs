//! A clearing in a forest.

use super::maths::{Frame, Random, TURN, mix, on_circle, steps};
use super::shapes::MeshBuilder;
use super::spec::Values;
use super::stage::{Stage, camera, light};
use super::{BuiltinInfo, Parameter, tree};
use crate::Scene;
use glam::{Vec2, Vec3};

pub(super) const FOREST: BuiltinInfo = BuiltinInfo {
    name: "forest",
    title: "A clearing in a forest",
    description: "Leaves far over a sunflecked ground: many small casters, instanced trees, up to 5 million triangles",
    parameters: &[
        Parameter::count("trees", 80, 1, 540, "number of trees, of 9194 triangles each"),
        Parameter::count("seed", 4, 0, 1_000_000, "which forest of its kind"),
    ],
    triangles: 782_030,
    build,
};

/// Distinct trees of every species.
const SIBLINGS: usize = 2;
/// Middle and radius of the clearing in x and z.
const CLEARING: (Vec2, f32) = (Vec2::new(0.3, 2.2), 4.4);

fn build(values: &Values) -> Scene {
    let mut stage = Stage::default();
    let mut random = Random::new(values.seed());
    let floor = stage.color(0.34, 0.29, 0.17);
    stage.ground(200.0, floor);
    let kinds = grow_kinds(&mut stage, &mut random);
    let spots = spots(values.count("trees"), &mut random);
    for (i, spot) in spots.iter().enumerate() {
        let frame = Frame::at(spot.x, 0.0, spot.y).yaw(TURN * random.unit()).scale(random.between(0.85, 1.15));
        for mesh in kinds[(i * 7 + random.below(3)) % kinds.len()] {
            stage.place(mesh, frame);
        }
    }
    bushes(&mut stage, &mut random);
    undergrowth(&mut stage, &spots, &mut random);
    stage.finish(
        camera([0.6, 2.5, 9.4], [-0.1, 1.5, 0.0], 48.0, 0.1, 300.0),
        light([-12.0, 34.0, -14.0], [0.0, 0.0, 0.0], 1.2, 1.2),
    )
}

/// Wood and leaves of every distinct tree.
fn grow_kinds(stage: &mut Stage, random: &mut Random) -> Vec<[usize; 2]> {
    let bark = [(0.2, 0.14, 0.09), (0.27, 0.22, 0.17), (0.55, 0.52, 0.46)].map(|(r, g, b)| stage.color(r, g, b));
    let green = [(0.13, 0.25, 0.05), (0.22, 0.32, 0.07), (0.3, 0.34, 0.08)].map(|(r, g, b)| stage.color(r, g, b));
    let paint = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 0)];
    (0..SIBLINGS * tree::SPECIES.len())
        .map(|i| {
            let kind = i % tree::SPECIES.len();
            let (wood, leaves) = tree::grow(&tree::SPECIES[kind], random);
            let (bark, green) = (bark[paint[kind].0], green[paint[kind].1]);
            [stage.mesh("wood", bark, |m| *m = wood), stage.mesh("leaves", green, |m| *m = leaves)]
        })
        .collect()
}

/// Where trees stand: on a spiral lattice with some disorder, outside of the clearing and not behind the camera.
fn spots(count: usize, random: &mut Random) -> Vec<Vec2> {
    const SPACING: f32 = 3.0;
    let candidates = (0..).map(|i| {
        let disorder = Vec2::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0)) * (0.25 * SPACING);
        // The golden angle and the square root spread points evenly.
        CLEARING.0 + on_circle(TURN * 0.381_966 * i as f32) * (SPACING * (i as f32 / 3.1).sqrt()) + disorder
    });
    let is_behind_camera = |p: &Vec2| p.y > 5.5 && p.y + 1.0 > p.x.abs();
    candidates.filter(|p| p.distance(CLEARING.0) > CLEARING.1 && !is_behind_camera(p)).take(count).collect()
}

/// Bushes between the trees far from the camera: they close the view.
fn bushes(stage: &mut Stage, random: &mut Random) {
    const BUSHES: usize = 36;
    let green = stage.color(0.15, 0.22, 0.06);
    let bush = tree::bush(550, random);
    let bush = stage.mesh("bush", green, |m| *m = bush);
    for i in 0..BUSHES {
        let angle = TURN * (0.5 + 0.5 * (i as f32 + 0.8 * random.unit()) / BUSHES as f32);
        let spot = CLEARING.0 + on_circle(angle) * random.between(11.0, 21.0);
        stage.place(bush, Frame::at(spot.x, 0.0, spot.y).yaw(TURN * random.unit()).scale(random.between(1.3, 2.1)));
    }
}

/// Ferns at the clearing's edge, grass in it, stones and a fallen trunk.
fn undergrowth(stage: &mut Stage, trees: &[Vec2], random: &mut Random) {
    const FERNS: usize = 26;
    let green = stage.color(0.16, 0.27, 0.07);
    let bark = stage.color(0.22, 0.16, 0.11);
    let stone = stage.color(0.36, 0.35, 0.32);
    let fern = stage.mesh("fern", green, |m| fern(m, random));
    for i in 0..FERNS {
        let angle = TURN * (i as f32 + random.unit()) / FERNS as f32;
        let spot = CLEARING.0 + on_circle(angle) * (CLEARING.1 * random.between(0.8, 1.3));
        let free = trees.iter().all(|t| t.distance(spot) > 0.7);
        let spot = if free { spot } else { spot + on_circle(angle + 1.6) * 0.9 };
        stage.place(fern, Frame::at(spot.x, -0.02, spot.y).yaw(TURN * random.unit()).scale(random.between(0.8, 1.5)));
    }
    stage.solid("log", bark, |m| {
        let path: Vec<Vec3> =
            steps(0.0, 1.0, 7).map(|t| Vec3::new(mix(-3.6, -0.6, t), 0.2 - 0.03 * t, mix(0.2, 2.2, t))).collect();
        m.tube(&path, 20, |i| 0.23 - 0.012 * i as f32);
        m.rod(Vec3::new(-1.9, 0.25, 1.3), Vec3::new(-1.75, 0.85, 1.0), 0.05, 10);
    });
    stage.solid("stones", stone, |m| {
        for (x, z, size) in [(1.9, 1.2, 0.34), (2.5, 1.6, 0.2), (1.5, 1.75, 0.13), (-2.2, 4.2, 0.16)] {
            let mut frame = Frame::at(x, 0.18 * size, z).yaw(7.0 * x);
            frame.axes.y_axis *= 0.62;
            frame.axes.x_axis *= 1.25;
            m.at(frame).sphere(size, 20);
        }
    });
}

/// Arching fronds with leaflets on both sides.
fn fern(m: &mut MeshBuilder, random: &mut Random) {
    const FRONDS: usize = 9;
    const LEAFLETS: usize = 11;
    for i in 0..FRONDS {
        let c = on_circle(TURN * (i as f32 + 0.6 * random.unit()) / FRONDS as f32);
        let (out, length) = (Vec3::new(c.x, 0.0, c.y), random.between(0.55, 0.85));
        let spine = |t: f32| (out * (0.9 * t) + Vec3::Y * (1.05 * t - 0.95 * t * t)) * length;
        let side = Vec3::Y.cross(out);
        for k in 0..LEAFLETS {
            let (a, b) = (k as f32 / LEAFLETS as f32, (k as f32 + 0.8) / LEAFLETS as f32);
            let width = length * 0.3 * (0.25 + a) * (1.0 - a);
            for s in [-1.0, 1.0] {
                let tip = spine(0.5 * (a + b) + 0.06) + (side * s - Vec3::Y * 0.25) * width;
                m.facet([spine(a), tip, spine(b)]);
            }
        }
    }
}
