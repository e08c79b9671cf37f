//! Every importer, on files that are built here byte by byte.

mod framing;
mod glb;
mod gltf;
mod gltf_bad;
mod load;
mod obj;
mod ply;
mod scene_file;

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
