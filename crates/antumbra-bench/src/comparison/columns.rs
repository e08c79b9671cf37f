//! Columns of a comparison: the sortable table of the page, the terminal's table and the CSV.

use super::model::{Comparison, Entry};
use crate::measure::{Timing, WALL};
use crate::page::text;
use crate::table::{Column, Table, column};

/// A number of the page's table.
pub struct Metric {
    pub heading: &'static str,
    pub help: &'static str,
    /// None for a mean over a class without pixels.
    pub value: fn(&Entry) -> Option<f64>,
    pub text: fn(f64) -> String,
    pub more_is_better: bool,
    pub bar: bool,
}

impl Metric {
    /// The formatted value.
    pub fn of(&self, entry: &Entry) -> Option<String> {
        (self.value)(entry).map(self.text)
    }
}

const fn metric(heading: &'static str, help: &'static str, value: fn(&Entry) -> Option<f64>) -> Metric {
    Metric { heading, help, value, text: text::metric, more_is_better: false, bar: false }
}

fn of_class(pixels: u64, value: f64) -> Option<f64> {
    (pixels > 0).then_some(value)
}

/// Columns of the page's table.
pub const METRICS: [Metric; 10] = [
    Metric {
        bar: true,
        ..metric("Average error", "Mean |error| where the truth is under 0.999: shadow and penumbra", |e| {
            of_class(e.metrics.counts.shadowed, e.metrics.average_error)
        })
    },
    metric("RMSE", "Root of the mean squared error, all valid pixels", |e| Some(e.metrics.rmse)),
    metric("p99", "99th percentile of |error| over the valid pixels", |e| Some(e.metrics.p99)),
    metric("Leak", "Light in the umbra: mean visibility where the truth is under 0.001", |e| {
        of_class(e.metrics.counts.umbra, e.metrics.leak)
    }),
    metric("Acne", "False darkness: mean of 1 - visibility where the truth is over 0.999", |e| {
        of_class(e.metrics.counts.lit, e.metrics.acne)
    }),
    metric(
        "Grazing",
        "Mean |error| in shadow where the light is grazing: cosines of 0 to 0.1, left out elsewhere",
        |e| e.grazing.and_then(|g| of_class(g.counts.shadowed, g.average_error)),
    ),
    Metric { more_is_better: true, ..metric("SSIM", "Structural similarity; 1 is equal", |e| Some(e.metrics.ssim)) },
    metric("FLIP", "Mean FLIP error, the perceived difference; 0 is equal", |e| Some(e.metrics.flip)),
    Metric {
        text: text::ms,
        bar: true,
        ..metric("ms", "GPU milliseconds of the shadow alone", |e| Some(e.cost.total_ms))
    },
    Metric {
        text: |bytes| text::megabytes(bytes as u64),
        ..metric("MB", "GPU memory of the technique, 10⁶ bytes", |e| Some(e.cost.total_bytes as f64))
    },
];

/// The comparison as text for a terminal: the scene, the reference, and a table.
pub fn terminal(comparison: &Comparison) -> String {
    let number =
        |name, help, value: fn(&Entry) -> f64| column(name, help, "", move |e: &&Entry| format!("{:.4}", value(e)));
    let columns = [
        column("technique", "Name and settings", "", |e: &&Entry| e.spec.clone()),
        number("avg error", "Mean |error| over shadow and penumbra", |e| e.metrics.average_error),
        number("RMSE", "Root of the mean squared error", |e| e.metrics.rmse),
        number("p99", "99th percentile of |error|", |e| e.metrics.p99),
        number("leak", "Mean visibility in the umbra", |e| e.metrics.leak),
        number("acne", "Mean darkness where lit", |e| e.metrics.acne),
        column("grazing", "Mean |error| in shadow where the light is grazing", "", |e: &&Entry| {
            e.grazing.map_or("-".to_owned(), |g| format!("{:.4}", g.average_error))
        }),
        number("SSIM", "Structural similarity", |e| e.metrics.ssim),
        number("FLIP", "Mean FLIP error", |e| e.metrics.flip),
        column("ms", "GPU time of the shadow alone", "ms", |e: &&Entry| {
            format!("{:.2}{}", e.cost.total_ms, e.cost.timing.mark())
        }),
        column("MB", "GPU memory", "10⁶ bytes", |e: &&Entry| format!("{:.1}", e.cost.total_bytes as f64 * 1e-6)),
    ];
    let Comparison { scene, triangles, width, height, adapter, truth, entries, .. } = comparison;
    let software = if comparison.software { ", software" } else { "" };
    let table = Table::new(&columns, "", entries).terminal();
    let wall = if entries.iter().any(|e| e.cost.timing == Timing::Wall) { WALL } else { "" };
    format!(
        "{scene}, {triangles} triangles, {width} x {height}, {adapter}{software}\nTruth: {}\n\n{table}{wall}",
        truth.summary
    )
}

/// Columns of the CSV.
pub fn csv<'a>() -> Vec<Column<(&'a Comparison, &'a Entry)>> {
    type Row<'a> = (&'a Comparison, &'a Entry);
    fn text<'a>(name: &'static str, cell: fn(&Row) -> String) -> Column<Row<'a>> {
        column(name, "", "", cell)
    }
    fn real<'a>(name: &'static str, value: fn(&Entry) -> f64) -> Column<Row<'a>> {
        column(name, "", "", move |(_, e): &Row<'a>| format!("{:?}", value(e)))
    }
    vec![
        text("technique", |(_, e)| e.technique.clone()),
        text("spec", |(_, e)| e.spec.clone()),
        real("average_error", |e| e.metrics.average_error),
        real("rmse", |e| e.metrics.rmse),
        real("p99", |e| e.metrics.p99),
        real("max", |e| e.metrics.max),
        real("leak", |e| e.metrics.leak),
        real("acne", |e| e.metrics.acne),
        text("grazing_error", |(_, e)| e.grazing.map_or(String::new(), |g| format!("{:?}", g.average_error))),
        real("ssim", |e| e.metrics.ssim),
        real("flip", |e| e.metrics.flip),
        real("total_ms", |e| e.cost.total_ms),
        text("total_bytes", |(_, e)| e.cost.total_bytes.to_string()),
        text("valid", |(_, e)| e.metrics.counts.valid.to_string()),
        text("shadowed", |(_, e)| e.metrics.counts.shadowed.to_string()),
        text("penumbra", |(_, e)| e.metrics.counts.penumbra.to_string()),
        text("umbra", |(_, e)| e.metrics.counts.umbra.to_string()),
        text("lit", |(_, e)| e.metrics.counts.lit.to_string()),
        text("scene", |(c, _)| c.scene.clone()),
        text("width", |(c, _)| c.width.to_string()),
        text("height", |(c, _)| c.height.to_string()),
        text("triangles", |(c, _)| c.triangles.to_string()),
        text("adapter", |(c, _)| c.adapter.clone()),
    ]
}
