//! The files of a suite from made-up measurements, and one trial that is measured.

use super::columns;
use super::made_up::{run, trial};
use super::*;
use crate::Silent;
use crate::measure::Timing;
use crate::page::lines::{Curve, Lines, Point};
use crate::page::scatter;
use crate::table::Table;
use crate::truth::TruthSettings;
use antumbra::{AdapterChoice, Gpu};
use antumbra_scene::Scene;
use std::fs;

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

fn report() -> Report {
    let trial = trial("a_scene", vec![run("pcf:map=512", 4.0, &[("maps", 7.0)]), run("pcf", 8.0, &[])]);
    let columns =
        || [columns::technique::<(&Trial, &Run)>(), columns::count("maps", "how many", "maps"), columns::ms()];
    let table = Table::new(&columns(), "a_scene", trial.rows());
    let lines = Lines::new("ms", "error", [Curve::new("a curve", 0, [Point::new(1.0, 0.1, "a point".into())])]);
    let point = scatter::Point {
        label: "pcf".into(),
        name: "pcf:map=512".into(),
        labelled: false,
        link: None,
        group: Some(0),
        ms: 4.0,
        error: 0.1,
    };
    let scatter = Content::Scatter(Scatter { groups: &["a group"], points: vec![point] });
    let references = Content::references(std::slice::from_ref(&trial));
    let section = Section::new("A part", "What it shows.", vec![references, table.into(), lines.into(), scatter]);
    let ratios = vec![Ratio::speed("speed", &trial, &trial.runs[0], &trial.runs[1], Some(5.5))];
    Report { lead: "It is so.".into(), sections: vec![section], ratios, trials: vec![trial] }
}

fn written(report: &Report) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    write(&context(), report, &folder.path().join("deep/results")).unwrap();
    folder
}

fn text(folder: &tempfile::TempDir, name: &str) -> String {
    fs::read_to_string(folder.path().join("deep/results").join(name)).unwrap()
}

#[test]
fn all_files_are_there_and_nothing_else() {
    let folder = written(&report());
    let entries = fs::read_dir(folder.path().join("deep/results")).unwrap();
    let mut names: Vec<_> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    assert_eq!(names, ["made-up.csv", "made-up.curves.csv", "made-up.html", "made-up.json", "made-up.md"]);
}

#[test]
fn the_page_has_no_external_resources_and_escapes_text() {
    let page = text(&written(&report()), "made-up.html");
    assert!(!page.contains("http://") && !page.contains("https://") && !page.contains("NaN"));
    assert!(page.contains("A &lt;made-up&gt; suite") && page.contains("GPU timestamps"));
    assert!(page.contains("say nothing about a GPU") && page.contains("antumbra bench made-up -o results"));
    assert_eq!(page.matches("data:image/png;base64,").count(), 1);
    assert!(
        page.contains("<title>a point</title>") && page.contains("<title>pcf:map=512: error 0.1000, 4.00 ms</title>")
    );
}

#[test]
fn json_has_the_paper_s_ratio_beside_the_measured_one() {
    let json: serde_json::Value = serde_json::from_str(&text(&written(&report()), "made-up.json")).unwrap();
    assert_eq!((&json["ratios"][0]["paper"], &json["ratios"][0]["ours"]), (&5.5.into(), &2.0.into()));
    assert_eq!((&json["adapter"], &json["software"]), (&"llvmpipe (LLVM 15) | *".into(), &true.into()));
    let run = &json["trials"][0]["runs"][0];
    assert_eq!((&run["work"]["maps"], &run["total_ms"], &run["timing"]), (&7.0.into(), &4.0.into(), &"gpu".into()));
}

#[test]
fn csv_has_a_row_per_run_and_a_column_per_count() {
    let text = text(&written(&report()), "made-up.csv");
    let mut csv = csv::Reader::from_reader(text.as_bytes());
    let maps = csv.headers().unwrap().iter().position(|h| h == "maps").unwrap();
    let rows: Vec<_> = csv.records().map(Result::unwrap).collect();
    assert_eq!(rows.iter().map(|r| &r[maps]).collect::<Vec<_>>(), ["7", ""]);
}

#[test]
fn every_point_of_a_plot_has_a_row() {
    let text = text(&written(&report()), "made-up.curves.csv");
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines, ["part,x_axis,y_axis,curve,x,y,note", "A part,ms,error,a curve,1,0.1,a point"]);
}

#[test]
fn markdown_is_a_table_that_names_the_adapter_the_clock_and_the_command() {
    let md = text(&written(&report()), "made-up.md");
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
    let mut report = report();
    assert_eq!(report.clock(), "GPU timestamps");
    report.trials[0].runs[0].cost.timing = Timing::Wall;
    assert!(report.clock().contains("contradict") && report.trials[0].runs[0].ms().ends_with('*'));
    report.trials[0].runs[1].cost.timing = Timing::Wall;
    assert!(report.clock().starts_with("wall time") && report.terminal().contains("* wall time"));
}

#[test]
fn the_terminal_has_titles_between_aligned_rows() {
    let text = report().terminal();
    let lines: Vec<&str> = text.lines().skip(2).collect();
    assert_eq!(lines, ["technique    maps    ms", "a_scene", "pcf:map=512     7  4.00", "pcf             –  8.00", ""]);
}

#[test]
fn a_trial_measures_each_technique_and_the_penumbra() {
    let gpu = pollster::block_on(Gpu::new(&AdapterChoice::default())).unwrap();
    let truth = TruthSettings { light_samples: 64, pixel_samples: 1, seed: 0, cache: None };
    let runner = Runner { gpu: &gpu, monitor: &Silent::default(), size: None, frames: 1, truth, scenes: &[] };
    let measured = |scene: &Scene| {
        let specs = ["hard:map=64", "pcss:map=256"];
        runner.run(&Experiment::new("a", scene.clone(), [48, 32], specs).unwrap()).unwrap()
    };
    let mut scene = antumbra_scene::builtin::build("square").unwrap();
    let soft = measured(&scene);
    assert_eq!(soft.runs.iter().map(|run| run.spec.as_str()).collect::<Vec<_>>(), ["hard:map=64", "pcss:map=256"]);
    assert!(soft.runs[1].metrics.average_error < soft.runs[0].metrics.average_error);
    assert!(soft.runs.iter().all(|run| run.cost.total_ms > 0.0 && run.cost.total_bytes > 0));
    assert_eq!(soft.runs[0].cost.timing, soft.runs[1].cost.timing, "both sides of a ratio by one clock");
    scene.light.size = [0.0; 2].into();
    let sharp = measured(&scene);
    assert!(soft.penumbra > 0.05 && sharp.penumbra == 0.0, "{} {}", soft.penumbra, sharp.penumbra);
}
