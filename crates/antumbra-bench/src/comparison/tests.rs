//! The report as a whole, on a synthetic comparison.

use super::*;
use crate::ReportError;
use crate::measure::{Cost, Pass, Timing};
use antumbra_metrics::{Counts, Image, RgbImage, error_metrics, heat_map, metrics};
use std::fs;

const W: u32 = 64;
const H: u32 = 48;

/// A box's shadow with a penumbra `softness` pixels wide.
fn shadow(softness: f32) -> Vec<f32> {
    let pixel = |i: u32| {
        let (x, y) = ((i % W) as f32 - 32.0, (i / W) as f32 - 24.0);
        (0.5 + (x.abs().max(y.abs()) - 12.0) / softness).clamp(0.0, 1.0)
    };
    (0..W * H).map(pixel).collect()
}

fn image(visibility: &[f32]) -> RgbImage {
    let data = visibility.iter().flat_map(|v| [(v * 240.0) as u8, (v * 220.0) as u8, 90]).collect();
    RgbImage { width: W, height: H, data }
}

fn entry(spec: &str, softness: f32, ms: f64) -> Entry {
    let (test, truth, valid) = (shadow(softness), shadow(6.0), vec![true; (W * H) as usize]);
    let (test_image, truth_image) = (Image::new(W, H, &test).unwrap(), Image::new(W, H, &truth).unwrap());
    let pass = |name: &str, share: f64, host| Pass { name: name.into(), ms: Some(ms * share), bytes: 4 << 20, host };
    Entry {
        technique: spec.split(':').next().unwrap().into(),
        title: "A technique <of> tests".into(),
        source: "Nobody & Co 2007".into(),
        spec: spec.into(),
        settings: serde_json::json!({"map": 2048, "format": "r32float"}),
        metrics: metrics(test_image, truth_image, &valid).unwrap(),
        grazing: error_metrics(test_image, truth_image, &valid).ok(),
        cost: Cost {
            passes: vec![pass("geometry", 0.5, true), pass("shadow map", 0.3, false), pass("filter", 0.7, false)],
            total_ms: ms,
            total_bytes: 8 << 20,
            wall_ms: ms,
            timing: Timing::Gpu,
        },
        image: image(&test),
        heat_map: heat_map(test_image, truth_image, &valid).unwrap(),
        visibility: test,
    }
}

fn report(entries: Vec<Entry>) -> Comparison {
    let truth = Reference {
        visibility: shadow(6.0),
        image: image(&shadow(6.0)),
        light_samples: 1024,
        pixel_samples: 16,
        seconds: 12.0,
        error_estimate: 0.0007,
        summary: String::new(),
    };
    Comparison {
        scene: "builtin:fence".into(),
        triangles: 1234,
        width: W,
        height: H,
        adapter: "llvmpipe (LLVM 15)".into(),
        software: true,
        command: "antumbra compare builtin:fence -t hard -t pcf".into(),
        truth,
        entries,
    }
}

fn three() -> Comparison {
    report(vec![entry("hard", 0.5, 0.8), entry("pcf:map=512", 3.0, 1.4), entry("pcf:map=1024", 6.0, 2.5)])
}

#[test]
fn all_files_are_there_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let to = folder.path().join("deep/report");
    write(&three(), &to).unwrap();
    write(&three(), &to).unwrap(); // again, over the first
    let list = |path: &std::path::Path| {
        let mut names: Vec<_> =
            fs::read_dir(path).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    };
    assert_eq!(list(&to), ["index.html", "pictures", "results.csv", "results.json"]);
    let pictures = list(&to.join("pictures"));
    assert_eq!(pictures.len(), 3 * 3 + 2);
    for name in &pictures {
        let png = image::open(to.join("pictures").join(name)).unwrap();
        assert_eq!((png.width(), png.height()), (W, H));
    }
    let json: serde_json::Value = serde_json::from_slice(&fs::read(to.join("results.json")).unwrap()).unwrap();
    for technique in json["techniques"].as_array().unwrap() {
        for place in technique["pictures"].as_object().unwrap().values() {
            assert!(to.join(place.as_str().unwrap()).exists());
        }
    }
}

#[test]
fn numbers_arrive_in_json_and_csv() {
    let folder = tempfile::tempdir().unwrap();
    let report = three();
    write(&report, folder.path()).unwrap();
    let json: serde_json::Value =
        serde_json::from_slice(&fs::read(folder.path().join("results.json")).unwrap()).unwrap();
    assert_eq!(json["truth"]["light_samples"], 1024);
    let pcf = &json["techniques"][1];
    assert_eq!(pcf["spec"], "pcf:map=512");
    assert_eq!(pcf["figures"]["average_error"], report.entries[1].metrics.average_error);
    assert_eq!(pcf["passes"][0]["host"], true);

    let mut csv = csv::Reader::from_path(folder.path().join("results.csv")).unwrap();
    let column = csv.headers().unwrap().iter().position(|h| h == "rmse").unwrap();
    let rows: Vec<_> = csv.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), 3);
    assert_eq!(rows[2][column].parse::<f64>().unwrap(), report.entries[2].metrics.rmse);
}

#[test]
fn the_page_has_no_external_resources_and_escapes_text() {
    let folder = tempfile::tempdir().unwrap();
    let mut report = three();
    report.scene = "<script>alert(1)</script>".into();
    write(&report, folder.path()).unwrap();
    let page = fs::read_to_string(folder.path().join("index.html")).unwrap();
    assert!(!page.contains("http://") && !page.contains("https://") && !page.contains("@import"));
    assert!(!page.contains("<script>alert") && page.contains("A technique &lt;of&gt; tests"));
    assert!(!page.contains("NaN") && page.matches("data:image/png;base64,").count() == 3 * 3 + 2);
    assert!(page.contains("say nothing about a GPU"));
}

#[test]
fn names_are_unique() {
    let report = report(vec![entry("pcf", 1.0, 1.0), entry("pcf", 1.0, 1.0), entry("hard:map=512", 1.0, 1.0)]);
    assert_eq!(report.labels(), ["pcf", "pcf (2)", "hard"]);
    let slugs: Vec<_> = images::encode(&report).unwrap().into_iter().map(|p| p.slug).collect();
    assert_eq!(slugs, ["truth", "pcf", "pcf-2", "hard-map-512"]);
}

#[test]
fn a_class_without_pixels_has_a_dash() {
    let folder = tempfile::tempdir().unwrap();
    let mut report = report(vec![entry("hard", 1.0, 1.0)]);
    report.entries[0].metrics.counts = Counts { valid: 9, lit: 9, ..Counts::default() };
    write(&report, folder.path()).unwrap();
    let page = fs::read_to_string(folder.path().join("index.html")).unwrap();
    assert!(page.contains("The picture has no such pixels"));
}

#[test]
fn a_picture_of_another_size_is_refused_and_nothing_is_left() {
    let folder = tempfile::tempdir().unwrap();
    let to = folder.path().join("report");
    let mut report = three();
    report.entries[1].visibility.pop();
    let error = write(&report, &to).unwrap_err();
    assert!(matches!(&error, ReportError::Size { image: "visibility", spec, .. } if spec == "pcf:map=512"), "{error}");
    assert!(!to.exists());
}

#[test]
fn an_unwritable_place_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "kept").unwrap();
    let error = write(&three(), &file).unwrap_err();
    assert!(error.to_string().contains("file") && error.to_string().contains("-o"), "{error}");
    assert_eq!(fs::read_to_string(&file).unwrap(), "kept");
}
