//! Every importer, on files that are built here byte by byte.

mod far;
mod framing;
mod glb;
mod gltf;
mod gltf_bad;
mod gltf_casts;
mod load;
mod log;
mod mtl;
mod obj;
mod ply;
mod scene_file;
mod text;

use antumbra_scene::SceneError;
use antumbra_scene::import::Model;
use glam::Vec3;

/// Stands for a disk without files.
fn no_files(path: &str) -> std::io::Result<Vec<u8>> {
    Err(std::io::Error::new(std::io::ErrorKind::NotFound, format!("no {path} here")))
}

/// World-space triangles of a model, in the file's order.
fn triangles(model: &Model) -> Vec<[Vec3; 3]> {
    let of_instance = |i: &antumbra_scene::Instance| {
        let (mesh, place) = (&model.meshes[i.mesh], i.world_from_object);
        let corner = move |k: u32| place.transform_point3(mesh.positions[k as usize]);
        mesh.indices.chunks(3).map(|t| [corner(t[0]), corner(t[1]), corner(t[2])]).collect::<Vec<_>>()
    };
    model.instances.iter().flat_map(of_instance).collect()
}

/// Area of all triangles, by which a wrong triangulation shows.
fn area(model: &Model) -> f32 {
    triangles(model).iter().map(|[a, b, c]| 0.5 * (b - a).cross(c - a).length()).sum()
}

/// The message of an error, which must hold every one of `parts`.
#[track_caller]
fn assert_says<T: std::fmt::Debug>(result: Result<T, SceneError>, parts: &[&str]) {
    let message = result.expect_err("this should be refused").to_string();
    for part in parts {
        assert!(message.contains(part), "{part:?} is not in {message:?}");
    }
}

/// A picture as a file.
fn png(picture: image::RgbaImage) -> Vec<u8> {
    let mut bytes = Vec::new();
    picture.write_to(&mut std::io::Cursor::new(&mut bytes), image::ImageFormat::Png).unwrap();
    bytes
}

/// Asserts that there is one message for each list of parts, which it holds, in this order.
#[track_caller]
fn assert_logged(messages: &[String], expected: &[&[&str]]) {
    assert_eq!(messages.len(), expected.len(), "{messages:#?}");
    for (message, parts) in messages.iter().zip(expected) {
        parts.iter().for_each(|part| assert!(message.contains(part), "{part:?} is not in {message:?}"));
    }
}
