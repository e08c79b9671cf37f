//! What glTF files may hold.

use crate::glb::{Builder, I16, U8, U16, U32, float_bytes};
use crate::{area, no_files, triangles};
use antumbra_scene::import::{Model, gltf};
use antumbra_scene::{SceneError, Wrap};
use glam::{Vec2, Vec3, vec2, vec3};
use serde_json::{Value, json};

fn parse(file: &Builder) -> Result<Model, SceneError> {
    gltf::parse(&file.glb(), "test.glb", &mut no_files)
}

fn read(file: &Builder) -> Model {
    parse(file).unwrap()
}

const SQUARE: [f32; 12] = [0., 0., 0., 1., 0., 0., 0., 1., 0., 1., 1., 0.];

/// The unit square with a primitive's other keys.
fn square(file: &mut Builder, mut primitive: Value) -> Value {
    primitive["attributes"]["POSITION"] = file.floats(&SQUARE, "VEC3").into();
    primitive
}

#[test]
fn indices_of_every_type_and_none() {
    let plain = triangles(&read(&Builder::triangle()));
    assert_eq!(plain, [[Vec3::ZERO, Vec3::X, Vec3::Y]]);
    let wide: Vec<u8> = [0u32, 1, 2].iter().flat_map(|i| i.to_le_bytes()).collect();
    for (component, bytes) in [(U8, &[0, 1, 2][..]), (U16, &[0, 0, 1, 0, 2, 0]), (U32, &wide)] {
        let mut file = Builder::triangle();
        file.json["meshes"][0]["primitives"][0]["indices"] = file.accessor(bytes, component, "SCALAR", 3).into();
        assert_eq!(triangles(&read(&file)), plain, "component type {component}");
    }
}

#[test]
fn strips_and_fans_keep_the_winding() {
    let mut file = Builder::new();
    let strip = square(&mut file, json!({"mode": 5}));
    file.show(strip);
    let strip = read(&file);
    assert_eq!(area(&strip), 1.0);
    assert!(triangles(&strip).iter().all(|[a, b, c]| (b - a).cross(c - a).z > 0.0));

    let mut file = Builder::new();
    let fan = file.floats(&[0., 0., 0., 1., 0., 0., 1., 1., 0., 0., 1., 0.], "VEC3");
    file.show(json!({"attributes": {"POSITION": fan}, "mode": 6}));
    let fan = read(&file);
    assert_eq!(area(&fan), 1.0);
    assert!(triangles(&fan).iter().all(|[a, b, c]| (b - a).cross(c - a).z > 0.0));
}

#[test]
fn points_and_lines_are_left_out() {
    for mode in 0..4 {
        let mut file = Builder::triangle();
        let points = square(&mut file, json!({"mode": mode}));
        file.show(points);
        assert_eq!(triangles(&read(&file)).len(), 1);
        file.json["meshes"][0]["primitives"][0]["mode"] = mode.into();
        assert!(matches!(parse(&file), Err(SceneError::NoTriangles { .. })));
    }
}

#[test]
fn nodes_pass_their_transforms_on() {
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let mut file = Builder::triangle();
    file.json["nodes"] = json!([
        {"translation": [10, 0, 0], "scale": [2, 2, 2], "children": [1, 2]},
        {"mesh": 0, "rotation": [0.0, 0.0, half, half]},
        {"mesh": 0, "matrix": [-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,5,1]},
    ]);
    let model = read(&file);
    let all = triangles(&model);
    assert!(all[0][1].distance(vec3(10.0, 2.0, 0.0)) < 1e-5, "a quarter turn takes x to y");
    assert_eq!(all[1][1], vec3(8.0, 0.0, 10.0));
    assert!(model.instances[1].world_from_object.matrix3.determinant() < 0.0, "it mirrors");
    assert_eq!((model.meshes.len(), model.instances.len()), (1, 2), "a mesh that is shown twice is kept once");
}

#[test]
fn the_default_scene_is_shown() {
    let mut file = Builder::triangle();
    file.add("nodes", json!({"mesh": 0, "translation": [5, 0, 0]}));
    assert_eq!(read(&file).instances.len(), 2, "without scenes all roots are shown");
    file.json["scenes"] = json!([{"nodes": [0, 1]}, {"nodes": [1]}]);
    assert_eq!(read(&file).instances.len(), 2, "without a default it is the first scene");
    file.json["scene"] = 1.into();
    assert_eq!(triangles(&read(&file))[0][0], vec3(5.0, 0.0, 0.0));
}

#[test]
fn sparse_accessors_replace_elements() {
    for based in [true, false] {
        let mut file = Builder::triangle();
        let numbers = file.view(&[1, 2]);
        let values = file.view(&float_bytes(&[7., 0., 0., 0., 8., 0.]));
        let accessor = &mut file.json["accessors"][0];
        accessor["sparse"] = json!({
            "count": 2, "indices": {"bufferView": numbers, "componentType": U8}, "values": {"bufferView": values},
        });
        if !based {
            accessor.as_object_mut().unwrap().remove("bufferView");
        }
        assert_eq!(triangles(&read(&file)), [[Vec3::ZERO, vec3(7.0, 0.0, 0.0), vec3(0.0, 8.0, 0.0)]]);
    }
}

