//! Promises that every built-in scene keeps.

use super::maths::Frame;
use super::shapes::MeshBuilder;
use super::{build, list};
use crate::{Mesh, Scene};
use glam::{Vec2, Vec3};
use std::collections::BTreeMap;

fn default_scenes() -> impl Iterator<Item = (&'static super::BuiltinInfo, Scene)> {
    list().iter().map(|info| (info, build(info.name).expect(info.name)))
}

/// A number that changes when any vertex or index does.
fn fingerprint(scene: &Scene) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut eat = |word: u32| hash = (hash ^ u64::from(word)).wrapping_mul(0x0100_0000_01b3);
    for mesh in &scene.meshes {
        mesh.positions.iter().flat_map(|p| p.to_array()).for_each(|x| eat(x.to_bits()));
        mesh.indices.iter().for_each(|&i| eat(i));
    }
    for instance in &scene.instances {
        instance.world_from_object.to_cols_array().into_iter().for_each(|x| eat(x.to_bits()));
    }
    hash
}

fn assert_valid(name: &str, scene: &Scene) {
    for mesh in &scene.meshes {
        assert!(mesh.positions.iter().all(|p| p.is_finite()), "{name}: {} is not finite", mesh.name);
        assert!(mesh.indices.iter().all(|&i| (i as usize) < mesh.positions.len()), "{name}: {}", mesh.name);
        assert!(mesh.indices.len() % 3 == 0 && !mesh.indices.is_empty(), "{name}: {}", mesh.name);
        assert!(mesh.uvs.is_empty() || mesh.uvs.len() == mesh.positions.len(), "{name}: {}", mesh.name);
        assert!(mesh.material < scene.materials.len(), "{name}: {}", mesh.name);
    }
    for instance in &scene.instances {
        assert!(instance.mesh < scene.meshes.len(), "{name}");
        assert!(instance.world_from_object.is_finite(), "{name}");
    }
}

#[test]
fn every_scene_builds_as_its_list_entry_says() {
    for (info, scene) in default_scenes() {
        assert_valid(info.name, &scene);
        assert_eq!(scene.triangle_count(), info.triangles, "{}", info.name);
        assert_eq!(scene.name, format!("builtin:{}", info.name));
    }
}

#[test]
fn every_scene_is_the_same_each_time() {
    for (info, scene) in default_scenes() {
        let again = build(info.name).expect(info.name);
        assert_eq!(fingerprint(&scene), fingerprint(&again), "{}", info.name);
    }
}

#[test]
fn every_scene_has_one_ground_and_casters_before_camera_and_light() {
    for (info, scene) in default_scenes() {
        let name = info.name;
        let grounds = scene.instances.iter().filter(|i| i.receiver_only).count();
        assert_eq!(grounds, usize::from(!["bumpy", "grid"].contains(&name)), "{name}");
        assert!(scene.light.size.cmpge(Vec2::ZERO).all() && scene.light.center.y > scene.camera.near, "{name}");
        let clip_from_world = scene.camera.clip_from_world(1.0);
        let casters = || scene.instances.iter().filter(|i| !i.receiver_only);
        let seen = |p: Vec3| {
            let clip = clip_from_world * p.extend(1.0);
            clip.w > scene.camera.near && clip.x.abs() < clip.w && clip.y.abs() < clip.w
        };
        let mut shown = 0;
        for instance in casters() {
            for &p in &scene.meshes[instance.mesh].positions {
                let p = instance.world_from_object.transform_point3(p);
                if seen(p) {
                    shown += 1;
                    assert!(scene.light.light_from_world(p).z > 0.0, "{name}: {p} is behind the light");
                }
            }
        }
        assert!(shown >= 4, "{name}: the camera sees {shown} vertices");
    }
}

#[test]
fn parameters_work_at_both_ends_of_their_range() {
    for info in list() {
        for parameter in info.parameters {
            // The largest forests and plants take seconds; their size is tested on its own.
            let large = ["trees", "triangles", "side"].contains(&parameter.name);
            for value in [Some(parameter.min), (!large).then_some(parameter.max)].into_iter().flatten() {
                let spec = format!("{}:{}={value}", info.name, parameter.name);
                let scene = build(&spec).expect(&spec);
                assert_valid(&spec, &scene);
                assert!(scene.triangle_count() >= 4, "{spec}");
            }
        }
    }
}

