//! Techniques against known answers and against the ray-traced truth. Every check has a sibling in which a setting is
//! broken on purpose and must be caught: a comparison that nothing can fail proves nothing.

mod common;

use antumbra::techniques::TECHNIQUES;
use antumbra_reference::Reference;
use antumbra_scene::Scene;
use common::closed_form::{Occluder, ground_points};
use common::{builtin, camera, compared, cuboid, drawn, ground, light, scene, shadowed, technique, truth, visibility};
use glam::DVec3;
use std::sync::OnceLock;

/// Mean, maximum and number of some errors.
#[derive(Debug, Default)]
struct Errors {
    mean: f64,
    max: f64,
    count: usize,
}

impl Errors {
    fn of(errors: impl Iterator<Item = f64>) -> Errors {
        let mut e = errors.fold(Errors::default(), |e, x| Errors {
            mean: e.mean + x,
            max: e.max.max(x.abs()),
            count: e.count + 1,
        });
        e.mean /= e.count.max(1) as f64;
        e
    }
}

/// A visibility by a technique with a map of 512 texels, if it has a map.
fn quick(scene: &Scene, name: &str, size: [u32; 2]) -> Vec<f32> {
    let has_map = TECHNIQUES.iter().any(|t| t.name == name && t.settings.iter().any(|s| s.key == "map"));
    visibility(scene, &if has_map { format!("{name}:map=512") } else { name.to_owned() }, size)
}

// ---- fully lit, fully shadowed ----

const SIZE: [u32; 2] = [96, 96];

/// A plane under a large blocker whose umbra fills the picture.
fn umbra(blocker_half: f32) -> Scene {
    let blocker = Occluder { center: [0.0, 1.0, 0.0], half: [blocker_half; 2] };
    blocker.scene(camera([0.4, 0.8, 0.6], [0.0, 0.0, 0.0], 50.0), light([0.0, 3.0, 0.0], [0.0; 3], 0.6))
}

#[test]
fn a_lit_plane_is_lit_by_every_technique() {
    let scene =
        scene(vec![ground(20.0)], camera([0.4, 0.8, 0.6], [0.0; 3], 50.0), light([1.0, 3.0, 0.0], [0.0; 3], 0.6));
    for t in TECHNIQUES {
        let darkest = quick(&scene, t.name, SIZE).into_iter().fold(1.0, f32::min);
        assert!(darkest == 1.0, "{}: the darkest pixel of a lit plane sees {darkest} of the light", t.name);
    }
}

#[test]
fn a_plane_under_a_large_blocker_is_dark_by_every_technique() {
    for t in TECHNIQUES {
        let brightest = quick(&umbra(6.0), t.name, SIZE).into_iter().fold(0.0, f32::max);
        assert!(brightest < 1e-6, "{}: the brightest pixel of an umbra sees {brightest} of the light", t.name);
    }
}

#[test]
fn a_blocker_that_is_too_small_is_caught() {
    for t in TECHNIQUES {
        let brightest = quick(&umbra(0.1), t.name, SIZE).into_iter().fold(0.0, f32::max);
        assert!(brightest > 0.9, "{}: all is dark ({brightest}) under a blocker of 20 cm", t.name);
    }
}

// ---- a square over a plane ----

const SQUARE: Occluder = Occluder { center: [0.0, 1.0, 0.0], half: [0.5, 0.5] };

fn square(light_edge: f32) -> Scene {
    SQUARE.scene(camera([1.2, 1.1, 2.3], [0.0, 0.0, 0.35], 45.0), light([0.0, 3.0, 0.0], [0.0; 3], light_edge))
}

/// Errors of `spec` under a light of `edge` where the truth has one of 80 cm: over the penumbra, and along the
/// picture's row that has most of it.
fn square_errors(spec: &str, edge: f32) -> [Errors; 2] {
    let size = [128, 128];
    let exact = SQUARE.image(&square(0.8), size);
    let got = visibility(&square(edge), spec, size);
    let penumbra = |i: usize| exact[i].is_some_and(|e| e > 0.001 && e < 0.999);
    let errors = |pixels: &mut dyn Iterator<Item = usize>| {
        Errors::of(pixels.filter(|i| penumbra(*i)).map(|i| (f64::from(got[i]) - exact[i].unwrap_or(1.0)).abs()))
    };
    let row = |y: usize| y * 128..(y + 1) * 128;
    let fullest = (0..128).max_by_key(|y| row(*y).filter(|i| penumbra(*i)).count()).unwrap_or(0);
    [errors(&mut (0..exact.len())), errors(&mut row(fullest))]
}

