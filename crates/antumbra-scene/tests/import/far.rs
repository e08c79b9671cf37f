//! Models far from the origin.

use crate::glb::Builder;
use crate::log::logged;
use crate::{assert_logged, assert_says, no_files, triangles};
use antumbra_scene::import::{Model, gltf, obj, ply};
use antumbra_scene::scene_file::{self, Format};
use antumbra_scene::{Scene, SceneError, load_placed};
use glam::{DVec3, Vec3, dvec3, vec3};
use serde_json::json;

/// Where maps of Central Italy put it.
const ITALY: DVec3 = dvec3(500_000.0, 0.0, 4_649_776.0);

/// A tetrahedron whose corners are no round numbers.
const CORNERS: [DVec3; 4] =
    [dvec3(-0.263, 0.074, 0.5), dvec3(0.5, 0.0625, -0.263), dvec3(0.0, 0.0703125, -0.426), dvec3(0.1, 1.125, 0.1)];
const FACES: [[usize; 3]; 4] = [[0, 1, 2], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

fn obj_at(origin: DVec3) -> String {
    let mut text: String = CORNERS.iter().map(|c| c + origin).map(|c| format!("v {} {} {}\n", c.x, c.y, c.z)).collect();
    FACES.iter().for_each(|f| text += &format!("f {} {} {}\n", f[0] + 1, f[1] + 1, f[2] + 1));
    text
}

fn ply_at(origin: DVec3) -> Vec<u8> {
    let axes = ["x", "y", "z"].map(|a| format!("property double {a}\n")).concat();
    let mut file = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex 4\n{axes}element face 4\n\
         property list uchar int vertex_index\nend_header\n"
    )
    .into_bytes();
    CORNERS.iter().for_each(|c| file.extend((c + origin).to_array().iter().flat_map(|x| x.to_le_bytes())));
    for face in FACES {
        file.push(3);
        face.iter().for_each(|&i| file.extend((i as i32).to_le_bytes()));
    }
    file
}

/// Node 0 stands at `origin` and has the tetrahedron as a child.
fn gltf_at(origin: DVec3) -> Builder {
    let mut file = Builder::new();
    let corners: Vec<f32> = FACES.iter().flatten().flat_map(|&i| CORNERS[i].as_vec3().to_array()).collect();
    let positions = file.floats(&corners, "VEC3");
    file.show(json!({"attributes": {"POSITION": positions}}));
    file.add("nodes", json!({"children": [0], "translation": origin.to_array()}));
    file
}

fn read_obj(origin: DVec3) -> Model {
    obj::parse(obj_at(origin).as_bytes(), "a.obj", &mut no_files).unwrap()
}

/// The greatest distance between corners of the same triangles, in metres.
fn difference(a: &[[Vec3; 3]], b: &[[Vec3; 3]]) -> f32 {
    assert_eq!(a.len(), b.len());
    a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
}

#[test]
fn a_georeferenced_model_keeps_its_shape() {
    let near = triangles(&read_obj(DVec3::ZERO));
    let models = [
        read_obj(ITALY),
        ply::parse(&ply_at(ITALY), "a.ply").unwrap(),
        gltf::parse(&gltf_at(ITALY).glb(), "a.glb", &mut no_files).unwrap(),
    ];
    for model in models {
        assert_eq!(model.origin, ITALY, "{}: y stays, and the offset is round", model.name);
        let error = difference(&triangles(&model), &near);
        assert!(error < 1e-6, "{}: a corner is off by {error} m", model.name);
        let name = model.name.clone();
        let (scene, said) = logged(|| model.into_scene());
        assert_logged(&said, &[&[&name, "moved by (-500000, 0, -4649776) metres"]]);
        assert_eq!(scene.camera, read_obj(DVec3::ZERO).into_scene().camera, "{name} is seen as it is near the origin");
    }
}

