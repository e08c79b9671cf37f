//! Everything that a user may get wrong: one clear message, the right exit code, nothing half written.

use crate::meshes::{animal, glb, triangle_bytes, triangle_json};
use crate::{Place, check_refusal, finish};

const OUT: &str = "-t hard --size 64x64 -o out.png";

#[test]
fn damaged_scenes_are_refused() {
    let place = Place::new();
    let whole = glb(&triangle_json(36, 3), &triangle_bytes());
    let square = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let scenes: Vec<(&str, Vec<u8>, Vec<&str>)> = vec![
        ("cut.glb", whole[..whole.len() - 20].to_vec(), vec!["cut.glb"]),
        ("head.glb", whole[..7].to_vec(), vec!["head.glb"]),
        ("range.obj", format!("{square}f 1 2 9\n").into(), vec!["range.obj", "line 4", "9"]),
        ("nan.obj", format!("v nan 0 0\n{square}f 1 2 3\n").into(), vec!["nan.obj", "finite"]),
        ("empty.obj", square.into(), vec!["empty.obj", "triangles"]),
        ("nothing.obj", vec![], vec!["nothing.obj"]),
        ("huge.glb", glb(&triangle_json(10 << 30, 3), &triangle_bytes()), vec!["huge.glb"]),
        ("many.glb", glb(&triangle_json(36, 900_000_000), &triangle_bytes()), vec!["many.glb"]),
        ("huge.ply", huge_ply(), vec!["huge.ply"]),
        ("scene.toml", b"width = 64\n[camera\n".to_vec(), vec!["scene.toml", "line 2"]),
        ("scene.json", b"{\"width\": ".to_vec(), vec!["scene.json"]),
        ("notes.txt", b"hello".to_vec(), vec!["notes.txt"]),
    ];
    for (name, bytes, words) in scenes {
        let scene = place.file(name, bytes);
        place.refuses(&format!("render {scene} {OUT}"), 2, &words);
        place.refuses(&format!("reference {scene} --size 64x64 --visibility v.npy"), 2, &words);
    }
}

/// A header that promises ten gigabytes.
fn huge_ply() -> Vec<u8> {
    let header = "ply\nformat binary_little_endian 1.0\nelement vertex 900000000\nproperty float x\nproperty float y\n\
        property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
    [header.as_bytes(), &triangle_bytes()].concat()
}

#[test]
fn an_intact_triangle_is_drawn() {
    let place = Place::new();
    let scene = place.file("one.glb", glb(&triangle_json(36, 3), &triangle_bytes()));
    place.succeeds(&format!("render {scene} {OUT}"));
    assert_eq!(place.names(), ["one.glb", "out.png"]);
}

#[test]
fn degenerate_triangles_and_unused_vertices_are_accepted() {
    let place = Place::new();
    let scene = place.file("odd.obj", animal() + "v 5 5 5\nf 1 1 2\nf 3 3 3\n");
    place.succeeds(&format!("render {scene} {OUT}"));
}

#[test]
fn missing_things_are_named() {
    let place = Place::new();
    place.refuses(&format!("render no-such-file.glb {OUT}"), 2, &["no-such-file.glb"]);
    place.refuses(&format!("render builtin:fense {OUT}"), 2, &["fense", "`fence`"]);
    place.refuses(&format!("render builtin:forest:tress=3 {OUT}"), 2, &["tress", "`trees`"]);
    place.refuses(&format!("render builtin:fence {OUT} --adapter no-such-adapter"), 2, &["no-such-adapter"]);
    place.refuses(&format!("render builtin:fence {OUT} --adapter 999"), 2, &["999"]);
}