#[test]
fn seeds_give_different_scenes_of_the_same_size() {
    let [a, b] = ["forest:trees=20", "forest:trees=20,seed=2"].map(|spec| build(spec).unwrap());
    assert_ne!(fingerprint(&a), fingerprint(&b));
    assert_eq!(a.triangle_count(), b.triangle_count());
}

#[test]
fn triangle_budgets_are_met() {
    let forest = build("forest").unwrap().triangle_count() as f64;
    assert!((forest / 782_000.0 - 1.0).abs() < 0.001, "{forest}");
    let large = build("forest:trees=540").unwrap().triangle_count();
    assert!((4_950_000..5_100_000).contains(&large), "{large}");
    for budget in [300_000, 1_234_567, 2_000_000] {
        let triangles = build(&format!("pipes:triangles={budget}")).unwrap().triangle_count() as f64;
        assert!((triangles / f64::from(budget) - 1.0).abs() < 0.02, "{triangles} of {budget}");
    }
}

#[test]
fn mistakes_are_explained() {
    for (spec, parts) in [
        ("forrest", &["`forrest`", "did you mean `forest`?", "square, disk, spheres"][..]),
        ("qqq", &["`qqq`. There are: square"]),
        ("", &["There are: square"]),
        ("forest:tree=3", &["parameter of `forest`", "did you mean `trees`?", "trees, seed"]),
        ("forest:trees", &["`trees` should read key=value"]),
        ("forest:trees=0", &["`trees` should be a whole number from 1 to 540, not `0`"]),
        ("forest:trees=1e9", &["from 1 to 540"]),
        ("forest:trees=2.5", &["a whole number"]),
        ("square:light=nan", &["a number from 0 to 6, not `nan`"]),
        ("fence:slats=many", &["not `many`"]),
    ] {
        let message = build(spec).expect_err(spec).to_string();
        assert!(message.contains(spec), "{message}");
        for part in parts {
            assert!(message.contains(part), "{spec}: `{message}` lacks `{part}`");
        }
    }
}

/// The volume that a closed mesh encloses, and whether every edge is used once in each direction.
fn volume_and_closed(mesh: &Mesh) -> (f32, bool) {
    let key = |i: u32| mesh.positions[i as usize].to_array().map(|x| (x * 1e5).round() as i64);
    let mut edges: BTreeMap<_, i32> = BTreeMap::new();
    let mut volume = 0.0;
    for t in mesh.indices.chunks(3) {
        let [a, b, c] = [0, 1, 2].map(|k| mesh.positions[t[k] as usize]);
        volume += a.dot(b.cross(c)) / 6.0;
        for k in 0..3 {
            let (from, to) = (key(t[k]), key(t[(k + 1) % 3]));
            *edges.entry((from.min(to), from.max(to))).or_default() += if from < to { 1 } else { -1 };
        }
    }
    (volume, edges.values().all(|&balance| balance == 0))
}

#[test]
fn solids_are_closed_and_wound_outwards() {
    let solid = |shape: &dyn Fn(&mut MeshBuilder)| {
        let mut m = MeshBuilder::new();
        m.at(Frame::at(0.3, 0.2, -0.1).yaw(0.4).pitch(0.3).roll(0.2));
        shape(&mut m);
        volume_and_closed(&m.finish("solid", 0))
    };
    let bent = [Vec3::ZERO, Vec3::Y, Vec3::new(1.0, 2.0, 0.5)];
    for (name, (volume, closed), about) in [
        ("cuboid", solid(&|m| m.cuboid(1.0, 2.0, 3.0)), 6.0),
        ("block", solid(&|m| m.block(1.0, 2.0, 3.0)), 6.0),
        ("bar", solid(&|m| m.bar(Vec3::ZERO, Vec3::X * 2.0, 0.5, 0.4, Vec3::Y)), 0.4),
        ("cylinder", solid(&|m| m.cylinder(1.0, 2.0, 64)), 6.27),
        ("sphere", solid(&|m| m.sphere(1.0, 64)), 4.18),
        ("torus", solid(&|m| m.torus(1.0, 0.25, 64, 32)), 1.23),
        ("rod", solid(&|m| m.rod(Vec3::ZERO, Vec3::Y, 0.5, 64)), 0.785),
        ("tube", solid(&|m| m.tube(&bent, 16, |_| 0.1)), 0.07),
    ] {
        assert!(closed, "{name} is not closed");
        assert!((volume / about - 1.0).abs() < 0.05, "{name}: volume {volume}, not {about}");
    }
}
