//! The low-resolution map against an exact test of every triangle with every texel, in double precision.

use super::{Random, drawn, gpu, scene, submit};
use crate::passes::maps::depth_map::DepthMap;
use antumbra_scene::Scene;
use glam::{DVec2, DVec3, Vec3};
use pollster::block_on;

const SIZE: u32 = 48;

/// A scene of random triangles, some large, some slivers, some smaller than a texel, instead of a scene's own.
fn triangles(seed: u64) -> Scene {
    let mut random = Random(seed);
    let mut scene = scene("square");
    let mesh = scene.instances.iter().find(|i| !i.receiver_only).expect("a caster").mesh;
    let mut point =
        |reach: f32| Vec3::new(random.within(-1.0, 1.0), random.within(-0.3, 0.3), random.within(-1.0, 1.0)) * reach;
    let mut positions = Vec::new();
    for k in 0..60 {
        let reach = [0.6, 0.05, 0.004][k % 3];
        let middle = point(1.0) + Vec3::new(0.0, 1.0, 0.0);
        let along = point(reach);
        let third = if k % 4 == 0 { along * 0.5 + point(1e-4) } else { point(reach) };
        positions.extend([middle, middle + along, middle + third]);
    }
    let mesh = &mut scene.meshes[mesh];
    mesh.indices = (0..positions.len() as u32).collect();
    mesh.positions = positions;
    scene
}

/// Distance between a triangle and a square around `middle` by the separating axis theorem [Gottschalk 1996]: the
/// largest separation along any axis; negative if they overlap.
fn separation(corners: &[DVec2; 3], middle: DVec2, half: f64) -> f64 {
    let mut widest = f64::NEG_INFINITY;
    let edges = (0..3).map(|k| (corners[(k + 1) % 3] - corners[k]).perp().normalize_or_zero());
    for axis in edges.chain([DVec2::X, DVec2::Y]).filter(|a| *a != DVec2::ZERO) {
        let reach = half * (axis.x.abs() + axis.y.abs());
        let at = corners.map(|c| axis.dot(c - middle));
        let (low, high) = (at[0].min(at[1]).min(at[2]), at[0].max(at[1]).max(at[2]));
        widest = widest.max((low - reach).max(-reach - high));
    }
    widest
}

#[test]
fn no_texel_that_a_caster_touches_is_missed_and_none_far_from_all_is_drawn() {
    let (mut touched, mut missed, mut extra, mut plain_missed) = (0, Vec::new(), Vec::new(), 0);
    for seed in 90..96 {
        let scene = triangles(seed);
        let renderer = drawn(&scene, [16, 16]);
        let frame = &renderer.frame;
        let [whole, plain] = [true, false].map(|conservative| {
            let mut map = None;
            submit(|recorder| {
                let frame = frame.bind(recorder)?;
                map = Some(match conservative {
                    true => DepthMap::record_touched(recorder, &frame, "low-resolution map", SIZE)?,
                    false => DepthMap::of_light(recorder, &frame, SIZE)?,
                });
                Ok(())
            });
            let bytes = block_on(gpu().read_texture(&map.expect("drawn").texture)).expect("reads");
            bytemuck::pod_collect_to_vec::<u8, f32>(&bytes)
        });
        let f = &frame.frustum;
        let project = |p: Vec3| {
            let p = scene.light.light_from_world(p).as_dvec3();
            let t = p.truncate() / p.z / f.tan_half.as_dvec2();
            ((0.5 + 0.5 * t) * f64::from(SIZE), f64::from(f.near) / p.z)
        };
        let all: Vec<([DVec2; 3], DVec3)> = scene
            .instances
            .iter()
            .filter(|i| !i.receiver_only)
            .flat_map(|i| {
                let mesh = &scene.meshes[i.mesh];
                mesh.indices.chunks_exact(3).map(|t| {
                    let at = [t[0], t[1], t[2]]
                        .map(|v| project(i.world_from_object.transform_point3(mesh.positions[v as usize])));
                    (at.map(|(position, _)| position), DVec3::from_array(at.map(|(_, depth)| depth)))
                })
            })
            .collect();
        for texel in 0..SIZE * SIZE {
            let middle = DVec2::new(f64::from(texel % SIZE) + 0.5, f64::from(texel / SIZE) + 0.5);
            let near: Vec<f64> = all.iter().map(|(corners, _)| separation(corners, middle, 0.5)).collect();
            let name = format!("texel ({}, {}) of {seed}", texel % SIZE, texel / SIZE);
            let depth = f64::from(whole[texel as usize]);
            // An overlap smaller than rounding may or may not be drawn.
            if near.iter().any(|s| *s < -1e-3) {
                touched += 1;
                plain_missed += usize::from(plain[texel as usize] == 0.0);
                // As near as the farthest corner of the nearest triangle, but for two hundredths.
                let nearest = all.iter().zip(&near).filter(|(_, s)| **s < -1e-3);
                let least = nearest.map(|((_, depths), _)| depths.min_element()).fold(0.0, f64::max);
                if depth < 0.98 * least * (1.0 - 1e-5) {
                    missed.push(format!("{name}: {depth} where {least} is touched"));
                }
            } else if depth > 0.0 && near.iter().all(|s| *s > 2e-2) {
                extra.push(name);
            }
        }
    }
    println!("{touched} texels touched; by middles alone {plain_missed} of them are empty");
    assert!(touched > 1000 && plain_missed > 100, "{touched} texels, {plain_missed}: too easy a case");
    assert!(missed.is_empty(), "{} of {touched} texels: {:?}", missed.len(), &missed[..missed.len().min(5)]);
    assert!(extra.is_empty(), "{} texels that nothing is near to: {:?}", extra.len(), &extra[..extra.len().min(5)]);
}
