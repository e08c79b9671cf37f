//! Files of a suite: a page, JSON, Markdown, and CSV of the runs and of the plots' points.

use super::page;
use super::report::{Content, Context, Ratio, Report};
use super::trial::{Run, Trial};
use crate::page::files::{ReportError, json, write_all};
use crate::page::lines::{Curve, Lines, Point};
use crate::table::{Column, Table, column};
use serde::Serialize;
use std::collections::BTreeSet;
use std::path::Path;

/// Writes all files of a suite into a folder, or none.
pub fn write(context: &Context, report: &Report, to: &Path) -> Result<(), ReportError> {
    #[derive(Serialize)]
    struct Document<'a> {
        #[serde(flatten)]
        context: &'a Context,
        clock: &'static str,
        ratios: &'a [Ratio],
        trials: &'a [Trial],
    }
    let Report { ratios, trials, .. } = report;
    let document = Document { context, clock: report.clock(), ratios, trials };
    let named = |ending: &str| format!("{}.{ending}", context.suite);
    let files = [
        (named("json"), json(&document)?),
        (named("csv"), runs(context, report).csv()?),
        (named("curves.csv"), points(report).csv()?),
        (named("md"), report.markdown(context).into_bytes()),
        (named("html"), page::html(context, report)?.into_bytes()), // last: it links to the others
    ];
    write_all(&files, to)
}

/// One row per run; statistics of the techniques come last.
fn runs(context: &Context, report: &Report) -> Table {
    type Row<'a> = (&'a Trial, &'a Run);
    fn cell<'a, V: ToString + 'static>(name: &'static str, value: fn(&Row) -> V) -> Column<Row<'a>> {
        column(name, "", "", move |row: &Row<'a>| value(row).to_string())
    }
    let adapter = context.adapter.clone();
    let mut columns = vec![
        cell("trial", |(t, _)| t.name.clone()),
        cell("scene", |(t, _)| t.scene.clone()),
        cell("triangles", |(t, _)| t.triangles),
        cell("width", |(t, _)| t.width),
        cell("height", |(t, _)| t.height),
        cell("penumbra", |(t, _)| t.penumbra),
        cell("technique", |(_, r)| r.technique),
        cell("spec", |(_, r)| r.spec.clone()),
        cell("average_error", |(_, r)| r.metrics.average_error),
        cell("rmse", |(_, r)| r.metrics.rmse),
        cell("p99", |(_, r)| r.metrics.p99),
        cell("max", |(_, r)| r.metrics.max),
        cell("leak", |(_, r)| r.metrics.leak),
        cell("acne", |(_, r)| r.metrics.acne),
        cell("ssim", |(_, r)| r.metrics.ssim),
        cell("flip", |(_, r)| r.metrics.flip),
        cell("total_ms", |(_, r)| r.cost.total_ms),
        cell("wall_ms", |(_, r)| r.cost.wall_ms),
        cell("timing", |(_, r)| r.cost.timing.name()),
        cell("total_bytes", |(_, r)| r.cost.total_bytes),
        column("adapter", "", "", move |_: &Row| adapter.clone()),
    ];
    let rows = || report.trials.iter().flat_map(Trial::rows);
    let stats: BTreeSet<&'static str> = rows().flat_map(|(_, run)| run.stats.keys().copied()).collect();
    columns.extend(stats.into_iter().map(|key| {
        column(key, "", "", move |(_, run): &Row| run.stats.get(key).map_or(String::new(), f64::to_string))
    }));
    Table::new(&columns, "", rows())
}

/// One row per point of a curve.
fn points(report: &Report) -> Table {
    type Row<'a> = (&'a str, &'a Lines, &'a Curve, &'a Point);
    let columns = [
        column("part", "", "", |(section, ..): &Row| (*section).to_owned()),
        column("x_axis", "", "", |(_, lines, ..): &Row| lines.x.clone()),
        column("y_axis", "", "", |(_, lines, ..): &Row| lines.y.clone()),
        column("curve", "", "", |(.., curve, _): &Row| curve.label.clone()),
        column("x", "", "", |(.., point): &Row| point.x.to_string()),
        column("y", "", "", |(.., point): &Row| point.y.to_string()),
        column("note", "", "", |(.., point): &Row| point.note.clone()),
    ];
    let contents = report.sections.iter().flat_map(|s| s.contents.iter().map(move |content| (s, content)));
    let lines = contents.filter_map(|(section, content)| match content {
        Content::Lines(lines) => Some((section.title.as_str(), lines)),
        _ => None,
    });
    let curves = lines.flat_map(|(section, lines)| lines.curves.iter().map(move |curve| (section, lines, curve)));
    let rows = curves.flat_map(|(section, lines, curve)| curve.points.iter().map(move |p| (section, lines, curve, p)));
    Table::new(&columns, "", rows)
}
