//! Error over the size of the light.

use super::specs::{COMPARED, run_of};
use crate::kit::{Content, Run, Section, Trial};
use crate::page::lines::{Curve, Lines, Point};
use crate::page::text;
use crate::table::{Table, column};

/// A trial with its size of the light, as a multiple of the distance between light and occluder.
pub type LightTrial<'a> = (f64, &'a Trial);

/// Title of the axis.
pub const LIGHT_AXIS: &str = "size of the light ÷ distance of the occluder from it";

/// Plots and a table of the error as the light grows; one sweep per scene.
pub fn section(sweeps: &[(&str, Vec<LightTrial>)]) -> Section {
    let plot = |y: &str, value: fn(&Run) -> f64| -> Content {
        Lines::new(LIGHT_AXIS, y, by_light(sweeps, value, text::metric)).into()
    };
    Section::new(
        "Error over the size of the light",
        "The light's edge grows from 0.05 to 3 times the occluder's distance from it: the square hangs 2 m below its \
         light; in other scenes the distance is that to the centre of the casters. Images have half the size of the \
         others per side.",
        vec![
            plot("average error", |run| run.metrics.average_error),
            plot("largest error of a pixel", |run| run.metrics.max),
            table(sweeps).into(),
        ],
    )
}

/// One curve per scene and technique, over the size of the light.
pub fn by_light(sweeps: &[(&str, Vec<LightTrial>)], value: fn(&Run) -> f64, text: fn(f64) -> String) -> Vec<Curve> {
    let curves = sweeps.iter().enumerate().flat_map(|(i, (scene, lit))| {
        COMPARED.iter().enumerate().map(move |(color, (name, spec))| {
            let point = |(x, trial): &LightTrial| {
                let y = value(run_of(trial, spec)?);
                Some(Point::new(*x, y, format!("{spec}, {scene}, {x} times the distance: {}", text(y))))
            };
            Curve::new(format!("{name}, {scene}"), color, lit.iter().filter_map(point)).dashed(i > 0)
        })
    });
    curves.collect()
}

/// Runs of a technique over the sizes of the light.
struct Row<'a> {
    spec: &'static str,
    runs: Vec<(f64, &'a Run)>,
}

impl<'a> Row<'a> {
    /// `None` unless every trial has the technique.
    fn of(lit: &[LightTrial<'a>], spec: &'static str) -> Option<Row<'a>> {
        let runs: Option<Vec<_>> = lit.iter().map(|(x, trial)| Some((*x, run_of(trial, spec)?))).collect();
        runs.filter(|runs| !runs.is_empty()).map(|runs| Row { spec, runs })
    }

    /// The largest value and the size of the light there.
    fn largest(&self, value: fn(&Run) -> f64) -> (f64, f64) {
        let values = self.runs.iter().map(|(x, run)| (value(run), *x));
        values.max_by(|a, b| a.0.total_cmp(&b.0)).expect("a row has runs")
    }
}

fn table(sweeps: &[(&str, Vec<LightTrial>)]) -> Table {
    const AT: &str = "Size of the light at which this occurs, over the distance of the occluder";
    let average = |run: &Run| run.metrics.average_error;
    let pixel = |run: &Run| run.metrics.max;
    let columns = [
        column("technique", "Name and settings", "", |row: &Row| row.spec.to_owned()),
        column("mean error", "Mean over the sizes of the light of the average error", "", move |row: &Row| {
            text::metric(row.runs.iter().map(|(_, run)| average(run)).sum::<f64>() / row.runs.len() as f64)
        }),
        column("largest", "Largest average error at any size", "", move |row: &Row| {
            text::metric(row.largest(average).0)
        }),
        column("at", AT, "", move |row: &Row| row.largest(average).1.to_string()),
        column("largest of a pixel", "Largest |error| of any pixel at any size", "", move |row: &Row| {
            text::metric(row.largest(pixel).0)
        }),
        column("at", AT, "", move |row: &Row| row.largest(pixel).1.to_string()),
        column("p99", "Largest 99th percentile of |error| at any size", "", |row: &Row| {
            text::metric(row.largest(|run| run.metrics.p99).0)
        }),
    ];
    let groups = sweeps
        .iter()
        .map(|(scene, lit)| ((*scene).to_owned(), COMPARED.iter().filter_map(|(_, spec)| Row::of(lit, spec))));
    Table::grouped(&columns, groups)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kit::made_up::{run, trial};

    #[test]
    fn the_table_has_the_largest_error_of_a_sweep_and_its_size_of_the_light() {
        let all = |ms| trial("a", COMPARED.iter().map(|(_, spec)| run(spec, ms, &[])).collect());
        let mut trials = [all(1.0), all(2.0)];
        trials[1].runs[0].metrics.average_error = 0.75;
        let lit = [0.05, 3.0].into_iter().zip(&trials).collect();
        let section = section(&[("square", lit)]);
        let [Content::Lines(lines), _, Content::Table(table)] = &section.contents[..] else {
            panic!("plots and a table")
        };
        assert!(lines.curves.len() == COMPARED.len() && lines.curves.iter().all(|c| c.points.len() == 2));
        assert!(table.groups[0].rows.iter().all(|row| row.len() == table.headings.len()));
        assert_eq!(table.groups[0].rows[0][2..4], ["0.7500", "3"]);
    }
}
