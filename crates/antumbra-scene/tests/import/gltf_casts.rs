//! What decides in glTF files which surfaces cast: copies, hidden nodes, alpha, poses, and extensions that are not read.

use crate::glb::{Builder, U8};
use crate::log::logged;
use crate::{area, assert_logged, assert_says, no_files, png, triangles};
use antumbra_scene::import::{Model, gltf};
use antumbra_scene::{SceneError, Texture};
use glam::{Vec3, vec3};
use image::{Rgba, RgbaImage};
use proptest::prelude::*;
use serde_json::{Value, json};

fn parse(file: &Builder) -> Result<Model, SceneError> {
    gltf::parse(&file.glb(), "a.glb", &mut no_files)
}

fn read(file: &Builder) -> Model {
    parse(file).unwrap()
}

/// The model, which must come without a warning.
#[track_caller]
fn read_silently(file: &Builder) -> Model {
    let (model, said) = logged(|| read(file));
    assert_eq!(said, [""; 0]);
    model
}

fn near(a: Vec3, b: Vec3) -> bool {
    a.distance(b) < 1e-6
}

#[test]
fn instances_are_copies() {
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let mut file = Builder::triangle();
    let at = file.floats(&[0., 0., 0., 5., 0., 0.], "VEC3");
    let turned = file.floats(&[0., 0., 0., 1., 0., 0., half, half], "VEC4");
    let scaled = file.floats(&[1., 1., 1., 2., 2., 2.], "VEC3");
    file.json["nodes"][0]["translation"] = json!([0, 0, 1]);
    file.json["nodes"][0]["extensions"] = json!({"EXT_mesh_gpu_instancing": {
        "attributes": {"TRANSLATION": at, "ROTATION": turned, "SCALE": scaled, "_ID": 99}}});
    file.json["extensionsUsed"] = json!(["EXT_mesh_gpu_instancing"]);
    file.json["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    let model = read_silently(&file);
    let all = triangles(&model);
    assert_eq!((all.len(), model.meshes.len()), (2, 1));
    assert_eq!(all[0], [Vec3::Z, vec3(1.0, 0.0, 1.0), vec3(0.0, 1.0, 1.0)]);
    assert!(near(all[1][0], vec3(5.0, 0.0, 1.0)) && near(all[1][1], vec3(5.0, 2.0, 1.0)), "{all:?}");

    let attributes = |file: &mut Builder, value: Value| {
        file.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = value;
    };
    let one = file.floats(&[0., 0., 0.], "VEC3");
    attributes(&mut file, json!({"TRANSLATION": at, "SCALE": one}));
    assert_says(parse(&file), &["node 0, EXT_mesh_gpu_instancing", "different counts"]);
    attributes(&mut file, json!({"TRANSLATION": 99}));
    assert_says(parse(&file), &["node 0, EXT_mesh_gpu_instancing", "99 is out of range"]);
    let bad = file.floats(&[0., 0., 0., f32::NAN, 0., 0.], "VEC3");
    attributes(&mut file, json!({"TRANSLATION": bad}));
    assert_says(parse(&file), &["EXT_mesh_gpu_instancing, instance 1", "not finite"]);
}

#[test]
fn hidden_nodes_are_left_out_with_what_hangs_on_them() {
    let mut file = Builder::triangle();
    let hidden = json!({"KHR_node_visibility": {"visible": false}});
    let shown = json!({"KHR_node_visibility": {"visible": true}});
    file.json["nodes"] = json!([
        {"mesh": 0, "extensions": shown},
        {"children": [2], "extensions": hidden},
        {"children": [3], "extensions": shown},
        {"mesh": 0},
    ]);
    file.json["extensionsUsed"] = json!(["KHR_node_visibility"]);
    assert_eq!(triangles(&read_silently(&file)).len(), 1);
    file.json["nodes"][1]["extensions"] = shown;
    assert_eq!(triangles(&read_silently(&file)).len(), 2);
}

/// The unit square, with the alpha of its vertices (0 0) (1 0) (0 1) (1 1), and a material.
fn with_alpha(alphas: [u8; 4], material: Value) -> Builder {
    let mut file = Builder::new();
    let positions = file.floats(&[0., 0., 0., 1., 0., 0., 0., 1., 0., 1., 1., 0.], "VEC3");
    let uvs = file.floats(&[0., 0., 1., 0., 0., 1., 1., 1.], "VEC2");
    let colors: Vec<u8> = alphas.iter().flat_map(|&a| [255, 255, 255, a]).collect();
    let colors = file.accessor(&colors, U8, "VEC4", 4);
    file.json["accessors"][colors]["normalized"] = true.into();
    let material = file.add("materials", material);
    let attributes = json!({"POSITION": positions, "COLOR_0": colors, "TEXCOORD_0": uvs});
    file.show(json!({"attributes": attributes, "mode": 5, "material": material}));
    file
}

/// Adds a picture whose left half is opaque and returns its texture.
fn half_texture(file: &mut Builder) -> usize {
    let picture = RgbaImage::from_fn(2, 1, |x, _| Rgba([255, 255, 255, if x == 0 { 255 } else { 0 }]));
    let view = file.view(&png(picture));
    let image = file.add("images", json!({"bufferView": view, "mimeType": "image/png"}));
    file.add("textures", json!({"source": image}))
}

#[test]
fn alpha_of_vertices_cuts_masked_surfaces() {
    for (mode, alphas, factor, expected) in [
        ("MASK", [0, 0, 0, 0], 1.0, None),
        ("MASK", [255, 255, 255, 255], 1.0, Some(1.0)),
        ("BLEND", [200, 0, 200, 0], 1.0, Some(127.5 / 200.0 - 0.27500004)),
        ("MASK", [255, 0, 255, 0], 1.0, Some(0.5)),
        ("MASK", [255, 0, 255, 0], 0.625, Some(0.2)),
        ("MASK", [255, 255, 255, 0], 1.0, Some(0.875)),
        ("OPAQUE", [0, 0, 0, 0], 1.0, Some(1.0)),
    ] {
        let factor = json!({"baseColorFactor": [1, 1, 1, factor]});
        let file = with_alpha(alphas, json!({"alphaMode": mode, "pbrMetallicRoughness": factor}));
        let (result, said) = logged(|| parse(&file));
        assert_eq!(said, [""; 0], "it is read");
        match expected {
            None => assert!(matches!(result, Err(SceneError::NoTriangles { .. })), "all of it is a hole"),
            Some(expected) => {
                let model = result.unwrap();
                assert!((area(&model) - expected).abs() < 1e-4, "{mode} {alphas:?}: {}", area(&model));
                assert_eq!(model.materials[0].alpha_cutoff, None, "what is left is solid");
            }
        }
    }
}

#[test]
fn alpha_of_vertices_meets_a_texture() {
    let textured = |alphas| {
        let mut file = with_alpha(alphas, json!({"alphaMode": "MASK", "alphaCutoff": 0.4}));
        let texture = half_texture(&mut file);
        file.json["materials"][0]["pbrMetallicRoughness"] = json!({"baseColorTexture": {"index": texture}});
        file
    };
    let model = read_silently(&textured([51; 4]));
    let material = &model.materials[model.meshes[0].material];
    assert!((material.base_color.w - 0.2).abs() < 1e-6, "one alpha is a factor");
    assert_eq!(material.alpha_cutoff, Some(0.4));
    assert_eq!(area(&read_silently(&textured([255; 4]))), 1.0);
    let (model, said) = logged(|| read(&textured([255, 0, 0, 0])));
    assert_eq!(area(&model), 0.5, "the triangle that is hidden whole is cut out");
    assert_logged(&said, &[&["mesh 0 \"shape\", primitive 0", "alpha of vertices varies"]]);
}

#[test]
fn specular_glossiness_has_the_alpha() {
    let mut file = with_alpha([255; 4], json!({"alphaMode": "MASK"}));
    let texture = half_texture(&mut file);
    file.json["materials"][0]["extensions"] = json!({"KHR_materials_pbrSpecularGlossiness": {
        "diffuseFactor": [0.5, 1, 1, 0.75],
        "diffuseTexture": {"index": texture, "extensions": {"KHR_texture_transform": {"offset": [0.5, 0]}}},
    }});
    file.json["extensionsUsed"] = json!(["KHR_materials_pbrSpecularGlossiness", "KHR_texture_transform"]);
    file.json["extensionsRequired"] = file.json["extensionsUsed"].clone();
    let model = read_silently(&file);
    let material = &model.materials[0];
    assert_eq!((material.base_color.to_array(), material.alpha_cutoff), ([0.5, 1.0, 1.0, 0.75], Some(0.5)));
    assert_eq!(material.texture.as_ref().map(|t: &std::sync::Arc<Texture>| t.rgba[7]), Some(0));
    assert_eq!(model.meshes[0].uvs[0].x, 0.5, "KHR_texture_transform holds for it too");
}

#[test]
fn a_surface_that_vanishes_is_named() {
    let glass =
        json!({"name": "glass", "alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.3]}});
    let (_, said) = logged(|| read(&with_alpha([255; 4], glass)));
    assert_logged(&said, &[&["a.glb, material 0 \"glass\"", "cast no shadow"]]);
}

/// A triangle with two morph targets: one moves the first corner up, one moves all along x.
fn morphing() -> Builder {
    let mut file = Builder::triangle();
    let up = file.floats(&[0., 0., 2., 0., 0., 0., 0., 0., 0.], "VEC3");
    let along = file.floats(&[4., 0., 0., 4., 0., 0., 4., 0., 0.], "VEC3");
    file.json["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": up}, {"POSITION": along}, {}]);
    file
}

#[test]
fn morph_targets_are_applied_by_the_weights_at_rest() {
    let mut file = morphing();
    assert_eq!(triangles(&read_silently(&file))[0], [Vec3::ZERO, Vec3::X, Vec3::Y], "weights are 0 by default");
    file.json["meshes"][0]["weights"] = json!([0.5, 0, 1]);
    file.add("nodes", json!({"mesh": 0, "weights": [0, 1, 0]}));
    file.add("nodes", json!({"mesh": 0, "weights": [0, 1, 0]}));
    let model = read_silently(&file);
    let all = triangles(&model);
    assert_eq!(all[0][0], Vec3::Z);
    assert_eq!(all[1], [vec3(4.0, 0.0, 0.0), vec3(5.0, 0.0, 0.0), vec3(4.0, 1.0, 0.0)], "a node's weights go first");
    assert_eq!(model.meshes.len(), 2, "a pose that is shown twice is kept once");

    let few = file.floats(&[0.; 6], "VEC3");
    file.json["meshes"][0]["primitives"][0]["targets"][0]["POSITION"] = few.into();
    assert_says(parse(&file), &["primitive 0, target 0", "there are 2 elements, and 3 are needed"]);
}

/// A triangle on two joints, with a node that would scale it. Joint 2 moves by (0 0 3) from joint 1, which moves by
/// (0 2 0); at rest the second was at (0 2 0).
fn skinned(weights: [f32; 12]) -> Builder {
    let mut file = Builder::triangle();
    let joints = file.accessor(&[0, 1, 0, 0].repeat(3), U8, "VEC4", 3);
    let weights = file.floats(&weights, "VEC4");
    let unmoved = [1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.];
    let mut lowered = unmoved;
    lowered[13] = -2.0;
    let inverse = file.floats(&[unmoved, lowered].concat(), "MAT4");
    let attributes = &mut file.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = joints.into();
    attributes["WEIGHTS_0"] = weights.into();
    file.json["nodes"] = json!([
        {"mesh": 0, "skin": 0, "scale": [9, 9, 9], "translation": [7, 7, 7]},
        {"translation": [0, 2, 0], "children": [2]},
        {"translation": [0, 0, 3]},
    ]);
    file.json["skins"] = json!([{"joints": [1, 2], "inverseBindMatrices": inverse}]);
    file
}

#[test]
fn skins_follow_their_joints_and_not_their_node() {
    let file = skinned([1., 0., 0., 0., 0., 1., 0., 0., 0.25, 0.25, 0., 0.]);
    let model = read_silently(&file);
    let [a, b, c] = triangles(&model)[0];
    assert_eq!(a, vec3(0.0, 2.0, 0.0), "all of the first joint");
    assert_eq!(b, vec3(1.0, 0.0, 3.0), "all of the second, from where it was bound");
    assert_eq!(c, vec3(0.0, 2.0, 1.5), "the mean of both, whatever the sum of the weights");
    let none = triangles(&read_silently(&skinned([0.; 12])));
    assert_eq!(none[0][0], vec3(0.0, 2.0, 0.0), "without weights it is the first joint");
}

#[test]
fn a_skin_that_cannot_be_applied_is_named() {
    let ones = [1., 0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0.];
    let mut file = skinned(ones);
    file.json["skins"][0]["joints"] = json!([]);
    let (model, said) = logged(|| read(&file));
    assert_logged(&said, &[&["node 0, skin 0", "no joints"]]);
    assert_eq!(triangles(&model)[0][0], vec3(7.0, 7.0, 7.0));
    let mut file = skinned(ones);
    file.json["scenes"] = json!([{"nodes": [0]}]);
    assert_logged(&logged(|| read(&file)).1, &[&["node 0, skin 0", "not in the scene"]]);

    let mut file = skinned([0., 1., 0., 0., 0., 1., 0., 0., 0., 1., 0., 0.]);
    file.json["skins"][0]["joints"] = json!([1]);
    assert_says(parse(&file), &["primitive 0, vertex 0", "index 1", "1 joints"]);
    file.json["skins"][0]["joints"] = json!([1, 9]);
    assert_says(parse(&file), &["node 0, skin 0", "index 9", "3 nodes"]);
    let mut file = skinned(ones);
    file.json["nodes"][0]["skin"] = 5.into();
    assert_says(parse(&file), &["node 0", "index 5", "1 skins"]);
    file.json["nodes"][0]["skin"] = 0.into();
    file.json["skins"][0]["joints"] = json!([1, 2, 1]);
    assert_says(parse(&file), &["node 0, skin 0", "there are 2 elements, and 3 are needed"]);
}

#[test]
fn extensions_that_are_not_read_are_named_with_their_number() {
    let mut file = Builder::triangle();
    let ext = json!({"XY_thickness": {"metres": 1}});
    file.json["meshes"][0]["extensions"] = ext.clone();
    file.json["nodes"][0]["extensions"] = ext;
    file.json["nodes"][0]["extras"] = json!({"extensions": {"XY_thickness": {}}});
    file.json["materials"] = json!([{"extensions": {"KHR_materials_transmission": {}, "KHR_materials_ior": {}}}]);
    file.json["extensionsUsed"] =
        json!(["KHR_materials_ior", "KHR_materials_transmission", "KHR_draco_mesh_compression", "XY_thickness"]);
    let (_, mut said) = logged(|| read(&file));
    said.sort();
    assert_logged(
        &said,
        &[
            &["a.glb, 2 places, the first is meshes[0]", "extension XY_thickness is not read"],
            &["a.glb, extensionsUsed", "extension KHR_draco_mesh_compression is not read"],
            &["a.glb, materials[0]", "KHR_materials_transmission is not read", "cast shadows like any other"],
        ],
    );
}

#[test]
fn a_vertex_that_no_triangle_uses_may_be_no_point() {
    let mut file = Builder::new();
    let positions = file.floats(&[f32::NAN, 0., 0., 0., 0., 0., 1., 0., 0., 0., 1., 0.], "VEC3");
    let indices = file.accessor(&[1, 2, 3], U8, "SCALAR", 3);
    file.show(json!({"attributes": {"POSITION": positions}, "indices": indices}));
    assert_eq!(triangles(&read(&file)), [[Vec3::ZERO, Vec3::X, Vec3::Y]]);
    file.json["meshes"][0]["primitives"][0]["indices"] = file.accessor(&[1, 2, 0], U8, "SCALAR", 3).into();
    assert_says(parse(&file), &["primitive 0", "vertex 0", "finite"]);
}

#[test]
fn text_files_may_have_a_mark_and_capitals() {
    let file = Builder::triangle();
    let expected = triangles(&read(&file));
    let hex: String = file.bytes.iter().map(|b| format!("%{b:02x}")).collect();
    let base64 = data_uri(&file.bytes);
    for uri in [&format!("DATA:,{hex}"), &base64, &base64.replace("data", "Data").replace("base64", "BASE64")] {
        for mark in ["", "\u{feff}"] {
            let text = [mark.as_bytes(), &file.gltf(uri)].concat();
            assert_eq!(triangles(&gltf::parse(&text, "a.gltf", &mut no_files).unwrap()), expected, "{}", &uri[..20]);
        }
    }
    let text = String::from_utf8(file.gltf(&base64)).unwrap();
    let wide: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
    assert_eq!(triangles(&gltf::parse(&wide, "a.gltf", &mut no_files).unwrap()), expected, "UTF-16");
}

fn data_uri(bytes: &[u8]) -> String {
    const ALPHABET: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let word = |c: &[u8]| c.iter().fold(0u32, |n, &b| n << 8 | u32::from(b)) << (8 * (3 - c.len()));
    let letters = |n: u32| [18, 12, 6, 0].map(|shift| ALPHABET[(n >> shift & 63) as usize] as char);
    format!("data:application/octet-stream;base64,{}", bytes.chunks(3).map(word).flat_map(letters).collect::<String>())
}

#[test]
fn no_message_prints_a_payload() {
    let payload = "A".repeat(100_000);
    let short = |file: &[u8]| {
        let message = gltf::parse(file, "a.gltf", &mut no_files).unwrap_err().to_string();
        assert!(message.len() < 400, "{} bytes: {}", message.len(), &message[..300]);
    };
    let file = Builder::triangle();
    for scheme in ["data;", "daat:;base64,", "https://", "data:;base64,!", ""] {
        short(&file.gltf(&format!("{scheme}{payload}")));
    }
    short(&file.gltf(&payload[..3000]));
    let text = String::from_utf8(file.gltf("a.bin")).unwrap();
    short(text.replace("\"byteLength\":36", &format!("\"byteLength\":\"{payload}\"")).as_bytes());
}

/// A file with a skin, a morph target, instances, alpha of vertices and an extension that is not read.
fn rich() -> Vec<u8> {
    let mut file = skinned([1., 0., 0., 0., 0., 1., 0., 0., 0.25, 0.25, 0., 0.]);
    let colors = file.accessor(&[255, 255, 255, 9].repeat(3), U8, "VEC4", 3);
    let (up, at) = (file.floats(&[1.; 9], "VEC3"), file.floats(&[0., 0., 0., 5., 0., 0.], "VEC3"));
    file.add("materials", json!({"alphaMode": "MASK", "alphaCutoff": 0.01}));
    let primitive = &mut file.json["meshes"][0]["primitives"][0];
    primitive["attributes"]["COLOR_0"] = colors.into();
    primitive["targets"] = json!([{"POSITION": up}]);
    primitive["material"] = 0.into();
    file.json["meshes"][0]["weights"] = json!([0.5]);
    file.add(
        "nodes",
        json!({"mesh": 0, "extensions": {"XY_any": {},
        "EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": at}}, "KHR_node_visibility": {"visible": true}}}),
    );
    file.glb()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    #[test]
    fn flipped_bytes_never_panic(flips in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..5)) {
        let mut bytes = rich();
        for (at, value) in flips {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        if let Ok(model) = gltf::parse(&bytes, "flipped.glb", &mut no_files) {
            model.into_scene();
        }
    }

    #[test]
    fn changed_digits_never_panic(at in any::<prop::sample::Index>(), digits in "-?[0-9]{1,20}") {
        let mut whole = rich();
        let json_end = 20 + u32::from_le_bytes(whole[12..16].try_into().unwrap()) as usize;
        let places: Vec<usize> = (20..json_end).filter(|&i| whole[i].is_ascii_digit()).collect();
        let place = places[at.index(places.len())];
        let grown = digits.len() as u32 - 1;
        for length in [8, 12] {
            let old = u32::from_le_bytes(whole[length..length + 4].try_into().unwrap());
            whole[length..length + 4].copy_from_slice(&(old + grown).to_le_bytes());
        }
        let changed = [&whole[..place], digits.as_bytes(), &whole[place + 1..]].concat();
        let _ = gltf::parse(&changed, "changed.glb", &mut no_files);
    }
}

#[test]
fn the_rich_file_is_a_good_one() {
    assert_eq!(triangles(&gltf::parse(&rich(), "rich.glb", &mut no_files).unwrap()).len(), 3);
}
