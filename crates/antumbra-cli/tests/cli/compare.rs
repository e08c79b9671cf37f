//! What `compare` prints and writes.

use crate::meshes::animal;
use crate::{Place, is_png};

fn compare(place: &Place, scene: &str, more: &str) -> serde_json::Value {
    let quick = "--size 128x128 --light-samples 256 --pixel-samples 4 --frames 1";
    let run = place.succeeds(&format!("compare {scene} -o deep/report {quick} {more}"));
    let last = run.stdout.lines().last().expect("a line");
    assert!(last.contains("deep/report/index.html"), "{run:?}");
    for head in ["avg error", "RMSE", "p99", "leak", "acne", "SSIM", "FLIP", "ms", "MB"] {
        assert!(run.stdout.contains(head), "{head} in {}", run.stdout);
    }
    place.json("deep/report/results.json")
}

fn average_error(results: &serde_json::Value, technique: &str) -> f64 {
    let entries = results["techniques"].as_array().expect("techniques");
    let entry = entries.iter().find(|e| e["technique"] == technique).expect("the technique");
    entry["figures"]["average_error"].as_f64().expect("a figure")
}

#[test]
fn the_report_is_whole() {
    let place = Place::new();
    let results = compare(&place, "builtin:fence", "-t hard -t hard:map=64");
    let report = place.path("deep/report");
    for file in ["index.html", "results.json", "results.csv"] {
        assert!(report.join(file).metadata().expect("a file").len() > 100, "{file}");
    }
    let pictures: Vec<_> = std::fs::read_dir(report.join("pictures")).expect("a folder").flatten().collect();
    assert!(pictures.len() >= 8 && pictures.iter().all(|p| is_png(&p.path())), "{pictures:?}");
    assert_eq!(results["techniques"].as_array().map(Vec::len), Some(2));
    assert_eq!(place.names(), ["deep"]);
}

#[test]
fn all_techniques_are_compared() {
    let place = Place::new();
    let results = compare(&place, "builtin:square", "-t all");
    let known: serde_json::Value =
        serde_json::from_str(&place.succeeds("techniques --json").stdout).expect("a JSON list");
    let names = |list: &serde_json::Value, key: &str| -> Vec<String> {
        list.as_array().expect("a list").iter().map(|t| t[key].to_string()).collect()
    };
    assert_eq!(names(&results["techniques"], "technique"), names(&known, "name"));
}

#[test]
fn soft_shadows_are_nearer_to_the_truth_than_hard_ones() {
    let place = Place::new();
    for scene in ["builtin:fence".to_owned(), place.file("animal.obj", animal())] {
        let results = compare(&place, &scene, "-t hard -t pcss");
        let (hard, pcss) = (average_error(&results, "hard"), average_error(&results, "pcss"));
        println!("{scene}: pcss {pcss:.4}, hard {hard:.4}");
        assert!(pcss < 0.5 * hard, "{scene}: pcss {pcss}, hard {hard}");
    }
}
