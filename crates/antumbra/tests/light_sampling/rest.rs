//! What may be kept from frame to frame while casters rest.

use crate::common::{camera, cuboid, gpu, submit, technique};
use crate::{SIZE, assert_same, fresh, hovering, seen, stat, visibility};
use antumbra::View;
use antumbra::scene::{SceneRenderer, upload};
use antumbra_scene::Camera;
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// A box over the ground, whose host says that no caster moves.
fn resting() -> SceneRenderer {
    let mut renderer = seen(&hovering(Vec2::new(0.9, 0.7)));
    renderer.frame.static_casters = true;
    renderer
}

/// Moves camera and light; the frustum stays.
fn change(renderer: &mut SceneRenderer, camera: &Camera, light_shift: Vec3) {
    let (mut light, frustum) = (renderer.frame.light, renderer.frame.frustum);
    light.center += light_shift;
    renderer.frame.update(View::of_camera(camera, SIZE), light, frustum);
    submit(|encoder| renderer.record_geometry(gpu(), encoder, None)).unwrap_or_else(|e| panic!("{e}"));
}

fn near() -> Camera {
    camera([1.5, 1.7, 2.6], [0.1, 0.3, 0.1], 42.0)
}

/// Sees the other side of the box and of its shadow.
fn aside() -> Camera {
    camera([-1.9, 1.2, 1.6], [0.2, 0.2, 0.0], 42.0)
}

#[test]
fn maps_of_resting_casters_are_drawn_once() {
    for settings in ["maps=20", "maps=20,filter=pcf", "depth=2", "depth=2,criterion=relative,space=light"] {
        let spec = format!("adaptive-sampling:map=64,{settings}");
        let mut renderer = resting();
        let mut kept = technique(&spec);
        let mut frame = |renderer: &SceneRenderer, what: &str| {
            let found = visibility(renderer, &mut kept);
            assert_same(&found, &fresh(renderer, &spec), &format!("{settings}: {what}, a used instance and a new one"));
            let (maps, drawn) = (stat(&kept, "maps"), stat(&kept, "maps drawn"));
            println!("{settings}: {what}: {maps} maps, {drawn} drawn");
            (found, maps, drawn)
        };
        let (first, maps, drawn) = frame(&renderer, "the first frame");
        assert!(maps > 9 && drawn == maps, "{settings}: {drawn} of {maps} maps drawn in the first frame");
        let (second, _, drawn) = frame(&renderer, "nothing moves");
        assert_eq!(drawn, 0, "{settings}: maps drawn where nothing moves");
        assert_same(&second, &first, settings);

        change(&mut renderer, &aside(), Vec3::ZERO);
        let (_, maps, drawn) = frame(&renderer, "the camera moves");
        assert!(drawn < maps, "{settings}: {drawn} of {maps} maps drawn as the camera moves");
        change(&mut renderer, &near(), Vec3::ZERO);
        let (back, ..) = frame(&renderer, "the camera moves back");
        assert_same(&back, &first, settings);

        change(&mut renderer, &near(), Vec3::new(0.1, 0.0, 0.2));
        let (_, maps, drawn) = frame(&renderer, "the light moves");
        assert_eq!(drawn, maps, "{settings}: maps drawn as the light moves");
        renderer.frame.static_casters = false;
        let (_, maps, drawn) = frame(&renderer, "casters move");
        assert_eq!(drawn, maps, "{settings}: maps drawn as casters move");
    }
}

#[test]
fn fixed_samples_of_resting_casters_are_drawn_once() {
    for (way, keeps) in [("array", true), ("accumulate", false)] {
        let spec = format!("uniform-sampling:map=128,samples=16,evaluation={way}");
        let mut renderer = resting();
        let mut kept = technique(&spec);
        let mut frame = |renderer: &SceneRenderer, what: &str| {
            let found = visibility(renderer, &mut kept);
            let is_drawn = stat(&kept, "maps drawn") > 0;
            assert_same(&found, &fresh(renderer, &spec), &format!("{way}: {what}, a used instance and a new one"));
            is_drawn
        };
        assert!(frame(&renderer, "the first frame"));
        assert_eq!(frame(&renderer, "nothing moves"), !keeps, "{way}: maps drawn where nothing moves");
        change(&mut renderer, &aside(), Vec3::ZERO);
        assert_eq!(frame(&renderer, "the camera moves"), !keeps, "{way}: maps drawn as the camera moves");
        change(&mut renderer, &near(), Vec3::new(0.1, 0.0, 0.2));
        assert!(frame(&renderer, "the light moves"), "{way}: no maps drawn as the light moves");
        renderer.frame.static_casters = false;
        assert!(frame(&renderer, "casters move"), "{way}: no maps drawn as casters move");
    }
}

#[test]
fn a_used_instance_follows_the_light_s_shape_and_other_casters() {
    let size = Vec2::new(0.9, 0.7);
    for spec in [
        "adaptive-sampling:map=64,depth=2",
        "adaptive-sampling:map=64,depth=2,filter=pcf",
        "uniform-sampling:map=64,samples=9",
        "uniform-sampling:map=64,samples=9,pattern=regular,evaluation=accumulate",
    ] {
        let mut renderer = resting();
        let mut kept = technique(spec);
        for other in [size, Vec2::new(0.9, 0.0), Vec2::new(0.0, 0.7), Vec2::ZERO, size, Vec2::new(0.7, 0.9)] {
            renderer.frame.light.size = other;
            change(&mut renderer, &near(), Vec3::ZERO);
            let (by_kept, by_new) = (visibility(&renderer, &mut kept), fresh(&renderer, spec));
            assert_same(&by_kept, &by_new, &format!("{spec}, a light of {other} m"));
        }
        // As many triangles, at another place.
        let mut moved = hovering(size);
        moved.meshes[1] = cuboid([-0.3, 0.9, -0.3], [0.6, 1.2, 0.35]);
        let before = visibility(&renderer, &mut kept);
        renderer.frame.casters = Arc::new(upload(gpu(), &moved).unwrap_or_else(|e| panic!("{e}")));
        change(&mut renderer, &near(), Vec3::ZERO);
        let after = visibility(&renderer, &mut kept);
        assert!(after != before, "{spec}: the moved box casts the same shadow");
        assert_same(&after, &fresh(&renderer, spec), &format!("{spec}, other casters"));
    }
}
