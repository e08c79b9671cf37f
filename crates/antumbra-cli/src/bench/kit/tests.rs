//! The files of a suite, with made-up numbers, and a trial, with true ones.

use super::*;
use crate::cli::{BenchArgs, Cli, Command};
use crate::measure::{Cost, Timing};
use crate::report::lines::{Curve, Spot};
use crate::report::{Lines, Point};
use antumbra_metrics::{Image, RgbImage, figures};
use antumbra_scene::Scene;
use clap::Parser;
use std::fs;

/// A run that took this long; its techniques and figures do not matter.
pub fn run(spec: &str, ms: f64, work: &[(&'static str, f64)]) -> Run {
    let (test, truth) = ([0.5, 0.25, 1.0, 0.0], [0.5, 0.5, 1.0, 0.0]);
    let image = |values| Image::new(2, 2, values).unwrap();
    Run {
        technique: "pcf",
        spec: spec.into(),
        settings: serde_json::json!({"map": 512}),
        figures: figures(image(&test), image(&truth), &[true; 4]).unwrap(),
        work: work.iter().copied().collect(),
        cost: Cost { passes: Vec::new(), total_ms: ms, total_bytes: 1 << 20, wall_ms: 2.0 * ms, timing: Timing::Gpu },
        picture: None,
    }
}

/// A trial of these runs.
pub fn trial(name: &str, runs: Vec<Run>) -> Trial {
    Trial {
        name: name.into(),
        scene: "builtin:fence".into(),
        triangles: 4662,
        width: 2,
        height: 2,
        penumbra: 0.08,
        light_samples: 1024,
        pixel_samples: 16,
        truth_error: 0.001,
        frames: 3,
        picture: RgbImage { width: 2, height: 2, data: vec![200; 12] },
        runs,
    }
}

fn context() -> Context {
    Context {
        suite: "made-up",
        title: "A <made-up> suite",
        source: "Nobody 2007",
        adapter: "llvmpipe (LLVM 15) | *".into(),
        software: true,
        command: "antumbra bench made-up -o results".into(),
        frames: 3,
    }
}

fn findings() -> Findings {
    let runs = vec![run("pcf:map=512", 4.0, &[("maps", 7.0)]), run("pcf", 8.0, &[])];
    let row = |run: &Run| vec![run.spec.clone(), run.count("maps"), run.ms()];
    let rows = runs.iter().map(row).collect();
    let heads = vec![("technique", "what"), ("maps", "how many"), ("ms", "how long")];
    let table = Table { heads, groups: vec![Group { title: "a_scene".into(), rows }] };
    let points = vec![Spot { x: 1.0, y: 0.1, note: "a point".into() }];
    let curves = vec![Curve { label: "a curve".into(), color: 0, dashed: false, points }];
    let (x, y) = ("ms".into(), "error".into());
    let lines = Lines { x, y, less_is_better: true, curves, guides: Vec::new() };
    let ratio = Ratio {
        what: "speed",
        trial: "a_scene".into(),
        spec: runs[0].spec.clone(),
        base: runs[1].spec.clone(),
        paper: Some(5.5),
        ours: runs[0].speed_over(&runs[1]),
    };
    let point = Point {
        label: "pcf".into(),
        name: "pcf:map=512".into(),
        labelled: false,
        link: None,
        group: Some(0),
        ms: 4.0,
        error: 0.1,
    };
    let scatter = Shown::Scatter(Scatter { groups: vec!["a group"], points: vec![point] });
    let shown = vec![Shown::Pictures(vec![0, 9]), Shown::Table(table), Shown::Lines(lines), scatter];
    let part = Part { title: "A part".into(), text: "What it shows.".into(), shown };
    let trials = vec![trial("a_scene", runs)];
    Findings { lead: "It is so.".into(), parts: vec![part], ratios: vec![ratio], trials }
}

fn written(findings: &Findings) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    write(&context(), findings, &folder.path().join("deep/results")).unwrap();
    folder
}

fn text(folder: &tempfile::TempDir, name: &str) -> String {
    fs::read_to_string(folder.path().join("deep/results").join(name)).unwrap()
}

#[test]
fn all_files_are_there_and_nothing_else() {
    let folder = written(&findings());
    let entries = fs::read_dir(folder.path().join("deep/results")).unwrap();
    let mut names: Vec<_> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    assert_eq!(names, ["made-up.csv", "made-up.curves.csv", "made-up.html", "made-up.json", "made-up.md"]);
}

#[test]
fn the_page_needs_nothing_from_outside_and_escapes_what_it_is_given() {
    let page = text(&written(&findings()), "made-up.html");
    assert!(!page.contains("http://") && !page.contains("https://") && !page.contains("NaN"));
    assert!(page.contains("A &lt;made-up&gt; suite") && page.contains("GPU timestamps"));
    assert!(page.contains("say nothing about a GPU") && page.contains("antumbra bench made-up -o results"));
    assert_eq!(page.matches("data:image/png;base64,").count(), 1);
    assert!(
        page.contains("<title>a point</title>") && page.contains("<title>pcf:map=512: error 0.1000, 4.00 ms</title>")
    );
}

#[test]
fn the_paper_stands_beside_ours_in_json() {
    let json: serde_json::Value = serde_json::from_str(&text(&written(&findings()), "made-up.json")).unwrap();
    assert_eq!((&json["ratios"][0]["paper"], &json["ratios"][0]["ours"]), (&5.5.into(), &2.0.into()));
    assert_eq!((&json["adapter"], &json["software"]), (&"llvmpipe (LLVM 15) | *".into(), &true.into()));
    let run = &json["trials"][0]["runs"][0];
    assert_eq!((&run["work"]["maps"], &run["total_ms"], &run["timing"]), (&7.0.into(), &4.0.into(), &"gpu".into()));
}

#[test]
fn csv_has_a_row_a_run_and_a_column_a_figure_of_work() {
    let text = text(&written(&findings()), "made-up.csv");
    let mut csv = csv::Reader::from_reader(text.as_bytes());
    let maps = csv.headers().unwrap().iter().position(|h| h == "maps").unwrap();
    let rows: Vec<_> = csv.records().map(Result::unwrap).collect();
    assert_eq!(rows.iter().map(|r| &r[maps]).collect::<Vec<_>>(), ["7", ""]);
}

#[test]
fn every_point_of_a_plot_has_a_row() {
    let text = text(&written(&findings()), "made-up.curves.csv");
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines, ["part,x_axis,y_axis,curve,x,y,note", "A part,ms,error,a curve,1,0.1,a point"]);
}

