//! What is wrong with glTF files, and that nothing panics.

use crate::glb::{Builder, U8, float_bytes};
use crate::{assert_says, no_files};
use antumbra_scene::import::{Model, gltf};
use antumbra_scene::{Place, SceneError};
use proptest::prelude::*;
use serde_json::{Value, json};

fn parse(file: &Builder) -> Result<Model, SceneError> {
    gltf::parse(&file.glb(), "bad.glb", &mut no_files)
}

#[track_caller]
fn refused(change: impl FnOnce(&mut Value), parts: &[&str]) {
    let mut file = Builder::triangle();
    change(&mut file.json);
    assert_says(parse(&file), parts);
}

#[test]
fn a_file_cut_anywhere_is_refused() {
    let whole = Builder::triangle().glb();
    for length in 0..whole.len() {
        assert!(gltf::parse(&whole[..length], "cut.glb", &mut no_files).is_err(), "{length} bytes");
    }
    assert_says(gltf::parse(&whole[..40], "cut.glb", &mut no_files), &["cut.glb", "cut off"]);
}

#[test]
fn claims_are_checked_before_anything_is_allocated() {
    let huge = u64::MAX / 2;
    refused(|j| j["accessors"][0]["count"] = 4_000_000_000u64.into(), &["accessor 0", "48000000000 bytes"]);
    refused(|j| j["accessors"][0]["count"] = huge.into(), &["accessor 0", "more than can be numbered"]);
    refused(|j| j["accessors"][0]["byteOffset"] = huge.into(), &["mesh 0 \"shape\", primitive 0", "needs"]);
    refused(|j| j["bufferViews"][0]["byteLength"] = huge.into(), &["bufferView 0", "needs"]);
    refused(|j| j["bufferViews"][0]["byteOffset"] = u64::MAX.into(), &["bufferView 0", "needs"]);
    refused(
        |j| {
            j["accessors"][0]["count"] = 4_000_000_000u64.into();
            j["accessors"][0].as_object_mut().unwrap().remove("bufferView");
        },
        &["accessor 0", "no bufferView"],
    );
    let mut file = Builder::triangle();
    file.json["buffers"][0]["uri"] = "data:,xyz".into();
    let mut text = file.json.clone();
    text["buffers"][0]["byteLength"] = 10_000_000_000u64.into();
    let text = text.to_string().into_bytes();
    assert_says(gltf::parse(&text, "a.gltf", &mut no_files), &["buffer 0", "10000000000 bytes and only 3"]);
}

