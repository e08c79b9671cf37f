//! The files of a suite: a page, JSON, CSV of the runs and of the plots' points, and a table in Markdown.

use super::{Context, Findings, Ratio, Run, Shown, Trial, markdown, page};
use crate::report::{self, ReportError};
use serde::Serialize;
use std::collections::BTreeSet;
use std::path::Path;

/// Writes all files of a suite into a folder, or none.
pub fn write(context: &Context, findings: &Findings, to: &Path) -> Result<(), ReportError> {
    let named = |ending: &str| format!("{}.{ending}", context.suite);
    let files = [
        (named("json"), json(context, findings)?),
        (named("csv"), csv(context, findings)?),
        (named("curves.csv"), curves(findings)?),
        (named("md"), markdown::document(context, findings).into_bytes()),
        (named("html"), page::html(context, findings)?.into_bytes()), // last: it links to the others
    ];
    report::place(&files, to)
}

fn json(context: &Context, findings: &Findings) -> Result<Vec<u8>, ReportError> {
    #[derive(Serialize)]
    struct Document<'a> {
        #[serde(flatten)]
        context: &'a Context,
        clock: &'static str,
        ratios: &'a [Ratio],
        trials: &'a [Trial],
    }
    let Findings { ratios, trials, .. } = findings;
    let mut json = serde_json::to_vec_pretty(&Document { context, clock: findings.clock(), ratios, trials })?;
    json.push(b'\n');
    Ok(json)
}

/// Columns before those of a technique's work.
const COLUMNS: [&str; 21] = [
    "trial",
    "scene",
    "triangles",
    "width",
    "height",
    "penumbra",
    "technique",
    "spec",
    "average_error",
    "rmse",
    "p99",
    "max",
    "leak",
    "acne",
    "ssim",
    "flip",
    "total_ms",
    "wall_ms",
    "timing",
    "total_bytes",
    "adapter",
];

/// A row a run.
fn csv(context: &Context, findings: &Findings) -> Result<Vec<u8>, ReportError> {
    let runs = || findings.trials.iter().flat_map(|trial| trial.runs.iter().map(move |run| (trial, run)));
    let work: BTreeSet<&str> = runs().flat_map(|(_, run)| run.work.keys().copied()).collect();
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(COLUMNS.iter().chain(&work))?;
    for (trial, run) in runs() {
        let done = work.iter().map(|key| run.work.get(key).map_or(String::new(), f64::to_string));
        writer.write_record(cells(context, trial, run).into_iter().chain(done))?;
    }
    Ok(writer.into_inner().map_err(|e| csv::Error::from(e.into_error()))?)
}

/// A row a point of a plot's curve.
fn curves(findings: &Findings) -> Result<Vec<u8>, ReportError> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(["part", "x_axis", "y_axis", "curve", "x", "y", "note"])?;
    for (part, shown) in findings.parts.iter().flat_map(|part| part.shown.iter().map(move |shown| (part, shown))) {
        let Shown::Lines(lines) = shown else { continue };
        for (curve, spot) in lines.curves.iter().flat_map(|curve| curve.points.iter().map(move |spot| (curve, spot))) {
            let (x, y) = (spot.x.to_string(), spot.y.to_string());
            writer.write_record([&part.title, &lines.x, &lines.y, &curve.label, &x, &y, &spot.note])?;
        }
    }
    Ok(writer.into_inner().map_err(|e| csv::Error::from(e.into_error()))?)
}

fn cells(context: &Context, trial: &Trial, run: &Run) -> [String; COLUMNS.len()] {
    let (f, cost) = (&run.figures, &run.cost);
    [
        trial.name.clone(),
        trial.scene.clone(),
        trial.triangles.to_string(),
        trial.width.to_string(),
        trial.height.to_string(),
        trial.penumbra.to_string(),
        run.technique.to_owned(),
        run.spec.clone(),
        f.average_error.to_string(),
        f.rmse.to_string(),
        f.p99.to_string(),
        f.max.to_string(),
        f.leak.to_string(),
        f.acne.to_string(),
        f.ssim.to_string(),
        f.flip.to_string(),
        cost.total_ms.to_string(),
        cost.wall_ms.to_string(),
        cost.timing.name().to_owned(),
        cost.total_bytes.to_string(),
        context.adapter.clone(),
    ]
}
