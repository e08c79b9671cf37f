//! Scene files.

use crate::assert_says;
use antumbra_scene::import::Model;
use antumbra_scene::scene_file::{Format, parse};
use antumbra_scene::{Instance, Mesh, Scene, SceneError};
use glam::{Affine3A, Vec2, Vec3, vec3};
use proptest::prelude::*;

/// The triangle (0 0 0) (1 0 0) (0 1 0) for every path but one.
fn models(path: &str) -> Result<Model, SceneError> {
    if path == "bad.obj" {
        return Err(SceneError::NoTriangles { file: path.to_string(), advice: String::new() });
    }
    let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
    let mesh = Mesh { name: path.to_string(), positions, indices: vec![0, 1, 2], ..Mesh::default() };
    let instance = Instance { mesh: 0, world_from_object: Affine3A::IDENTITY, receiver_only: false };
    Ok(Model { meshes: vec![mesh], materials: vec![Default::default()], instances: vec![instance], ..Model::default() })
}

fn toml(text: &str) -> Result<Scene, SceneError> {
    parse(text.as_bytes(), Format::Toml, "s.toml", &mut models)
}

fn json(text: &str) -> Result<Scene, SceneError> {
    parse(text.as_bytes(), Format::Json, "s.json", &mut models)
}

const WHOLE: &str = r#"
width = 640
height = 480
[[meshes]]
path = "a.obj"
translate = [1, 2, 3]
rotate_deg = [90, 90, 0]
scale = [1, 2, 3]
receiver_only = true
[[meshes]]
builtin = "plane"
scale = 4
[camera]
eye = [0, 1, 5]
target = [0, 0.5, 0]
up = [0, 1, 0]
fov_y_deg = 60
near = 0.5
far = 50
[light]
center = [0, 6, 0]
target = [0, 0, 0]
up = [0, 0, -1]
size = [1, 0]
shadow_fov_deg = 50
"#;

#[test]
fn every_key_is_read() {
    let scene = toml(WHOLE).unwrap();
    assert_eq!(scene.size, Some((640, 480)));
    let (camera, light) = (&scene.camera, &scene.light);
    assert_eq!((camera.eye, camera.fov_y_deg, camera.near, camera.far), (vec3(0.0, 1.0, 5.0), 60.0, 0.5, 50.0));
    assert_eq!((light.size, light.up, light.shadow_fov_deg), (Vec2::X, Vec3::NEG_Z, Some(50.0)));
    assert_eq!(scene.instances.len(), 2);
    assert!(scene.instances[0].receiver_only && !scene.instances[1].receiver_only);
    // Scaled to (0 2 0), turned about x to (0 0 2), about y to (2 0 0), then moved.
    let corner = scene.instances[0].world_from_object.transform_point3(Vec3::Y);
    assert!(corner.distance(vec3(3.0, 2.0, 3.0)) < 1e-5, "{corner}");
    let plane = scene.bounds_of(|i| !i.receiver_only);
    assert_eq!((plane.min, plane.max), (vec3(-4.0, 0.0, -4.0), vec3(4.0, 0.0, 4.0)));
}

/// A near plane that is a part of the farthest distance cuts off all that is near.
#[test]
fn a_far_horizon_does_not_move_the_near_plane() {
    let scene = |scale: f32| {
        let text = format!(
            "[[meshes]]\npath = \"a.obj\"\n[[meshes]]\nbuiltin = \"plane\"\nscale = {scale:.1}\nreceiver_only = true\n\
             [camera]\neye = [1.5, 1.8, 2.0]\ntarget = [0, 0.2, 0]\n"
        );
        toml(&text).unwrap()
    };
    let [near, far] = [10.0, 100_000.0].map(|scale| scene(scale).camera.near);
    assert_eq!(near, far);
    assert!(far < 0.5, "{far}");
}

#[test]
fn json_says_the_same() {
    let text = r#"{"width": 640, "height": 480,
        "meshes": [{"path": "a.obj", "translate": [1, 2, 3], "rotate_deg": [90, 90, 0], "scale": [1, 2, 3],
                    "receiver_only": true}, {"builtin": "plane", "scale": 4}],
        "camera": {"eye": [0, 1, 5], "target": [0, 0.5, 0], "up": [0, 1, 0], "fov_y_deg": 60, "near": 0.5, "far": 50},
        "light": {"center": [0, 6, 0], "target": [0, 0, 0], "up": [0, 0, -1], "size": [1, 0], "shadow_fov_deg": 50}}"#;
    let (json, toml) = (json(text).unwrap(), toml(WHOLE).unwrap());
    assert_eq!(Scene { name: String::new(), ..json }, Scene { name: String::new(), ..toml });
}

#[test]
fn camera_and_light_may_be_left_out() {
    let scene = toml("[[meshes]]\npath = \"a.obj\"\n").unwrap();
    assert_eq!(scene.instances.len(), 1, "no ground is added to a scene file");
    assert!(scene.camera.near > 0.0 && scene.camera.far.is_finite() && scene.light.center.y > 1.0);
    let name = antumbra_scene::builtin::list()[0].name;
    let own = antumbra_scene::builtin::build(name).unwrap();
    let scene = toml(&format!("[[meshes]]\nbuiltin = \"{name}\"\n")).unwrap();
    assert_eq!((scene.camera, scene.light), (own.camera, own.light), "a built-in scene brings its own");
    assert_eq!(scene.triangle_count(), own.triangle_count());
}