#[test]
fn markdown_is_a_table_that_names_the_adapter_the_clock_and_the_command() {
    let md = text(&written(&findings()), "made-up.md");
    for line in
        ["| technique | maps | ms |", "|---|--:|--:|", "| **a\\_scene** |  |  |", "| `pcf:map=512` | 7 | 4.00 |"]
    {
        assert!(md.contains(line), "{line} in {md}");
    }
    for part in ["llvmpipe (LLVM 15) \\| \\*, a software adapter", "GPU timestamps", "    antumbra bench made-up"] {
        assert!(md.contains(part), "{part} in {md}");
    }
}

#[test]
fn wall_time_is_marked() {
    let mut findings = findings();
    assert_eq!(findings.clock(), "GPU timestamps");
    findings.trials[0].runs[0].cost.timing = Timing::Wall;
    assert!(findings.clock().contains("contradict") && findings.trials[0].runs[0].ms().ends_with('*'));
    findings.trials[0].runs[1].cost.timing = Timing::Wall;
    assert!(findings.clock().starts_with("wall time") && terminal(&findings).contains("* wall time"));
}

#[test]
fn the_terminal_has_titles_between_aligned_rows() {
    let text = terminal(&findings());
    let lines: Vec<&str> = text.lines().skip(2).collect();
    assert_eq!(lines, ["technique    maps    ms", "a_scene", "pcf:map=512     7  4.00", "pcf             –  8.00", ""]);
}

fn arguments() -> BenchArgs {
    let words = "antumbra bench -o x --frames 1 --light-samples 64 --pixel-samples 1 --no-cache";
    match Cli::parse_from(words.split(' ')).command {
        Command::Bench(args) => args,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_trial_measures_each_technique_and_the_penumbra() {
    let args = arguments();
    let gpu = crate::setup::gpu(&args.gpu, [1, 1]).unwrap();
    let lab = Lab { args: &args, gpu: &gpu, scenes: &[] };
    let specs = ["hard:map=64", "pcss:map=256"].map(|text| text.parse().unwrap());
    let measured = |scene: &Scene| {
        let truth = &args.truth;
        lab.trial(&Order { name: "a", scene, size: [48, 32], specs: &specs, frames: 1, truth, pictures: false })
            .unwrap()
    };
    let mut scene = antumbra_scene::builtin::build("square").unwrap();
    let soft = measured(&scene);
    assert_eq!(soft.runs.iter().map(|run| run.spec.as_str()).collect::<Vec<_>>(), ["hard:map=64", "pcss:map=256"]);
    assert!(soft.runs[1].figures.average_error < soft.runs[0].figures.average_error);
    assert!(soft.runs.iter().all(|run| run.cost.total_ms > 0.0 && run.cost.total_bytes > 0));
    assert_eq!(soft.runs[0].cost.timing, soft.runs[1].cost.timing, "both sides of a ratio by one clock");
    scene.light.size = [0.0; 2].into();
    let sharp = measured(&scene);
    assert!(soft.penumbra > 0.05 && sharp.penumbra == 0.0, "{} {}", soft.penumbra, sharp.penumbra);
}