#[test]
fn wrong_techniques_and_settings_are_refused_with_the_nearest() {
    let place = Place::new();
    let render = "render builtin:fence --size 64x64 -o out.png -t";
    place.refuses(&format!("{render} pfc"), 2, &["pfc", "did you mean `pcf`"]);
    place.refuses(&format!("{render} hard:mapp=512"), 2, &["mapp", "did you mean `map`"]);
    place.refuses(&format!("{render} hard:map=lots"), 2, &["map=lots", "whole number"]);
    place.refuses(&format!("{render} hard:map"), 2, &["key=value"]);
    place.refuses("compare builtin:fence -t hard -t pfc -o report", 2, &["did you mean `pcf`"]);
}

#[test]
fn sizes_that_cannot_be_are_refused() {
    let place = Place::new();
    let render = "render builtin:fence -t hard -o out.png --size";
    place.refuses(&format!("{render} 0x64"), 2, &["at least one pixel"]);
    place.refuses(&format!("{render} 64"), 2, &["1280x720"]);
    place.refuses(&format!("{render} 1000000x64"), 2, &["image", "1000000 x 64"]);
    place.refuses("reference builtin:fence --visibility v.npy --size 64x1000000", 2, &["64 x 1000000"]);
    place.refuses("reference builtin:fence --visibility v.npy --light-samples 0", 2, &["light-samples"]);
    place.refuses("render builtin:fence -t hard -o out.png --frames 0", 2, &["frames"]);
    place.refuses("render builtin:fence -t hard -o out.png --light-size=-1", 2, &["light-size", "metres"]);
}

#[test]
fn unwritable_outputs_are_refused_before_the_work() {
    let place = Place::new();
    place.file("taken", "a file");
    std::fs::create_dir(place.path("folder.png")).expect("a folder");
    let render = "render builtin:fence -t hard --size 64x64";
    place.refuses(&format!("{render} -o missing/out.png"), 2, &["missing/out.png", "mkdir -p missing"]);
    place.refuses(&format!("{render} -o taken/out.png"), 2, &["taken", "not a folder"]);
    place.refuses(&format!("{render} -o folder.png"), 2, &["folder.png", "is a folder"]);
    place.refuses(&format!("{render} -o new.png/"), 2, &["new.png/", "is a folder"]);
    place.refuses(&format!("{render} -o out.jpg"), 2, &["out.jpg", ".png"]);
    place.refuses(&format!("{render} --visibility v.tiff"), 2, &["v.tiff", ".npy, .exr or .png"]);
    place.refuses(&format!("{render} -o same.png --visibility same.png"), 2, &["same.png", "its own"]);
    place.refuses(&format!("{render} -o out.png --stats missing/s.json"), 2, &["missing/s.json"]);
    place.refuses(render, 2, &["--output", "--visibility", "--stats"]);
    place.refuses("reference builtin:fence --size 64x64 --visibility v.npy --valid m.png", 2, &["m.png", ".npy"]);
    place.refuses("reference builtin:fence --size 64x64 --visibility missing/v.npy", 2, &["missing/v.npy"]);
    place.refuses("compare builtin:fence -t hard --size 64x64 -o taken", 2, &["taken", "not a folder"]);
    place.refuses("compare builtin:fence -t hard --size 64x64 -o taken/report", 2, &["taken", "not a folder"]);
}

#[test]
fn a_missing_adapter_is_an_error_with_a_remedy() {
    let place = Place::new();
    for arguments in [format!("render builtin:fence {OUT}"), "compare builtin:fence -t hard -o report".to_owned()] {
        let mut command = place.command(&arguments);
        command.env("VK_DRIVER_FILES", "/no/driver.json").env("VK_ICD_FILENAMES", "/no/driver.json");
        command.env("WGPU_BACKEND", "vulkan");
        check_refusal(&arguments, &finish(command), 1, &["no graphics adapter", "mesa-vulkan-drivers"]);
        assert_eq!(place.names(), [""; 0]);
    }
}

#[test]
fn usage_errors_end_with_two() {
    let place = Place::new();
    place.refuses("rendr builtin:fence", 2, &["rendr", "render"]);
    place.refuses("render -o out.png", 2, &["SCENE"]);
    place.refuses("compare builtin:fence -o report", 2, &["--technique"]);
}
