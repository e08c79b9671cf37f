//! The hard shadow is that of the rays.

use super::common::{builtin, compared, drawn, shadowed, technique, truth, visibility};
use super::{differing, with_point_light};
use antumbra_scene::builtin::list;

const SIZE: [u32; 2] = [256, 160];

/// Built-in scenes with fewer triangles where they have very many.
fn small(name: &str) -> String {
    match name {
        "bumpy" => "bumpy:side=120".to_owned(),
        "forest" => "forest:trees=12".to_owned(),
        _ => name.to_owned(),
    }
}

#[test]
fn every_scene_has_the_shadow_of_the_rays_in_all_but_one_of_ten_thousand_pixels() {
    let mut faults = Vec::new();
    let (mut pixels, mut wrong_in_all) = (0, 0);
    for info in list() {
        let scene = with_point_light(builtin(&small(info.name)));
        let truth = truth(&scene, SIZE, 1);
        let found = visibility(&scene, "alias-free", SIZE);
        let valid = truth.valid.iter().filter(|v| **v).count();
        let wrong = differing(&found, &truth.visibility, &truth.valid);
        println!("{}: {wrong} of {valid} pixels, {} triangles", scene.name, scene.triangle_count());
        (pixels, wrong_in_all) = (pixels + valid, wrong_in_all + wrong);
        // Single pixels on shared edges: a picture of this size affords 4.
        if wrong > 4 {
            faults.push(format!("{}: {wrong} of {valid} pixels differ", scene.name));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(wrong_in_all * 10_000 <= pixels, "{wrong_in_all} of {pixels} pixels differ");
}

#[test]
fn the_picture_does_not_depend_on_the_map() {
    let renderer = drawn(&with_point_light(builtin("cage")), SIZE);
    let by = |spec: &str| shadowed(&renderer, &mut *technique(spec)).unwrap_or_else(|e| panic!("{spec}: {e}"));
    let fine = by("alias-free:map=2048");
    for spec in ["alias-free", "alias-free:map=500", "alias-free:map=67", "alias-free:map=16"] {
        assert!(by(spec) == fine, "{spec} differs from 2048 texels");
    }
}

#[test]
fn more_points_a_pixel_tend_to_the_mean_over_the_pixel() {
    let scene = with_point_light(builtin("fence:slats=9"));
    let size = [96, 64];
    let settings = antumbra_reference::Settings {
        light_samples: 64,
        pixel_samples: 64,
        ..antumbra_reference::Settings::of_size(size[0], size[1])
    };
    let never = std::sync::atomic::AtomicBool::new(false);
    let mean = antumbra_reference::trace(&scene, &settings, &|_| (), &never).expect("traces");
    let errors = ["alias-free", "alias-free:samples=4", "alias-free:samples=16", "alias-free:samples=64"].map(|spec| {
        let figures = compared(&visibility(&scene, spec, size), &mean);
        println!("{spec}: {:.4}", figures.average_error);
        figures.average_error
    });
    assert!(errors.windows(2).all(|e| e[1] < 0.7 * e[0]), "{errors:?}");
    assert!(errors[3] < 0.016, "{errors:?}");
}