#[test]
fn pcss_of_a_square_over_a_plane_is_the_closed_form() {
    // The occluder is parallel to the light, where the estimate by similar triangles is exact: what is left is the
    // map's raster, a texel being 1 % of the penumbra's width, and the layers' rounding of the square's edge.
    let [all, row] = square_errors("pcss:map=1024", 0.8);
    println!("over the penumbra {all:?}, along the row {row:?}");
    assert!(all.count > 2000 && all.mean < 0.003 && all.max < 0.01, "over the penumbra: {all:?}");
    assert!(row.count > 50 && row.mean < 0.003 && row.max < 0.01, "along the row: {row:?}");
}

#[test]
fn broken_settings_of_the_square_are_caught() {
    for (what, spec, edge) in [
        ("a light of four times the size", "pcss:map=1024", 3.2),
        ("a light of half the size", "pcss:map=1024", 0.4),
        ("a map of 16 texels", "pcss:map=16", 0.8),
        ("no penumbra", "hard:map=1024", 0.8),
    ] {
        let [all, row] = square_errors(spec, edge);
        assert!(all.mean > 0.03 && row.max > 0.1, "{what} went through: {all:?}, along the row {row:?}");
    }
}

// ---- a straight edge ----

/// Width of the penumbra of a straight edge, from the distance between visibilities of 0.2 and 0.8: the light is 3 m
/// above the edge, the ground 1 m below it, so it is a third of the light's width [similar triangles].
fn penumbra_width(spec: &str, light_edge: f32) -> f64 {
    let edge = Occluder { center: [-10.0, 1.0, 0.0], half: [10.0, 20.0] };
    // Ten times as wide as high: 5 mm a pixel, 80 cm a row.
    let view = camera([1.0, 0.9, 0.0], [1.0, 0.0, 0.0], 5.0);
    let scene = edge.scene(view, light([-3.0, 4.0, 0.0], [-3.0, 0.0, 0.0], light_edge));
    let size = [160, 16];
    let (got, points) = (visibility(&scene, spec, size), ground_points(&scene.camera, size));
    let row: Vec<(f64, f64)> = (8 * 160..9 * 160).map(|i| (points[i].expect("below").x, f64::from(got[i]))).collect();
    let crossing = |v: f64| {
        let pair = row.windows(2).find(|p| p[0].1 <= v && p[1].1 > v);
        let pair = pair.unwrap_or_else(|| panic!("{spec}: the profile never rises over {v}: {row:?}"));
        pair[0].0 + (pair[1].0 - pair[0].0) * (v - pair[0].1) / (pair[1].1 - pair[0].1)
    };
    (crossing(0.8) - crossing(0.2)) / 0.6
}

#[test]
fn the_penumbra_of_a_straight_edge_is_as_wide_as_similar_triangles_say() {
    for light_edge in [0.3f32, 0.9] {
        let (got, exact) = (penumbra_width("pcss:map=1024", light_edge), f64::from(light_edge) / 3.0);
        println!("light of {light_edge} m: {got:.4} m, exact {exact:.4} m");
        assert!((got / exact - 1.0).abs() < 0.06, "light of {light_edge} m: {got:.4} m instead of {exact:.4} m");
    }
}

#[test]
fn an_edge_without_penumbra_is_caught() {
    for (spec, light_edge) in [("hard:map=1024", 0.9), ("pcss:map=1024", 1.8), ("pcf:map=1024,pcf=9", 0.9)] {
        let got = penumbra_width(spec, light_edge);
        assert!((got / 0.3 - 1.0).abs() > 0.06, "{spec} under {light_edge} m: {got:.4} m passes for 0.3 m");
    }
}

// ---- a thin plate on the ground ----