#[test]
fn a_mesh_that_is_placed_twice_is_kept_once() {
    let scene = toml("[[meshes]]\npath = \"a.obj\"\n[[meshes]]\npath = \"a.obj\"\ntranslate = [2, 0, 0]\n").unwrap();
    assert_eq!((scene.meshes.len(), scene.instances.len()), (1, 2));
    assert_eq!(scene.bounds().max.x, 3.0);
}

#[test]
fn an_unknown_key_is_answered_with_the_nearest() {
    assert_says(
        toml(&WHOLE.replace("fov_y_deg", "fovy_deg")),
        &["s.toml, line 17", "`fovy_deg`", "did you mean `fov_y_deg`?"],
    );
    assert_says(toml(&WHOLE.replace("translate", "Translate")), &["line 6", "did you mean `translate`?"]);
    assert_says(toml(&WHOLE.replace("[camera]", "[kamera]")), &["`kamera`", "did you mean `camera`?"]);
    assert_says(toml(&WHOLE.replace("width", "zzz")), &["no key `zzz` here (known: width, height, meshes"]);
    assert_says(json("{\"meshes\": [\n{\"pth\": 1}]}"), &["s.json, line 2", "did you mean `path`?"]);
}

#[test]
fn values_are_checked() {
    for (from, to, parts) in [
        ("width = 640", "width = 0", ["width", "at least 1"]),
        ("width = 640", "", ["width", "missing"]),
        ("width = 640", "width = -3", ["line 2", "-3"]),
        ("width = 640", "width = \"wide\"", ["line 2", "u32"]),
        ("eye = [0, 1, 5]", "eye = [0, 0.5, 0]", ["camera.target", "same point as eye"]),
        ("eye = [0, 1, 5]", "eye = [0, nan, 0]", ["camera.eye", "finite"]),
        ("eye = [0, 1, 5]", "eye = [0, 1]", ["line 14", "length 2"]),
        ("eye = [0, 1, 5]", "", ["line 13", "missing field `eye`"]),
        ("up = [0, 1, 0]", "up = [0, 0.5, 5]", ["camera.up", "parallel"]),
        ("up = [0, 1, 0]", "up = [0, 0, 0]", ["camera.up", "zero"]),
        ("fov_y_deg = 60", "fov_y_deg = 180", ["camera.fov_y_deg", "below 180"]),
        ("near = 0.5", "near = 0", ["camera.near", "above 0"]),
        ("far = 50", "far = 0.5", ["camera.far", "above near"]),
        ("size = [1, 0]", "size = [1, -1]", ["light.size", "below 0"]),
        ("size = [1, 0]", "size = [1, inf]", ["light.size", "finite"]),
        ("shadow_fov_deg = 50", "shadow_fov_deg = 0", ["light.shadow_fov_deg", "above 0"]),
        ("up = [0, 0, -1]", "up = [0, 1, 0]", ["light.up", "parallel"]),
        ("scale = 4", "scale = 0", ["meshes[1].scale", "not be 0"]),
        ("scale = 4", "scale = [1, 2]", ["line 12", "three numbers"]),
        ("scale = 4", "scale = [1, 2, 3, 4]", ["line 12", "three numbers"]),
        ("scale = 4", "scale = \"big\"", ["line 12", "three numbers"]),
        ("translate = [1, 2, 3]", "translate = [1, 2, inf]", ["meshes[0].translate", "finite"]),
        ("translate = [1, 2, 3]", "translate = [1, 2, 1e12]", ["a.obj", "scale the model down"]),
        ("builtin = \"plane\"", "", ["meshes[1]", "`path` or `builtin`"]),
        ("builtin = \"plane\"", "builtin = \"plane\"\npath = \"b.obj\"", ["meshes[1]", "`path` or `builtin`"]),
        ("builtin = \"plane\"", "builtin = \"nowhere\"", ["builtin:nowhere", "nowhere"]),
        ("\"a.obj\"", "\"bad.obj\"", ["bad.obj", "no triangles"]),
        ("[camera]", "[camera", ["line 13", "]"]),
    ] {
        let text = WHOLE.replacen(from, to, 1);
        assert_ne!(text, WHOLE, "{from}");
        assert_says(toml(&text), &parts);
    }
    assert_says(toml("meshes = []"), &["s.toml", "no triangles"]);
    assert_says(toml(""), &["s.toml", "missing field `meshes`"]);
    assert_says(json("{\"meshes\": [}"), &["s.json, line 1"]);
    assert_says(parse(b"a = \xff", Format::Toml, "s.toml", &mut models), &["byte 4", "UTF-8"]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    #[test]
    fn flipped_bytes_never_panic(flips in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..5)) {
        let mut bytes = WHOLE.as_bytes().to_vec();
        for (at, value) in flips {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        let _ = parse(&bytes, Format::Toml, "flipped.toml", &mut models);
    }
}
