//! OBJ files and their material libraries.

use crate::{area, assert_says, no_files, png, triangles};
use antumbra_scene::import::{Model, obj};
use antumbra_scene::{Material, SceneError, Wrap};
use glam::{Vec3, vec2, vec3};
use proptest::prelude::*;

fn parse(text: &str) -> Result<Model, SceneError> {
    obj::parse(text.as_bytes(), "a.obj", &mut no_files)
}

fn read(text: &str) -> Model {
    parse(text).unwrap()
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn corners_are_written_in_four_ways() {
    for face in ["f 1 2 3", "f 1/1 2/1 3/1", "f 1//1 2//1 3//1", "f 1/1/1 2/1/1 3/1/1", "f -4 -3 -2", "f 1 \\\n2 3"] {
        let model = read(&format!("{SQUARE}vt 0 0\nvn 0 0 1\n{face}\n"));
        assert_eq!(triangles(&model), [[Vec3::ZERO, Vec3::X, vec3(1.0, 1.0, 0.0)]], "{face}");
    }
}

#[test]
fn a_face_may_come_before_its_vertices() {
    assert_eq!(area(&read(&format!("f 1 2 3 4\n{SQUARE}"))), 1.0);
}

#[test]
fn unused_vertices_windows_lines_and_extra_numbers_are_fine() {
    let model = read("# caf\u{e9}\r\nv 9 9 9 1\r\nv 0 0 0 1 0.5 0.5 0.5\r\nv 1 0 0\r\nv 0 1 0\r\nf 2 3 4\r\n");
    assert_eq!(triangles(&model), [[Vec3::ZERO, Vec3::X, Vec3::Y]]);
    assert_eq!(model.meshes[0].positions.len(), 3);
}

#[test]
fn polygons_become_triangles() {
    assert_eq!(area(&read(&format!("{SQUARE}f 1 2 3 4\n"))), 1.0);
    // An arrow head, whose fan from the first corner would cover more than the polygon.
    let arrow = read("v 0 0 0\nv 2 2 0\nv 0 1 0\nv -2 2 0\nf 1 2 3 4\n");
    assert!((area(&arrow) - 2.0).abs() < 1e-6);
    let arrow = read("v 0 1 0\nv -2 2 0\nv 0 0 0\nv 2 2 0\nf 2 3 4 1\n");
    assert!((area(&arrow) - 2.0).abs() < 1e-6);
}

#[test]
fn concave_polygons_keep_their_area_and_facing_in_every_plane() {
    // An E, standing far from the origin.
    let flat = [(0, 0), (3, 0), (3, 1), (1, 1), (1, 2), (2, 2), (2, 3), (1, 3), (1, 4), (3, 4), (3, 5), (0, 5)];
    for (u, v) in [(Vec3::X, Vec3::Y), (Vec3::Y, Vec3::Z), (Vec3::Z, Vec3::X), (Vec3::Y, Vec3::X)] {
        let mut text = String::new();
        for (x, y) in flat {
            let p = u * x as f32 + v * y as f32 + 1000.0;
            text += &format!("v {} {} {}\n", p.x, p.y, p.z);
        }
        text += "f 1 2 3 4 5 6 7 8 9 10 11 12\n";
        let model = read(&text);
        assert!((area(&model) - 10.0).abs() < 1e-3, "{}", area(&model));
        let normal = u.cross(v);
        assert!(triangles(&model).iter().all(|[a, b, c]| (b - a).cross(c - a).dot(normal) > 0.0));
    }
}

#[test]
fn degenerate_polygons_are_accepted() {
    assert_eq!(area(&read("v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nf 1 2 3 4\nf 1 1 1\n")), 0.0);
}

#[test]
fn groups_and_objects_are_gathered_by_material() {
    let text = format!("{SQUARE}o a\ng x\nusemtl red\nf 1 2 3\ng y\nusemtl blue\nf 1 2 3\no b\nusemtl red\nf 1 3 4\n");
    let model = read(&text);
    let counts: Vec<_> = model.meshes.iter().map(|m| (m.name.as_str(), m.triangle_count())).collect();
    assert_eq!(counts, [("red", 2), ("blue", 1)]);
    assert_eq!(model.meshes[0].positions.len(), 4, "the triangles of a material share vertices");
}

#[test]
fn points_and_lines_are_left_out() {
    assert_eq!(triangles(&read(&format!("{SQUARE}p 1\nl 1 2\nf 1 2\nf 1 2 3\n"))).len(), 1);
    assert_says(parse(&format!("{SQUARE}l 1 2 3\n")), &["a.obj", "no triangles"]);
    assert_says(parse(""), &["a.obj", "no triangles"]);
}

#[test]
fn what_is_wrong_is_said_with_its_line() {
    for (line, parts) in [
        ("f 1 2 9", ["line 6", "index 9", "4 vertices"]),
        ("f 1 2 -9", ["line 6", "index -9", "4 vertices"]),
        ("f 1 2 0", ["line 6", "index 0", "4 vertices"]),
        ("f 1/1 2/1 3/7", ["line 6", "index 7", "1 texture coordinates"]),
        ("f 1 2 x", ["line 6", "\"x\"", "7/3/2"]),
        ("f 1 2 3/1/1/1", ["line 6", "\"3/1/1/1\"", "7/3/2"]),
        ("f 1 2 99999999999999999999", ["line 6", "999", "corner"]),
        ("v 1 2", ["line 6", "missing", "number"]),
        ("v 1 two 3", ["line 6", "\"two\"", "not a number"]),
        ("v 1 nan 3\nf 1 2 5", ["line 6", "vertex 4", "finite"]),
        ("v 1 1e99 3\nf 1 2 5", ["line 6", "vertex 4", "finite"]),
    ] {
        assert_says(parse(&format!("{SQUARE}vt 0 0\n{line}\nf 1 2 3\n")), &parts);
    }
    assert_says(parse("v 0 0 0\nv 1e30 0 0\nv 0 1 0\nf 1 2 3\n"), &["a.obj", "scale the model down"]);
}

#[test]
fn a_missing_library_leaves_the_default_material() {
    let model = read(&format!("mtllib gone.mtl\n{SQUARE}usemtl red\nf 1 2 3\n"));
    assert_eq!(model.materials, [Material::default()]);
}

/// A disk with a material library and two pictures.
fn disk(library: &'static str) -> impl FnMut(&str) -> std::io::Result<Vec<u8>> {
    move |path| match path {
        "mats/my paint.mtl" => Ok(library.as_bytes().to_vec()),
        "mats/color.png" => Ok(png(image::RgbaImage::from_pixel(4, 4, image::Rgba([9, 8, 7, 0])))),
        "mats/sub/leaf mask.png" => {
            let stripes = |x, _| image::Rgba(if x == 0 { [0, 0, 0, 255] } else { [255; 4] });
            Ok(png(image::RgbaImage::from_fn(2, 2, stripes)))
        }
        _ => no_files(path),
    }
}

fn painted(library: &'static str) -> Model {
    let text =
        format!("mtllib mats\\my paint.mtl\n{SQUARE}vt 0 0\nvt 1 0.25\nusemtl paint\nf 1/1 2/2 3/1\nf 1/2 3/1 4\n");
    obj::parse(text.as_bytes(), "a.obj", &mut disk(library)).unwrap()
}

#[test]
fn colours_come_from_the_library() {
    let model = painted("newmtl other\nKd 1 1 1\nnewmtl paint\nKd 0.25 0.5 0.75\n");
    assert_eq!(model.materials[0].base_color.to_array(), [0.25, 0.5, 0.75, 1.0]);
    assert!(model.meshes[0].uvs.is_empty(), "coordinates without a texture are not kept");
    assert_eq!(model.meshes[0].positions.len(), 4);
}

#[test]
fn textures_come_from_the_librarys_folder() {
    let model = painted("newmtl paint\nKd 1 1 1\nmap_Kd -s 2 2 -clamp on -bm 1 color.png\n");
    let texture = model.materials[0].texture.as_ref().unwrap();
    assert_eq!((texture.width, texture.wrap), (4, [Wrap::Clamp; 2]));
    assert_eq!(texture.rgba[..4], [9, 8, 7, 255], "a colour map does not mask");
    assert_eq!(model.materials[0].alpha_cutoff, None);
    let mesh = &model.meshes[0];
    assert_eq!(mesh.positions.len(), 5, "corners that differ in texture coordinates are vertices of their own");
    assert_eq!(mesh.uvs[..2], [vec2(0.0, 1.0), vec2(2.0, 0.5)], "twice as often, and v counts from the picture's top");
}

#[test]
fn transparency_is_a_mask() {
    let model = painted("newmtl paint\nmap_Kd color.png\nmap_d sub\\leaf mask.png\n");
    let texture = model.materials[0].texture.as_ref().unwrap();
    let alpha: Vec<u8> = texture.rgba.iter().skip(3).step_by(4).copied().collect();
    assert_eq!(alpha[..4], [0, 0, 255, 255], "the smaller mask is stretched over the picture");
    assert_eq!(texture.rgba[0], 9);
    assert_eq!(model.materials[0].alpha_cutoff, Some(0.5));

    let alone = painted("newmtl paint\nmap_d sub/leaf mask.png\n");
    assert_eq!(alone.materials[0].texture.as_ref().unwrap().rgba[..4], [255, 255, 255, 0]);
    assert_eq!(painted("newmtl paint\nd 0.3\n").materials[0].alpha_cutoff, Some(0.5));
    assert_eq!(painted("newmtl paint\nTr 0.7\n").materials[0].base_color.w, 1.0 - 0.7);
    assert_eq!(painted("newmtl paint\nd 1\n").materials[0].alpha_cutoff, None);
}

#[test]
fn a_missing_texture_is_left_out() {
    let model = painted("newmtl paint\nKd 0 1 0\nmap_Kd gone.png\n");
    assert!(model.materials[0].texture.is_none());
    assert_eq!(model.materials[0].base_color.to_array(), [0.0, 1.0, 0.0, 1.0]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    #[test]
    fn flipped_bytes_never_panic(flips in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6)) {
        let mut bytes = format!("mtllib a.mtl\n{SQUARE}vt 0 0\nvn 0 0 1\nusemtl a\nf 1 2 3 4\nf -1/1/1 -2/1/1 -3/1/1\nl 1 2\n").into_bytes();
        for (at, value) in flips {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        let mut any = |_: &str| Ok(b"newmtl a\nKd 1 1 1\nmap_Kd -o 1 -s x\nd 0.5\n".to_vec());
        if let Ok(model) = obj::parse(&bytes, "flipped.obj", &mut any) {
            model.into_scene();
        }
    }

    #[test]
    fn any_polygon_gives_two_triangles_less_than_corners(
        points in prop::collection::vec((-9i32..9, -9i32..9, -2i32..2), 3..12),
    ) {
        let mut text: String = points.iter().map(|(x, y, z)| format!("v {x} {y} {z}\n")).collect();
        text += "f";
        (1..=points.len()).for_each(|i| text += &format!(" {i}"));
        prop_assert_eq!(triangles(&read(&text)).len(), points.len() - 2);
    }
}