#[test]
fn references_out_of_range_name_who_refers() {
    refused(
        |j| j["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 9.into(),
        &["primitive 0", "9", "1 accessors"],
    );
    refused(|j| j["meshes"][0]["primitives"][0]["material"] = 9.into(), &["primitive 0", "0 materials"]);
    refused(|j| j["nodes"][0]["mesh"] = 9.into(), &["node 0", "1 meshes"]);
    refused(|j| j["nodes"][0]["children"] = json!([7]), &["1 nodes"]);
    refused(|j| j["nodes"][0]["camera"] = 9.into(), &["node 0", "0 cameras"]);
    refused(|j| j["nodes"][0]["extensions"] = json!({"KHR_lights_punctual": {"light": 0}}), &["node 0", "0 lights"]);
    refused(|j| j["scene"] = 3.into(), &["default scene", "0 scenes"]);
    refused(|j| j["accessors"][0]["bufferView"] = 9.into(), &["accessor 0", "1 buffer views"]);
    refused(|j| j["bufferViews"][0]["buffer"] = 9.into(), &["bufferView 0", "1 buffers"]);
}

#[test]
fn wrong_types_and_strides_are_refused() {
    refused(|j| j["accessors"][0]["componentType"] = 5125.into(), &["accessor 0", "componentType"]);
    refused(|j| j["accessors"][0]["type"] = "VEC2".into(), &["accessor 0", "Vec3"]);
    refused(|j| j["bufferViews"][0]["byteStride"] = 4.into(), &["accessor 0", "4 bytes apart"]);
    refused(|j| j["meshes"][0]["primitives"][0]["mode"] = 9.into(), &["primitive 0", "mode"]);
    refused(|j| j["asset"]["version"] = "1.0".into(), &["glTF 1.0", "export it as glTF 2.0"]);
}

#[test]
fn vertices_that_are_no_points_are_named() {
    let mut file = Builder::new();
    let positions = file.floats(&[0., 0., 0., 1., f32::NAN, 0., 0., 1., 0.], "VEC3");
    file.show(json!({"attributes": {"POSITION": positions}}));
    assert!(matches!(parse(&file), Err(SceneError::NotFinite { vertex: 1, .. })));
    assert_says(parse(&file), &["mesh 0 \"shape\", primitive 0", "vertex 1", "finite"]);
    refused(|j| j["nodes"][0]["scale"] = json!([1e30, 1, 1]), &["shape", "vertex 1", "scale the model down"]);
    refused(|j| j["nodes"][0]["scale"] = json!([1e300, 1, 1]), &["node 0", "not finite"]);
}

#[test]
fn indices_out_of_range_are_named() {
    let mut file = Builder::triangle();
    file.json["meshes"][0]["primitives"][0]["indices"] = file.accessor(&[0, 1, 3], U8, "SCALAR", 3).into();
    assert_says(parse(&file), &["primitive 0, indices, element 2", "index 3", "3 vertices"]);
}

#[test]
fn sparse_indices_must_increase_and_stay_below_the_count() {
    for numbers in [[2, 1], [1, 3]] {
        let mut file = Builder::triangle();
        let indices = file.view(&numbers);
        let values = file.view(&float_bytes(&[0.; 6]));
        file.json["accessors"][0]["sparse"] = json!({
            "count": 2, "indices": {"bufferView": indices, "componentType": U8}, "values": {"bufferView": values},
        });
        assert_says(parse(&file), &["accessor 0, sparse", "stay below 3"]);
    }
}

#[test]
fn nodes_must_form_a_tree() {
    refused(
        |j| {
            j["scenes"] = json!([{"nodes": [0]}]);
            j["nodes"] = json!([{"children": [1]}, {"children": [0]}]);
        },
        &["node 0", "its own ancestor"],
    );
}

#[test]
fn what_cannot_be_read_says_the_way_out() {
    for (extension, advice) in [
        ("KHR_draco_mesh_compression", "without mesh compression"),
        ("EXT_meshopt_compression", "without mesh compression"),
        ("KHR_texture_basisu", "PNG or JPEG"),
        ("XY_unheard_of", "without this extension"),
    ] {
        refused(|j| j["extensionsRequired"] = json!([extension]), &["bad.glb", extension, advice]);
    }
    let text = Builder::triangle().gltf("gone.bin");
    assert_says(gltf::parse(&text, "a.gltf", &mut no_files), &["cannot read gone.bin", "a.gltf, buffer 0"]);
    let text = Builder::triangle().gltf("https://example.org/a.bin");
    assert_says(gltf::parse(&text, "a.gltf", &mut no_files), &["buffer 0", "download it"]);
    let text = Builder::triangle().gltf("data:;base64,!!");
    assert_says(gltf::parse(&text, "a.gltf", &mut no_files), &["buffer 0", "base64"]);
    assert_says(gltf::parse(b"{\n  \"asset\": 7}", "a.gltf", &mut no_files), &["a.gltf, line 2", "glTF 2.0"]);
}

#[test]
fn a_picture_that_is_none_is_refused() {
    let mut file = Builder::triangle();
    let view = file.view(b"no picture");
    file.add("images", json!({"bufferView": view, "mimeType": "image/png"}));
    file.add("textures", json!({"source": 0}));
    file.add("materials", json!({"name": "paint", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}));
    file.json["meshes"][0]["primitives"][0]["material"] = 0.into();
    let error = parse(&file).unwrap_err();
    assert!(matches!(&error, SceneError::Malformed { place: Place::Part(_), .. }));
    assert_says::<()>(Err(error), &["material 0 \"paint\", texture 0, image 0", "neither PNG nor JPEG"]);
}

/// A file with most of what there is to go wrong.
fn rich() -> Vec<u8> {
    let mut file = Builder::triangle();
    let indices = file.accessor(&[0, 1, 2], U8, "SCALAR", 3);
    let numbers = file.view(&[1]);
    let values = file.view(&float_bytes(&[2., 0., 0.]));
    file.json["accessors"][0]["sparse"] =
        json!({"count": 1, "indices": {"bufferView": numbers, "componentType": U8}, "values": {"bufferView": values}});
    file.json["meshes"][0]["primitives"][0]["indices"] = indices.into();
    file.json["meshes"][0]["primitives"][0]["mode"] = 5.into();
    file.add("cameras", json!({"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.5}}));
    file.add("nodes", json!({"camera": 0, "children": [0], "rotation": [0, 0, 0, 1]}));
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
        let whole = Builder::triangle().gltf("a.bin");
        let places: Vec<usize> = (0..whole.len()).filter(|&i| whole[i].is_ascii_digit()).collect();
        let place = places[at.index(places.len())];
        let changed = [&whole[..place], digits.as_bytes(), &whole[place + 1..]].concat();
        let _ = gltf::parse(&changed, "changed.gltf", &mut |_: &str| Ok(vec![0; 40]));
    }
}