#[test]
fn parts_of_a_gltf_file_are_placed_in_double_precision() {
    let mut file = gltf_at(ITALY + dvec3(0.3, 0.0, 0.2));
    let second = file.add("nodes", json!({"mesh": 0, "translation": (ITALY + dvec3(2.0, 0.0, 0.0)).to_array()}));
    file.add("cameras", json!({"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.5}}));
    file.json["nodes"][second]["camera"] = 0.into();
    let model = gltf::parse(&file.glb(), "a.glb", &mut no_files).unwrap();
    let all = triangles(&model);
    let apart = all[4][0] - all[0][0];
    assert!(apart.distance(vec3(1.7, 0.0, -0.2)) < 1e-6, "{apart}");
    let eye = model.camera.unwrap().eye;
    let corner = all[4][0] - eye;
    assert!(corner.distance(CORNERS[0].as_vec3()) < 1e-6, "the camera moves along: {corner}");
}

#[test]
fn a_model_with_digits_enough_stays() {
    // 1 m at 1 km: single precision leaves 4.2 digits.
    let (model, said) = logged(|| read_obj(dvec3(1000.0, 0.0, -1000.0)));
    assert_eq!(model.origin, DVec3::ZERO);
    let (scene, said_later) = logged(|| model.into_scene());
    assert_eq!((said, said_later), (vec![], vec![]));
    assert!(scene.bounds().max.x > 1000.0);
}

fn scene(text: &str) -> (Result<Scene, SceneError>, Vec<String>) {
    let mut load = |path: &str| match path {
        "italy.obj" => Ok(read_obj(ITALY)),
        "far.obj" => Ok(read_obj(dvec3(131_000.0, 0.0, 0.0))),
        _ => Ok(read_obj(DVec3::ZERO)),
    };
    logged(|| scene_file::parse(text.as_bytes(), Format::Toml, "s.toml", &mut load))
}

fn corners(scene: &Scene) -> Vec<[Vec3; 3]> {
    let Scene { meshes, instances, .. } = scene.clone();
    triangles(&Model { meshes, instances, ..Model::default() })
}

const VIEW: &str = "[camera]\neye = [X1.3, 1.7, Z2.9]\ntarget = [X0.2, 0.45, Z0]\n\
    [light]\ncenter = [X-1.8, 3.2, Z1]\ntarget = [X0, 0.5, Z0]\nsize = [0.5, 0.5]\n";

/// [`VIEW`] with an offset along x and z.
fn view(offset: DVec3) -> String {
    let shift = |text: &str, letter: char, by: f64| {
        let mut parts = text.split(letter);
        let mut out = parts.next().unwrap().to_string();
        for part in parts {
            let end = part.find([',', ']']).unwrap();
            out += &format!("{}{}", part[..end].parse::<f64>().unwrap() + by, &part[end..]);
        }
        out
    };
    shift(&shift(VIEW, 'X', offset.x), 'Z', offset.z)
}

#[test]
fn a_scene_file_moves_models_camera_and_light_together() {
    let meshes = "[[meshes]]\npath = \"PATH\"\n[[meshes]]\nbuiltin = \"plane\"\nscale = 10\ntranslate = [AT]\n";
    let near = meshes.replace("PATH", "near.obj").replace("AT", "0, 0, 0") + &view(DVec3::ZERO);
    let far = meshes.replace("PATH", "italy.obj").replace("AT", "500000, 0, 4649776") + &view(ITALY);
    let (near, far) = (scene(&near), scene(&far));
    assert_eq!(near.1, [""; 0]);
    assert_logged(&far.1, &[&["s.toml", "moved by"]]);
    let (near, far) = (near.0.unwrap(), far.0.unwrap());
    let moved = far.camera.eye - near.camera.eye;
    let moved_back: Vec<_> = corners(&far).into_iter().map(|t| t.map(|p| p - moved)).collect();
    assert!(difference(&moved_back, &corners(&near)) < 1e-5);
    assert!((far.camera.target - near.camera.target).distance(moved) < 1e-5);
    assert!((far.light.center - near.light.center).distance(moved) < 1e-5);
    assert!((far.light.target - near.light.target).distance(moved) < 1e-5);
}

#[test]
fn a_scene_file_may_bring_a_georeferenced_model_to_the_origin() {
    let text =
        "[[meshes]]\npath = \"italy.obj\"\ntranslate = [-500000, 0, -4649776]\n".to_string() + &view(DVec3::ZERO);
    let (scene, said) = scene(&text);
    let scene = scene.unwrap();
    assert_eq!(said, [""; 0]);
    assert!(difference(&corners(&scene), &triangles(&read_obj(DVec3::ZERO))) < 1e-6);
    assert_eq!(scene.camera.eye, vec3(1.3, 1.7, 2.9), "the camera stays where the file puts it");
}

#[test]
fn a_scene_that_is_far_after_all_says_how_many_digits_are_left() {
    let text = "[[meshes]]\npath = \"near.obj\"\n[[meshes]]\npath = \"near.obj\"\ntranslate = [131000, 0, 0]\n";
    let (result, said) = scene(text);
    assert!(result.is_ok());
    assert_logged(&said, &[&["s.toml, mesh \"a.obj\"", "leaves 2.3 digits"]]);
    // A model that is far in its own file, beside one that is not.
    let (_, said) = scene(&format!("{text}[[meshes]]\npath = \"far.obj\"\n"));
    assert_logged(&said, &[&["s.toml, 2 places, the first is mesh \"a.obj\"", "digits"]]);
}

#[test]
fn a_view_keeps_its_direction() {
    let text = "[[meshes]]\npath = \"near.obj\"\n[camera]\neye = [131000.001, 0, 0]\ntarget = [131000, 0, 0]\n";
    assert_says(scene(text).0, &["camera.target", "same point as eye in single precision"]);
    let light = "center = [131000, 0, 0.001]\ntarget = [131000, 0, 0]\nsize = [1, 1]\n";
    let text = format!("[[meshes]]\npath = \"near.obj\"\n[light]\n{light}");
    assert!(scene(&text).0.is_ok(), "0.001 is apart from 0");
}

#[test]
fn a_loaded_scene_says_where_its_origin_is() {
    let mut disk = |path: &std::path::Path| match path.to_str().unwrap_or_default() {
        "a.obj" => Ok(obj_at(ITALY).into_bytes()),
        "s.toml" => Ok(b"[[meshes]]\npath = \"a.obj\"\ntranslate = [0, 0, 1000]\n".to_vec()),
        other => no_files(other),
    };
    assert_eq!(load_placed("a.obj", &mut disk).unwrap().1, ITALY);
    assert_eq!(load_placed("s.toml", &mut disk).unwrap().1, ITALY + dvec3(0.0, 0.0, 1000.0));
    assert_eq!(load_placed("builtin:square", &mut disk).unwrap().1, DVec3::ZERO);
}