#[test]
fn quantised_and_interleaved_positions() {
    let mut file = Builder::new();
    let short: Vec<u8> =
        [0i16, 0, 0, 0, 32767, 0, 0, 0, 0, -32768, 0, 0].iter().flat_map(|i| i.to_le_bytes()).collect();
    let view = file.view(&short);
    file.json["bufferViews"][view]["byteStride"] = 8.into();
    let accessor = json!({"bufferView": view, "componentType": I16, "type": "VEC3", "count": 3, "normalized": true});
    let positions = file.add("accessors", accessor);
    file.show(json!({"attributes": {"POSITION": positions}}));
    file.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    assert_eq!(triangles(&read(&file)), [[Vec3::ZERO, Vec3::X, Vec3::NEG_Y]]);
}

#[test]
fn few_triangles_of_a_large_buffer_keep_few_vertices() {
    let mut file = Builder::new();
    let many: Vec<f32> = (0..3000).map(|i| i as f32).collect();
    let positions = file.floats(&many, "VEC3");
    let indices = file.accessor(&[0, 0, 9, 0, 200, 1], U16, "SCALAR", 3);
    file.show(json!({"attributes": {"POSITION": positions}, "indices": indices}));
    let model = read(&file);
    assert_eq!(model.meshes[0].positions.len(), 3);
    assert_eq!(model.meshes[0].positions[1], vec3(27.0, 28.0, 29.0));
}

#[test]
fn the_first_perspective_camera_counts() {
    let mut file = Builder::triangle();
    file.json["cameras"] = json!([
        {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "zfar": 9, "znear": 1}},
        {"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.5}},
    ]);
    file.add("nodes", json!({"camera": 0}));
    assert!(read(&file).camera.is_none(), "an orthographic camera is left out");
    file.add("nodes", json!({"camera": 1, "translation": [0, 0, 8], "scale": [3, 3, 3]}));
    let camera = read(&file).camera.unwrap();
    assert_eq!((camera.eye, camera.up, camera.near), (vec3(0.0, 0.0, 8.0), Vec3::Y, 0.5));
    assert!((camera.target - Vec3::ZERO).length() < 1e-5, "the target is at the scene's depth");
    assert!((camera.fov_y_deg - 57.29578).abs() < 1e-4);
    let scene = read(&file).into_scene();
    assert!(scene.camera.far.is_finite(), "a far plane that the file leaves out is fitted");
    assert_eq!(scene.instances.len(), 1, "a file with a camera gets no ground");
}

#[test]
fn lights_become_rectangles() {
    let light_of = |kind: &str, node: Value| {
        let mut file = Builder::triangle();
        file.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [{"type": kind, "spot": {}}]}});
        file.json["extensionsUsed"] = json!(["KHR_lights_punctual"]);
        let number = file.add("nodes", node);
        file.json["nodes"][number]["extensions"] = json!({"KHR_lights_punctual": {"light": 0}});
        read(&file).light.unwrap()
    };
    let middle = vec3(0.5, 0.5, 0.0);
    let spot = light_of("spot", json!({"translation": [0.5, 0.5, 10]}));
    assert_eq!((spot.center, spot.target), (vec3(0.5, 0.5, 10.0), middle));
    assert_eq!(spot.size, Vec2::splat(0.5), "the edge is 1/20 of the distance");
    let sun = light_of("directional", json!({"translation": [99, 0, 0]}));
    assert_eq!(sun.target, middle);
    assert!(sun.center.z > 1.0 && sun.center.x == 0.5, "it stands outside, against its direction");
    let bulb = light_of("point", json!({"translation": [0.5, 4.5, 0]}));
    assert_eq!((bulb.center, bulb.target), (vec3(0.5, 4.5, 0.0), middle));
    let (_, _, normal) = bulb.basis();
    assert_eq!(normal, Vec3::NEG_Y);
}

/// Half transparent pixels around one opaque.
fn png() -> Vec<u8> {
    let mut picture = image::RgbaImage::from_pixel(2, 2, image::Rgba([10, 20, 30, 40]));
    picture.put_pixel(1, 0, image::Rgba([200, 100, 50, 255]));
    let mut bytes = Vec::new();
    picture.write_to(&mut std::io::Cursor::new(&mut bytes), image::ImageFormat::Png).unwrap();
    bytes
}

