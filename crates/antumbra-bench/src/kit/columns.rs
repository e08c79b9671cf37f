//! Columns that many tables share. A row is a trial with one of its runs, and possibly more.

use super::trial::Run;
use crate::page::text;
use crate::table::{Column, column};

/// A row about one run.
pub trait HasRun {
    /// The run.
    fn run(&self) -> &Run;
}

impl<T> HasRun for (T, &Run) {
    fn run(&self) -> &Run {
        self.1
    }
}

impl<T, U> HasRun for (T, &Run, U) {
    fn run(&self) -> &Run {
        self.1
    }
}

/// An error metric of the run, four decimals.
pub fn metric<R: HasRun>(name: &'static str, help: &'static str, value: fn(&Run) -> f64) -> Column<R> {
    column(name, help, "", move |row: &R| text::metric(value(row.run())))
}

/// The SPEC.
pub fn technique<R: HasRun>() -> Column<R> {
    column("technique", "Name and settings", "", |row: &R| row.run().spec.clone())
}

/// Time of the shadow.
pub fn ms<R: HasRun>() -> Column<R> {
    column("ms", "GPU time of the shadow alone", "ms", |row: &R| row.run().ms())
}

/// Memory of the technique.
pub fn megabytes<R: HasRun>() -> Column<R> {
    column("MB", "GPU memory of the technique", "10⁶ bytes", |row: &R| text::megabytes(row.run().cost.total_bytes))
}

/// A statistic of the technique as a whole number.
pub fn count<R: HasRun>(name: &'static str, help: &'static str, stat: &'static str) -> Column<R> {
    column(name, help, "", move |row: &R| row.run().count(stat))
}

/// Average error.
pub fn error<R: HasRun>() -> Column<R> {
    metric("error", "Mean |error| where the truth is under 0.999: shadow and penumbra", |run| run.metrics.average_error)
}

/// Root mean squared error.
pub fn rmse<R: HasRun>() -> Column<R> {
    metric("RMSE", "Root of the mean squared error, all valid pixels", |run| run.metrics.rmse)
}

/// Light leak.
pub fn leak<R: HasRun>() -> Column<R> {
    metric("leak", "Mean visibility where the truth is under 0.001: light in the umbra", |run| run.metrics.leak)
}

/// Shadow acne.
pub fn acne<R: HasRun>() -> Column<R> {
    metric("acne", "Mean darkness where the truth is over 0.999", |run| run.metrics.acne)
}