/// A plate of 1 cm that stands on the ground, and its shadow towards the camera.
fn plate() -> &'static (Scene, Reference) {
    static PLATE: OnceLock<(Scene, Reference)> = OnceLock::new();
    PLATE.get_or_init(|| {
        let meshes = vec![ground(20.0), cuboid([-0.8, 0.0, -0.005], [0.8, 0.7, 0.005])];
        let scene =
            scene(meshes, camera([0.3, 1.3, 2.0], [0.0, 0.1, 0.3], 45.0), light([0.5, 3.0, -3.5], [0.0; 3], 0.8));
        let truth = truth(&scene, [128, 128], 256);
        (scene, truth)
    })
}

/// Mean of the signed error within `strip` metres in front of the plate's foot: over 0 if light leaks under it.
fn leak_at_the_plate(spec: &str, strip: f64) -> Errors {
    let (scene, truth) = plate();
    let got = visibility(scene, spec, [128, 128]);
    let near = |p: DVec3| p.x.abs() < 0.7 && p.z > 0.005 && p.z < 0.005 + strip;
    strip_errors(scene, truth, &got, near)
}

/// Signed errors on the part of the ground that `near` accepts and nothing hides from the camera.
fn strip_errors(scene: &Scene, truth: &Reference, got: &[f32], near: impl Fn(DVec3) -> bool) -> Errors {
    let size = [truth.width, truth.height];
    let tracer = antumbra_reference::Tracer::new(scene);
    let eye = scene.camera.eye;
    let points = ground_points(&scene.camera, size);
    let seen = |p: DVec3| {
        let hit = tracer.nearest(&antumbra_reference::Ray::new(eye, p.as_vec3() - eye));
        hit.is_some_and(|h| h.position.y.abs() < 1e-3)
    };
    let inside = |i: &usize| truth.valid[*i] && points[*i].is_some_and(|p| near(p) && seen(p));
    let error = |i: usize| f64::from(got[i]) - f64::from(truth.visibility[i]);
    Errors::of((0..got.len()).filter(inside).map(error))
}

#[test]
fn no_light_leaks_under_a_thin_plate() {
    for spec in ["hard:map=1024", "pcf:map=1024", "pcss:map=1024"] {
        let e = leak_at_the_plate(spec, 0.05);
        println!("{spec} at the plate: {e:?}");
        assert!(e.count > 50 && e.mean < 0.01, "{spec}: signed error at the plate's foot {e:?}");
    }
}

#[test]
fn a_map_too_coarse_for_the_plate_is_caught() {
    let e = leak_at_the_plate("pcss:map=16", 0.05);
    assert!(e.mean > 0.01, "a map of 16 texels went through: {e:?}");
}

// ---- scenes ----

/// The fence and a bumpy ball, with their truths.
fn soft_scenes() -> &'static [(Scene, Reference); 2] {
    static SCENES: OnceLock<[(Scene, Reference); 2]> = OnceLock::new();
    SCENES.get_or_init(|| {
        let ball = vec![ground(20.0), common::bumpy_ball([0.0, 0.95, 0.0], 0.8, 5)];
        let view = camera([1.9, 2.0, 2.8], [0.0, 0.5, 0.0], 42.0);
        let mut ball = scene(ball, view, light([1.5, 5.0, 1.0], [0.0, 0.5, 0.0], 1.0));
        ball.name = "bumpy ball".into();
        [builtin("fence"), ball].map(|scene| {
            let truth = truth(&scene, [160, 160], 256);
            (scene, truth)
        })
    })
}

#[test]
fn pcss_has_less_than_half_the_error_of_a_hard_shadow() {
    for (scene, truth) in soft_scenes() {
        let error = |spec: &str| compared(&visibility(scene, spec, [160, 160]), truth).average_error;
        let (hard, pcss) = (error("hard:map=2048"), error("pcss:map=2048"));
        println!("{}: pcss {pcss:.4}, hard {hard:.4}", scene.name);
        assert!(pcss < 0.5 * hard, "{}: pcss {pcss:.4}, hard {hard:.4}", scene.name);
    }
}

