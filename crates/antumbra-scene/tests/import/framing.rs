//! The camera, light and ground that a bare model gets.

use crate::no_files;
use antumbra_scene::import::obj;
use antumbra_scene::{Aabb, Scene};
use glam::Vec3;
use proptest::prelude::*;

/// A box as an OBJ file.
fn scene_of(bounds: &Aabb) -> Scene {
    let mut text: String = bounds.corners().iter().map(|c| format!("v {} {} {}\n", c.x, c.y, c.z)).collect();
    text += "f 1 2 4 3\nf 5 6 8 7\nf 1 2 6 5\nf 3 4 8 7\nf 1 3 7 5\nf 2 4 8 6\n";
    obj::parse(text.as_bytes(), "box.obj", &mut no_files).unwrap().into_scene()
}

fn check(bounds: Aabb) {
    let scene = scene_of(&bounds);
    let clip_from_world = scene.camera.clip_from_world(1.0);
    let project = |p: Vec3| clip_from_world.project_point3(p);
    let points = bounds.corners().map(project);
    let filled = Aabb::of_points(points).size() * 0.5;
    assert!(filled.x.max(filled.y) > 0.5 && filled.x.max(filled.y) < 0.66, "the model fills {filled}");
    assert!(points.iter().all(|p| p.abs().max_element() <= 1.0), "all of it is in the picture: {points:?}");

    let (eye, target) = (scene.camera.eye, scene.camera.target);
    let pitch = ((eye.y - target.y) / eye.distance(target)).asin().to_degrees();
    assert!((pitch - 25.0).abs() < 0.1, "seen from {pitch} degrees above");

    let ground: Vec<_> = scene.instances.iter().filter(|i| i.receiver_only).collect();
    let [ground] = ground[..] else { panic!("one ground") };
    let ground = Aabb::of_points(scene.meshes[ground.mesh].positions.iter().copied());
    let size = bounds.size().max_element();
    assert!(ground.min.y <= bounds.min.y && ground.min.y > bounds.min.y - 0.05 * size, "it stands on the ground");
    // Every corner of a wide picture shows the ground, before the far plane.
    let world_from_clip = scene.camera.clip_from_world(2.0).inverse();
    for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
        let through = world_from_clip.project_point3(Vec3::new(x, y, 0.5));
        let ray = through - eye;
        let hit = eye + ray * ((ground.min.y - eye.y) / ray.y);
        assert!(hit.x > ground.min.x && hit.x < ground.max.x && hit.z > ground.min.z && hit.z < ground.max.z);
        let depth = project(hit).z;
        assert!(depth > 0.0 && depth < 1.0, "between near and far: {depth}");
    }

    let light = &scene.light;
    let distance = light.center.distance(light.target);
    let part = light.size.x / distance;
    assert!((0.05..=0.2).contains(&part), "the light's edge is {part} of its distance");
    assert!(bounds.corners().iter().all(|&c| light.light_from_world(c).z > 0.0), "all of it is before the light");
    let (right, ..) = scene.camera.basis();
    assert!((light.center - light.target).dot(right) < 0.0, "the shadow falls to the right");
}

#[test]
fn boxes_of_all_proportions_are_framed() {
    check(Aabb { min: Vec3::splat(-1.0), max: Vec3::splat(1.0) });
    check(Aabb { min: Vec3::new(-1.0, 0.0, -1.0), max: Vec3::new(1.0, 9.0, 1.0) });
    check(Aabb { min: Vec3::new(-5.0, 2.0, -1.0), max: Vec3::new(5.0, 2.0, 1.0) });
    check(Aabb { min: Vec3::new(100.0, 50.0, -300.0), max: Vec3::new(100.5, 50.1, -299.0) });
}

#[test]
fn a_model_that_is_a_point_gets_a_finite_scene() {
    let scene = scene_of(&Aabb { min: Vec3::ONE, max: Vec3::ONE });
    assert!(scene.camera.eye.is_finite() && scene.camera.near > 0.0 && scene.camera.far > scene.camera.near);
    assert!(scene.light.center.is_finite() && scene.light.center != scene.light.target);
}

proptest! {
    #[test]
    fn any_box_is_framed(
        low in prop::array::uniform3(-100.0f32..100.0),
        size in prop::array::uniform3(0.1f32..100.0),
        zoom in -3i32..4,
    ) {
        let (min, zoom) = (Vec3::from(low), 10.0f32.powi(zoom));
        check(Aabb { min: min * zoom, max: (min + Vec3::from(size)) * zoom });
    }
}
