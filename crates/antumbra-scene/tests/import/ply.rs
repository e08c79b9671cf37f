//! PLY files in the three encodings.

use crate::{area, assert_says, triangles};
use antumbra_scene::SceneError;
use antumbra_scene::import::{Model, ply};
use glam::{Vec3, vec3};
use proptest::prelude::*;

fn parse(bytes: &[u8]) -> Result<Model, SceneError> {
    ply::parse(bytes, "a.ply")
}

fn ascii(body: &str) -> Vec<u8> {
    format!("ply\r\nformat ascii 1.0\r\ncomment caf\u{e9}\r\n{body}").into_bytes()
}

const HEADER: &str = "obj_info made by hand
element vertex 4
property uchar red
property float x
property double y
property short z
property list uchar float weights
element camera 1
property list ushort int junk
property int8 more
element face 2
property float quality
property list uchar int vertex_indices
property list uint uchar other
end_header
";

/// The same square and triangle in each encoding.
fn example(format: &str) -> Vec<u8> {
    let mut file = format!("ply\nformat {format} 1.0\n{HEADER}").into_bytes();
    if format == "ascii" {
        file.extend(b"1 0 0 0 0\n2 1 0 0 1 0.5\n3 1 1 0 0\n4 0 1 0 0\n2 7 8\n9\n0.5 4 0 1 2 3 0\n0.5 3 0 1 2 2 1 1\n");
        return file;
    }
    let big = format == "binary_big_endian";
    let mut put = |bytes: &[u8]| if big { file.extend(bytes.iter().rev()) } else { file.extend(bytes) };
    for (i, (x, y)) in [(0.0f32, 0.0f64), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].into_iter().enumerate() {
        put(&[i as u8]);
        put(&x.to_le_bytes());
        put(&y.to_le_bytes());
        put(&0i16.to_le_bytes());
        put(&[u8::from(i == 1)]);
        if i == 1 {
            put(&0.5f32.to_le_bytes());
        }
    }
    put(&2u16.to_le_bytes());
    put(&7i32.to_le_bytes());
    put(&8i32.to_le_bytes());
    put(&[9]);
    for (face, other) in [(&[0i32, 1, 2, 3][..], 0u32), (&[0, 1, 2], 2)] {
        put(&0.5f32.to_le_bytes());
        put(&[face.len() as u8]);
        face.iter().for_each(|i| put(&i.to_le_bytes()));
        put(&other.to_le_bytes());
        (0..other).for_each(|_| put(&[1]));
    }
    file
}

const FORMATS: [&str; 3] = ["ascii", "binary_little_endian", "binary_big_endian"];

#[test]
fn all_encodings_give_the_same_mesh() {
    let [text, little, big] = FORMATS.map(|format| parse(&example(format)).unwrap());
    assert_eq!(triangles(&text).len(), 3);
    assert_eq!(area(&text), 1.5);
    assert_eq!(text, little);
    assert_eq!(text, big);
}

#[test]
fn every_cut_is_refused() {
    for format in FORMATS {
        let whole = example(format);
        for length in 0..whole.len() - 2 {
            assert!(parse(&whole[..length]).is_err(), "{format} cut at {length}");
        }
    }
}

#[test]
fn faces_may_come_first_and_be_called_either_way() {
    let faces_first = "element face 1\nproperty list uchar int vertex_index\nelement vertex 3\nproperty float x\n\
                       property float y\nproperty float z\nend_header\n3 0 1 2\n0 0 0\n1 0 0\n0 1 0";
    assert_eq!(triangles(&parse(&ascii(faces_first)).unwrap()), [[Vec3::ZERO, Vec3::X, Vec3::Y]]);
}

const VERTICES: &str = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
const FACES: &str = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";

#[test]
fn concave_polygons_and_strips() {
    let arrow = format!("{VERTICES}{FACES}0 0 0\n2 2 0\n0 1 0\n-2 2 0\n4 0 1 2 3\n");
    assert!((area(&parse(&ascii(&arrow)).unwrap()) - 2.0).abs() < 1e-6);
    let strips = format!(
        "{VERTICES}element tristrips 1\nproperty list int int vertex_indices\nend_header\n\
         0 0 0\n1 0 0\n0 1 0\n1 1 0\n8 0 1 2 3 -1 0 1 2\n"
    );
    let model = parse(&ascii(&strips)).unwrap();
    assert_eq!(triangles(&model).len(), 3);
    assert!(triangles(&model).iter().all(|[a, b, c]| (b - a).cross(c - a) == vec3(0.0, 0.0, 1.0)));
}

