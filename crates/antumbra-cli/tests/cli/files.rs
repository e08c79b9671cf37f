//! What `render` and `reference` write.

use crate::meshes::animal;
use crate::{Place, is_png};
use npyz::NpyFile;

/// Shape and values of a float32 array.
fn npy(place: &Place, name: &str) -> (Vec<u64>, Vec<f32>) {
    let bytes = place.bytes(name);
    let file = NpyFile::new(&bytes[..]).expect("an npy file");
    assert_eq!(file.order(), npyz::Order::C);
    assert_eq!(file.dtype().descr(), "'<f4'");
    (file.shape().to_vec(), file.into_vec().expect("float32"))
}

#[test]
fn render_writes_an_image_its_visibility_and_its_stats() {
    let place = Place::new();
    let scene = place.file("animal.obj", animal());
    let run = place.succeeds(&format!(
        "render {scene} -t hard:map=256 --size 96x64 -o out.png --visibility v.npy --stats s.json --frames 3"
    ));
    assert_eq!((run.stdout.as_str(), run.stderr.as_str()), ("", ""));
    assert_eq!(place.names(), ["animal.obj", "out.png", "s.json", "v.npy"]);
    assert!(is_png(&place.path("out.png")));

    let (shape, values) = npy(&place, "v.npy");
    assert_eq!(shape, [64, 96]);
    assert!(values.iter().all(|v| (0.0..=1.0).contains(v)));
    assert!(values.contains(&0.0) && values.contains(&1.0), "light and shadow");

    check_stats(&place.json("s.json"));
}

fn check_stats(stats: &serde_json::Value) {
    assert_eq!(stats["technique"], "hard");
    assert_eq!(stats["settings"]["map"], 256);
    assert_eq!([&stats["width"], &stats["height"]], [96, 64]);
    assert!(stats["adapter"].as_str().is_some_and(|a| !a.is_empty()));
    assert!(stats["triangles"].as_u64().is_some_and(|n| n > 1000));
    let passes = stats["passes"].as_array().expect("passes");
    let of = |key: &str, host: bool| {
        passes.iter().filter(|p| (p["host"] == true) == host).map(|p| p[key].as_f64().unwrap_or(0.0)).sum::<f64>()
    };
    assert!(passes.iter().all(|p| p["name"].is_string() && p["bytes"].is_u64()));
    assert!(passes.iter().any(|p| p["host"] == true), "the geometry buffer is the host's");
    assert_eq!(stats["total_bytes"].as_f64(), Some(of("bytes", false)));
    assert!(stats["total_bytes"].as_u64().is_some_and(|b| b >= 256 * 256 * 4));
    let (total, wall) = (stats["total_ms"].as_f64().expect("ms"), stats["wall_ms"].as_f64().expect("ms"));
    let expected = if stats["timing"] == "gpu" { of("ms", false) } else { wall };
    assert!(total > 0.0 && (total - expected).abs() < 1e-6, "{stats}");
}

#[test]
fn two_runs_give_the_same_bytes() {
    let place = Place::new();
    for t in ["a", "b"] {
        place.succeeds(&format!("render builtin:fence -t hard --size 64x64 -o {t}.png --visibility {t}.npy"));
        place.succeeds(&format!(
            "reference builtin:fence --size 64x64 --light-samples 64 --pixel-samples 4 --no-cache --visibility {t}.exr \
             --valid {t}-valid.npy"
        ));
    }
    for end in [".png", ".npy", ".exr", "-valid.npy"] {
        assert_eq!(place.bytes(&format!("a{end}")), place.bytes(&format!("b{end}")), "{end}");
    }
}

#[test]
fn formats_agree() {
    let place = Place::new();
    let trace = "reference builtin:fence --size 40x30 --light-samples 64 --pixel-samples 4 --visibility";
    for file in ["v.npy", "v.exr", "v.png"] {
        place.succeeds(&format!("{trace} {file}"));
    }
    let (shape, values) = npy(&place, "v.npy");
    assert_eq!(shape, [30, 40]);

    let exr = exr::prelude::read_first_flat_layer_from_file(place.path("v.exr")).expect("an EXR");
    let channels = &exr.layer_data.channel_data.list;
    assert_eq!((channels.len(), channels[0].name.to_string().as_str()), (1, "Y"));
    assert_eq!(channels[0].sample_data.values_as_f32().collect::<Vec<_>>(), values);

    let png = image::open(place.path("v.png")).expect("a PNG");
    assert_eq!(png.color(), image::ColorType::L16);
    let grey = png.into_luma16();
    assert_eq!(grey.dimensions(), (40, 30));
    assert!(grey.iter().zip(&values).all(|(g, v)| (f32::from(*g) / 65535.0 - v).abs() < 1e-5));
}

#[test]
fn the_reference_prints_its_error_and_is_cached() {
    let place = Place::new();
    let trace = "reference builtin:square --size 48x48 --light-samples 256 --visibility v.npy --valid m.npy";
    let first = place.succeeds(trace);
    assert!(first.stdout.contains("estimated error 0.0"), "{first:?}");
    assert!(first.stdout.contains("million shadow rays"), "{first:?}");
    let (v, m) = (place.bytes("v.npy"), npy(&place, "m.npy"));
    assert_eq!(m.0, [48, 48]);
    assert!(m.1.iter().all(|v| *v == 0.0 || *v == 1.0) && m.1.contains(&1.0));

    let second = place.succeeds(trace);
    assert!(second.stdout.contains("read from the cache"), "{second:?}");
    assert_eq!(place.bytes("v.npy"), v);
    let third = place.succeeds(&format!("{trace} --seed 1"));
    assert!(!third.stdout.contains("cache"), "another seed gives another image: {third:?}");
}

#[test]
fn a_larger_light_softens_and_an_old_file_is_replaced() {
    let place = Place::new();
    place.file("v.npy", "old");
    let penumbra = |light: &str| {
        let render = "reference builtin:square --size 48x48 --light-samples 64 --pixel-samples 1 --visibility v.npy";
        place.succeeds(&format!("{render} --light-size {light}"));
        npy(&place, "v.npy").1.iter().filter(|v| **v > 0.02 && **v < 0.98).count()
    };
    let (point, wide) = (penumbra("0"), penumbra("1x1"));
    assert_eq!(point, 0, "a point has no penumbra");
    assert!(wide > 20, "{wide}");
}

#[cfg(unix)]
#[test]
fn files_are_as_readable_as_others() {
    use std::os::unix::fs::PermissionsExt;
    let place = Place::new();
    place.file("other", "");
    place.succeeds("reference builtin:square --size 8x8 --light-samples 1 --pixel-samples 1 --visibility v.npy");
    let mode = |name: &str| std::fs::metadata(place.path(name)).expect("a file").permissions().mode();
    assert_eq!(mode("v.npy"), mode("other"));
}
