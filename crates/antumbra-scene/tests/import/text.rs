//! Text as programs write it: byte order marks, UTF-16, line ends, comments, vertices that nothing uses.

use crate::log::logged;
use crate::{assert_says, no_files, triangles};
use antumbra_scene::SceneError;
use antumbra_scene::import::{Model, obj, ply};
use antumbra_scene::scene_file::{self, Format};
use glam::Vec3;

const OBJ: &str = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n";
const MTL: &str = "newmtl red\nKd 1 0 0\n";
const PLY: &str = "ply\nformat ascii 1.0\ncomment by hand\nelement vertex 3\nproperty float x\nproperty float y\n\
    property float z\nelement face 1\nproperty list uchar int vertex_index\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
const TOML: &str = "# a scene\n[[meshes]]\npath = \"a.obj\"\n";
const JSON: &str = "{\n\"meshes\": [{\"path\": \"a.obj\"}]\n}";

fn utf16(text: &str, mark: bool, bytes: fn(u16) -> [u8; 2]) -> Vec<u8> {
    let mark = if mark { "\u{feff}" } else { "" };
    mark.encode_utf16().chain(text.encode_utf16()).flat_map(bytes).collect()
}

/// The same text in all ways to write it.
fn written(text: &str) -> Vec<(&'static str, Vec<u8>)> {
    vec![
        ("as it is", text.into()),
        ("mark", format!("\u{feff}{text}").into()),
        ("CR LF", text.replace('\n', "\r\n").into()),
        ("CR", text.replace('\n', "\r").into()),
        ("mark and CR", format!("\u{feff}{text}").replace('\n', "\r").into()),
        ("little UTF-16", utf16(text, true, u16::to_le_bytes)),
        ("big UTF-16", utf16(text, true, u16::to_be_bytes)),
        ("little UTF-16 without mark", utf16(text, false, u16::to_le_bytes)),
        ("big UTF-16 without mark, CR", utf16(&text.replace('\n', "\r"), false, u16::to_be_bytes)),
    ]
}

fn read_obj(bytes: &[u8], mtl: &[u8]) -> Result<Model, SceneError> {
    obj::parse(bytes, "a.obj", &mut |path| if path == "a.mtl" { Ok(mtl.to_vec()) } else { no_files(path) })
}

const TRIANGLE: [[Vec3; 3]; 1] = [[Vec3::ZERO, Vec3::X, Vec3::Y]];

#[test]
fn every_text_format_is_read_in_every_encoding() {
    for ((way, obj), (_, mtl)) in written(OBJ).into_iter().zip(written(MTL)) {
        let model = read_obj(&obj, &mtl).unwrap();
        assert_eq!(triangles(&model), TRIANGLE, "OBJ, {way}");
        assert_eq!(model.materials[0].base_color.to_array(), [1.0, 0.0, 0.0, 1.0], "MTL, {way}");
    }
    for (way, bytes) in written(PLY) {
        assert_eq!(triangles(&ply::parse(&bytes, "a.ply").unwrap()), TRIANGLE, "PLY, {way}");
    }
    let mut load = |_: &str| read_obj(OBJ.as_bytes(), MTL.as_bytes());
    for (text, format) in [(TOML, Format::Toml), (JSON, Format::Json)] {
        for (way, bytes) in written(text) {
            let scene = scene_file::parse(&bytes, format, "s", &mut load).unwrap();
            assert_eq!(scene.triangle_count(), 1, "{format:?}, {way}");
        }
    }
}

#[test]
fn lines_are_counted_in_every_encoding() {
    for (way, bytes) in written(&OBJ.replace("f 1 2 3", "f 1 2 x")) {
        assert!(read_obj(&bytes, b"").unwrap_err().to_string().contains("line 6"), "OBJ, {way}");
    }
    for (way, bytes) in written(&PLY.replace("0 1 0", "0 one 0")) {
        assert!(ply::parse(&bytes, "a.ply").unwrap_err().to_string().contains("line 13"), "PLY, {way}");
    }
}

#[test]
fn a_binary_body_may_follow_a_header_with_cr() {
    let text = PLY.replace("ascii", "binary_little_endian");
    let mut file = text[..text.find("0 0 0").unwrap()].replace('\n', "\r").into_bytes();
    // The first byte of the body is that of a line feed.
    let first = f32::from_bits(0x3f80_000a);
    file.extend([first, 0., 0., 1., 0., 0., 0., 1., 0.].iter().flat_map(|x| x.to_le_bytes()));
    file.push(3);
    file.extend([0i32, 1, 2].iter().flat_map(|i| i.to_le_bytes()));
    assert_eq!(triangles(&ply::parse(&file, "a.ply").unwrap())[0][0], Vec3::new(first, 0.0, 0.0));
}