/// A textured triangle.
fn textured() -> Builder {
    let mut file = Builder::triangle();
    let view = file.view(&png());
    file.add("images", json!({"bufferView": view, "mimeType": "image/png"}));
    file.add("samplers", json!({"wrapS": 33071, "wrapT": 33648, "magFilter": 9728}));
    file.add("textures", json!({"source": 0, "sampler": 0}));
    file.add(
        "materials",
        json!({
            "pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 0.25, 1], "baseColorTexture": {"index": 0}},
            "alphaMode": "MASK", "alphaCutoff": 0.75, "doubleSided": true,
        }),
    );
    let uvs = file.floats(&[0., 0., 1., 0., 0., 1.], "VEC2");
    let other = file.accessor(&[0, 0, 255, 0, 0, 255, 255, 255], U8, "VEC2", 3);
    file.json["accessors"][other]["normalized"] = true.into();
    let view = file.json["accessors"][other]["bufferView"].as_u64().unwrap() as usize;
    file.json["bufferViews"][view]["byteLength"] = 8.into();
    let primitive = &mut file.json["meshes"][0]["primitives"][0];
    primitive["material"] = 0.into();
    primitive["attributes"]["TEXCOORD_0"] = uvs.into();
    primitive["attributes"]["TEXCOORD_1"] = other.into();
    file
}

#[test]
fn materials_and_textures() {
    let model = read(&textured());
    let material = &model.materials[model.meshes[0].material];
    let texture = material.texture.as_ref().unwrap();
    assert_eq!(material.base_color.to_array(), [1.0, 0.5, 0.25, 1.0]);
    assert_eq!((material.alpha_cutoff, material.double_sided), (Some(0.75), true));
    assert_eq!((texture.width, texture.height, texture.nearest), (2, 2, true));
    assert_eq!(texture.wrap, [Wrap::Clamp, Wrap::Mirror]);
    assert_eq!(texture.rgba[4..8], [200, 100, 50, 255]);
    assert_eq!(model.meshes[0].uvs, [vec2(0.0, 0.0), vec2(1.0, 0.0), vec2(0.0, 1.0)]);
}

#[test]
fn blending_is_masking_at_one_half() {
    let mut file = textured();
    file.json["materials"][0]["alphaMode"] = "BLEND".into();
    assert_eq!(read(&file).materials[0].alpha_cutoff, Some(0.5));
    file.json["materials"][0]["alphaMode"] = "OPAQUE".into();
    assert_eq!(read(&file).materials[0].alpha_cutoff, None);
    file.json["materials"][0]["alphaMode"] = "MASK".into();
    file.json["materials"][0]["alphaCutoff"] = 0.1.into();
    assert_eq!(read(&file).materials[0].alpha_cutoff, None, "a mask that cuts nothing is forgotten");
}

#[test]
fn texture_coordinates_follow_the_material() {
    let mut file = textured();
    let info = &mut file.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"];
    info["texCoord"] = 1.into();
    assert_eq!(read(&file).meshes[0].uvs, [vec2(0.0, 0.0), vec2(1.0, 0.0), vec2(0.0, 1.0)]);
    let info = &mut file.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"];
    info["extensions"] = json!({"KHR_texture_transform": {
        "offset": [0.5, 0.25], "scale": [2, 4], "rotation": std::f32::consts::FRAC_PI_2, "texCoord": 0,
    }});
    let uvs = &read(&file).meshes[0].uvs;
    for (uv, expected) in uvs.iter().zip([vec2(0.5, 0.25), vec2(0.5, -1.75), vec2(4.5, 0.25)]) {
        assert!(uv.distance(expected) < 1e-5, "{uv} {expected}");
    }
}

#[test]
fn a_texture_without_coordinates_is_left_out() {
    let mut file = textured();
    file.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = 5.into();
    let model = read(&file);
    let material = &model.materials[model.meshes[0].material];
    assert!(material.texture.is_none() && model.meshes[0].uvs.is_empty());
    assert_eq!(material.base_color.x, 1.0);
}

#[test]
fn buffers_may_be_elsewhere() {
    let file = Builder::triangle();
    let expected = triangles(&read(&file));
    let mut asked = Vec::new();
    let text = file.gltf("some%20where/a.bin");
    let mut disk = |path: &str| {
        asked.push(path.to_string());
        Ok(file.bytes.clone())
    };
    assert_eq!(triangles(&gltf::parse(&text, "a.gltf", &mut disk).unwrap()), expected);
    assert_eq!(asked, ["some where/a.bin"]);

    const ALPHABET: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let base64: String = file
        .bytes
        .chunks(3)
        .map(|c| c.iter().fold(0u32, |n, &b| n << 8 | u32::from(b)) << (8 * (3 - c.len())))
        .flat_map(|n| [18, 12, 6, 0].map(|shift| ALPHABET[(n >> shift & 63) as usize] as char))
        .collect();
    let text = file.gltf(&format!("data:application/octet-stream;base64,{base64}"));
    assert_eq!(triangles(&gltf::parse(&text, "a.gltf", &mut no_files).unwrap()), expected);
}

#[test]
fn a_primitive_without_material_is_grey() {
    let model = read(&Builder::triangle());
    assert_eq!(model.materials, [antumbra_scene::Material::default()]);
}