#[test]
fn pcss_under_a_light_of_four_times_the_size_is_caught() {
    for (scene, truth) in soft_scenes() {
        let mut broken = scene.clone();
        broken.light.size *= 4.0;
        let hard = compared(&visibility(scene, "hard:map=2048", [160, 160]), truth).average_error;
        let pcss = compared(&visibility(&broken, "pcss:map=2048", [160, 160]), truth).average_error;
        assert!(
            pcss > 0.5 * hard,
            "{}: a light of four times the size went through: {pcss:.4}, hard {hard:.4}",
            scene.name
        );
    }
}

/// Signed error on the ground within 10 cm of the slats' feet, on the side of the shadow.
fn error_at_the_feet(spec: &str) -> Errors {
    let (scene, truth) = &soft_scenes()[0];
    let got = visibility(scene, spec, [160, 160]);
    strip_errors(scene, truth, &got, |p| p.x.abs() < 2.9 && p.z > 0.015 && p.z < 0.115)
}

#[test]
fn the_shadow_of_the_fence_is_not_detached_from_its_feet() {
    for spec in ["hard", "pcf", "pcss"] {
        let e = error_at_the_feet(spec);
        println!("{spec} at the feet: {e:?}");
        assert!(e.count > 100 && e.mean < 0.02, "{spec}: signed error at the feet {e:?}");
    }
}

#[test]
fn a_detached_shadow_of_the_fence_is_caught() {
    let e = error_at_the_feet("pcss:map=64");
    assert!(e.mean > 0.05, "a map of 64 texels went through: {e:?}");
}

// ---- acne ----

fn rolling() -> &'static [(Scene, Reference); 2] {
    static SCENES: OnceLock<[(Scene, Reference); 2]> = OnceLock::new();
    SCENES.get_or_init(|| {
        ["bumpy", "grid"].map(|name| {
            let scene = builtin(name);
            let truth = truth(&scene, [128, 128], 128);
            (scene, truth)
        })
    })
}

/// Mean darkness of lit pixels that are more than two pixels away from any shadow: what the width of a kernel darkens
/// beside a shadow's edge is no acne.
fn acne_far_from_shadows(got: &[f32], truth: &Reference) -> Errors {
    let (w, h) = (truth.width as i32, truth.height as i32);
    let lit = |x: i32, y: i32| {
        let i = (y.clamp(0, h - 1) * w + x.clamp(0, w - 1)) as usize;
        truth.valid[i] && truth.visibility[i] > antumbra_metrics::LIT_ABOVE
    };
    let far = |i: &usize| {
        let (x, y) = (*i as i32 % w, *i as i32 / w);
        (-2..=2).all(|dy| (-2..=2).all(|dx| lit(x + dx, y + dy)))
    };
    Errors::of((0..got.len()).filter(far).map(|i| 1.0 - f64::from(got[i])))
}

#[test]
fn lit_hills_are_free_of_acne() {
    for (scene, truth) in rolling() {
        let renderer = drawn(scene, [128, 128]);
        for spec in ["hard", "pcf", "pcss"] {
            let got = shadowed(&renderer, &mut technique(spec)).unwrap_or_else(|e| panic!("{spec}: {e}"));
            let (all, far) = (compared(&got, truth), acne_far_from_shadows(&got, truth));
            println!(
                "{} by {spec}: error {:.4}, acne {:.5}, far from shadows {far:?}",
                scene.name, all.average_error, all.acne
            );
            assert!(all.counts.lit > 1000 && far.count > 300, "{}: {:?}, {far:?}", scene.name, all.counts);
            assert!(far.mean < 0.002, "{} by {spec}: acne far from shadows {far:?}", scene.name);
            // A kernel of five texels darkens the rim of contact shadows, which are narrower.
            let bound = if spec == "pcf" { 0.004 } else { 0.002 };
            assert!(all.acne < bound, "{} by {spec}: acne {:.5}", scene.name, all.acne);
        }
    }
}

#[test]
fn false_darkness_on_lit_hills_is_caught() {
    for (scene, truth) in rolling() {
        let mut got = visibility(scene, "pcss", [128, 128]);
        // Every hundredth pixel is dark: what acne looks like.
        got.iter_mut().step_by(100).for_each(|v| *v = 0.0);
        let (all, far) = (compared(&got, truth).acne, acne_far_from_shadows(&got, truth));
        assert!(all > 0.004 && far.mean > 0.002, "{}: a dark hundredth went through: {all:.5}, {far:?}", scene.name);
    }
}