#[test]
fn comments_may_follow_statements() {
    let obj = OBJ.replace("\nv 1 0 0", " # a point\nv 1 0 0#b").replace("f 1 2 3", "f 1 2 3 # a face");
    let obj = obj.replace("usemtl red", "usemtl red # ish").replace("a.mtl", "a.mtl # colours");
    let model = read_obj(obj.as_bytes(), b"newmtl red # hot\nKd 1 0 0 # only red\n").unwrap();
    assert_eq!(triangles(&model), TRIANGLE);
    assert_eq!(model.materials[0].base_color.to_array(), [1.0, 0.0, 0.0, 1.0]);
    let named = OBJ.replace("red", "Material #25");
    let model = read_obj(named.as_bytes(), b"newmtl Material #25\nKd 0 1 0\n").unwrap();
    assert_eq!(model.materials[0].base_color.y, 1.0, "a name may hold a number sign");
}

#[test]
fn keywords_may_be_in_capitals() {
    let obj = OBJ.replace("\nv", "\nV").replace("\nf", "\nF").replace("usemtl", "USEMTL").replace("mtllib", "MTLLIB");
    let model = read_obj(obj.as_bytes(), b"NEWMTL red\nKD 0 0 1\n").unwrap();
    assert_eq!(triangles(&model), TRIANGLE);
    assert_eq!(model.materials[0].base_color.to_array(), [0.0, 0.0, 1.0, 1.0]);
}

#[test]
fn a_vertex_that_no_face_uses_may_be_no_point() {
    for bad in ["nan nan nan", "inf 0 0", "1e99 0 0"] {
        let unused = format!("v {bad}\n{}", OBJ.replace("f 1 2 3", "f 2 3 4"));
        assert_eq!(triangles(&read_obj(unused.as_bytes(), b"").unwrap()), TRIANGLE, "{bad}");
        let used = unused.replace("f 2 3 4", "f 2 3 4\nf 1 2 3");
        assert_says(read_obj(used.as_bytes(), b""), &["a.obj, line 1", "vertex 0", "finite"]);

        let unused = PLY.replace("vertex 3", "vertex 4").replace("0 1 0\n", &format!("0 1 0\n{bad}\n"));
        let model = ply::parse(unused.as_bytes(), "a.ply").unwrap();
        assert_eq!(triangles(&model), TRIANGLE, "{bad}");
        assert!(model.meshes[0].positions.iter().all(|p| p.is_finite()));
        let used = unused.replace("3 0 1 2", "3 0 1 3");
        assert_says(ply::parse(used.as_bytes(), "a.ply"), &["a.ply, line 14", "vertex 3", "finite"]);
    }
}

#[test]
fn what_is_left_out_is_said_once_a_kind() {
    let text = format!("{OBJ}p 1\nl 1 2\nf 1 2\nl 2 3\nshadow_obj low.obj\nusemap bark\n");
    let (_, said) = logged(|| read_obj(text.as_bytes(), MTL.as_bytes()));
    crate::assert_logged(
        &said,
        &[
            &["a.obj, 3 places, the first is line 7", "points and lines"],
            &["a.obj, line 9", "fewer than 3 corners"],
            &["a.obj, line 11", "shadow_obj"],
            &["a.obj, line 12", "usemap"],
        ],
    );
    let text =
        PLY.replace("float z\n", "float z\nproperty uchar alpha\n").replace("1 0 0\n0 1 0", "1 0 0 0\n0 1 0 255");
    let (_, said) =
        logged(|| ply::parse(text.replace("header\n0 0 0", "header\n0 0 0 9").as_bytes(), "a.ply").unwrap());
    crate::assert_logged(&said, &[&["a.ply, 2 places, the first is vertex 0", "alpha"]]);
    let text = PLY.replace("by hand", "\ncomment TextureFile leaf.png");
    let (_, said) = logged(|| ply::parse(text.as_bytes(), "a.ply").unwrap());
    crate::assert_logged(&said, &[&["a.ply, the header", "textures are not read"]]);
    let text = PLY.replace("end_header", "element quad 2\nproperty list uchar int vertex_indices\nend_header");
    let (_, said) = logged(|| ply::parse(format!("{text}3 0 1 2\n3 0 1 2\n").as_bytes(), "a.ply").unwrap());
    crate::assert_logged(&said, &[&["a.ply, 2 places, the first is element \"quad\"", "only faces"]]);
}
