//! Material libraries: what decides where a surface has holes.

use crate::log::logged;
use crate::{assert_logged, no_files, png};
use antumbra_scene::import::{Model, obj};
use glam::{Vec2, vec2};
use image::{Rgba, RgbaImage};

/// A square with texture coordinates, painted by a library. `grey.png` is opaque in its left half, `half.png` has an
/// alpha that is, `none.png` has no alpha anywhere.
fn painted(library: &str) -> (Model, Vec<String>) {
    let halves = |left, right| RgbaImage::from_fn(4, 4, |x, _| Rgba(if x < 2 { left } else { right }));
    let text = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl m\n\
                f 1/1 2/2 3/3 4/4\n";
    let mut disk = |path: &str| match path {
        "a.mtl" => Ok(format!("newmtl m\n{library}\n").into_bytes()),
        "grey.png" => Ok(png(halves([255; 4], [0, 0, 0, 255]))),
        "half.png" => Ok(png(halves([90, 80, 70, 255], [90, 80, 70, 0]))),
        "red.png" => Ok(png(RgbaImage::from_pixel(4, 4, Rgba([255, 0, 0, 255])))),
        "none.png" => Ok(png(RgbaImage::from_pixel(4, 4, Rgba([1, 2, 3, 0])))),
        _ => no_files(path),
    };
    logged(|| obj::parse(text.as_bytes(), "a.obj", &mut disk).unwrap())
}

/// Is the square a hole at `uv`, where v points up?
fn is_hole(model: &Model, uv: Vec2) -> bool {
    let (mesh, material) = (&model.meshes[0], &model.materials[0]);
    let Some(cutoff) = material.alpha_cutoff else { return false };
    let Some(texture) = &material.texture else { return material.base_color.w < cutoff };
    let [origin, along_u, _, along_v] = mesh.uvs[..] else { panic!("four vertices") };
    let at = origin + (along_u - origin) * uv.x + (along_v - origin) * uv.y;
    let texel = (at - at.floor()) * vec2(texture.width as f32, texture.height as f32);
    let index = texel.y as usize * texture.width as usize + texel.x as usize;
    material.base_color.w * f32::from(texture.rgba[4 * index + 3]) / 255.0 < cutoff
}

/// Where the square is solid along its lower edge, in eighths.
fn solid(model: &Model) -> String {
    (0..8).map(|i| if is_hole(model, vec2((i as f32 + 0.5) / 8.0, 0.1)) { '.' } else { '#' }).collect()
}

#[test]
fn a_mask_lies_where_its_options_say() {
    for (map, expected) in [
        ("map_d grey.png", "####...."),
        ("MAP_D grey.png", "####...."),
        ("map_d grey.png # the mask", "####...."),
        ("map_d -s 2 1 1 grey.png", "##..##.."),
        ("map_d -S 4 grey.png", "#.#.#.#."),
        ("map_d -o 0.5 0 0 grey.png", "....####"),
        ("map_d -s 2 1 1 -o 0.25 0 0 grey.png", "#..##..#"),
        ("map_d -mm 1 -1 grey.png", "....####"),
        ("map_d -imfchan m grey.png", "########"),
        ("map_Kd half.png", "####...."),
        ("map_Kd red.png\nmap_d grey.png", "####...."),
        ("map_Kd -o 0.5 half.png\nmap_d -o 0.5 grey.png", "....####"),
        ("map_Kd red.png", "########"),
    ] {
        let (model, said) = painted(map);
        assert_eq!(solid(&model), expected, "{map}");
        assert_eq!(said, [""; 0], "{map}");
    }
}

#[test]
fn v_is_scaled_and_moved_from_the_bottom() {
    let (model, _) = painted("map_d -s 1 2 1 -o 0 0.25 0 grey.png");
    // (v * 2 + 0.25) up is 1 - that down.
    assert_eq!(model.meshes[0].uvs, [vec2(0.0, 0.75), vec2(1.0, 0.75), vec2(1.0, -1.25), vec2(0.0, -1.25)]);
}

#[test]
fn tr_beside_d_does_not_hide_a_surface() {
    for both in ["d 1.0\nTr 1.0", "Tr 1.0\nd 1.0", "D 1\nTR 1"] {
        let (model, said) = painted(both);
        assert_eq!((model.materials[0].alpha_cutoff, model.materials[0].base_color.w), (None, 1.0), "{both}");
        assert_logged(&said, &[&["a.mtl, material \"m\"", "d and Tr contradict each other"]]);
    }
    assert_eq!(painted("d 0.7\nTr 0.3").1, [""; 0], "they agree");
}

#[test]
fn a_surface_that_vanishes_is_named() {
    for hidden in ["Tr 1", "d 0.2", "d 0\nTr 1"] {
        let (model, said) = painted(hidden);
        assert!(model.materials[0].base_color.w < 0.5);
        assert_logged(&said, &[&["a.obj, material \"m\"", "cast no shadow"]]);
    }
}

#[test]
fn what_is_not_read_is_named() {
    for (library, parts) in [
        ("map_Kd none.png", ["material \"m\"", "alpha of map_Kd"]),
        ("map_Kd -s 2 2 2 red.png\nmap_d grey.png", ["material \"m\", red.png", "map_Kd is left out"]),
        ("map_Tr grey.png", ["line 2", "map_Tr"]),
        ("disp bump.png", ["line 2", "displacement"]),
        ("d -halo 0.9", ["line 2", "-halo"]),
        ("map_d -t 1 1 1 grey.png", ["line 2", "turbulence"]),
        ("map_d -imfchan z grey.png", ["line 2", "imfchan"]),
        ("map_Kd gone.png", ["a.mtl", "gone.png"]),
    ] {
        assert_logged(&painted(library).1, &[&parts]);
    }
    assert_eq!(solid(&painted("map_Kd -s 2 2 2 red.png\nmap_d grey.png").0), "####....", "the mask counts");
    assert_eq!(solid(&painted("map_Kd none.png").0), "########");
}