#[test]
fn claims_that_the_file_cannot_hold_are_refused_at_once() {
    for format in FORMATS {
        for header in [
            "element vertex 10000000000\nproperty float x\nproperty float y\nproperty float z\n",
            "element vertex 18446744073709551615\nproperty float x\nproperty float y\nproperty float z\n",
            "element junk 10000000000\nproperty list uchar int a\n",
            "element face 10000000000\nproperty list uchar int vertex_indices\n",
        ] {
            let file = format!("ply\nformat {format} 1.0\n{header}end_header\n0 0 0");
            assert_says(parse(file.as_bytes()), &["a.ply", "items needs", "damaged or cut off"]);
        }
        for element in ["nothing", "face", "tristrips"] {
            let empty = format!("ply\nformat {format} 1.0\nelement {element} 18446744073709551615\nend_header\n");
            assert_says(parse(empty.as_bytes()), &["no triangles"]);
        }
    }
    let list = format!(
        "ply\nformat binary_little_endian 1.0\n{VERTICES}element face 1\nproperty list uint int vertex_indices\nend_header\n"
    );
    let mut file = list.into_bytes();
    file.extend([0; 48]);
    file.extend([255; 4]);
    assert_says(parse(&file), &["byte", "a list of 4294967295 numbers needs 17179869180 bytes and only 0"]);
}

#[test]
fn what_is_wrong_is_said_with_its_place() {
    let body = |vertex: &str, face: &str| ascii(&format!("{VERTICES}{FACES}0 0 0\n1 0 0\n{vertex}\n0 1 0\n{face}\n"));
    for (vertex, face, parts) in [
        ("1 nan 0", "3 0 1 2", ["line 13", "vertex 2"]),
        ("1 one 0", "3 0 1 2", ["line 13", "\"one\" is not a number"]),
        ("1 1 0", "3 0 1 4", ["face 0", "index 4 is out of range, there are 4 vertices"]),
        ("1 1 0", "3 0 1 -2", ["face 0", "index -2"]),
        ("1 1 0", "3 0 1 0.5", ["line 15", "0.5 is not an index"]),
        ("1 1 0", "-3 0 1 2", ["line 15", "-3 is not the length of a list"]),
        ("1 1 0", "1e39 0 1 2", ["line 15", "numbers needs"]),
        ("1 1 0", "3 0 1", ["line 16", "cut off"]),
        ("1 1 0", "2 0 1 2", ["a.ply", "three corners"]),
    ] {
        assert_says(parse(&body(vertex, face)), &parts);
    }
    for (header, parts) in [
        ("element vertex many\nend_header\n", ["line 4", "\"many\""]),
        ("property float x\nend_header\n", ["line 4", "no element"]),
        ("element vertex 0\nproperty real x\nend_header\n", ["line 5", "\"real\""]),
        ("element vertex 0\nproperty float x\nend_header\n", ["element vertex", "x, y and z"]),
        ("element face 0\nproperty list float int a\nend_header\n", ["line 5", "whole numbers"]),
        ("nonsense\nend_header\n", ["line 4", "nonsense"]),
        ("element vertex 0\n", ["line 4", "end_header"]),
    ] {
        assert_says(parse(&ascii(header)), &parts);
    }
    assert_says(parse(b"plx\n"), &["line 1", "ply"]);
    assert_says(parse(b"ply\nformat binary 1.0\nend_header\n"), &["line 2", "binary_little_endian"]);
    assert_says(parse(b"ply\nend_header\n"), &["line 2", "format"]);
    let cloud = format!("{VERTICES}end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n");
    assert_says(parse(&ascii(&cloud)), &["no triangles", "cloud of points"]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    #[test]
    fn flipped_bytes_never_panic(
        format in prop::sample::select(FORMATS.to_vec()),
        flips in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
    ) {
        let mut bytes = example(format);
        for (at, value) in flips {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        if let Ok(model) = parse(&bytes) {
            model.into_scene();
        }
    }
}
