//! The figures of a comparison, as a table for the terminal.

use crate::measure::Timing;
use crate::report::Entry;

const HEADS: [&str; 10] = ["technique", "avg error", "RMSE", "p99", "leak", "acne", "SSIM", "FLIP", "ms", "MB"];

/// One row a technique.
pub fn of(entries: &[(Entry, Timing)]) -> String {
    let mut rows = vec![HEADS.map(str::to_owned)];
    rows.extend(entries.iter().map(|(entry, timing)| row(entry, *timing)));
    let widths: [usize; HEADS.len()] =
        std::array::from_fn(|c| rows.iter().map(|row| row[c].chars().count()).max().unwrap_or(0));
    let mut text: String = rows.iter().map(|row| line(row, &widths)).collect();
    if entries.iter().any(|(_, timing)| *timing == Timing::Wall) {
        text += "* wall time of the submitted work: the adapter has no timestamps, or they contradict it\n";
    }
    text
}

fn row(entry: &Entry, timing: Timing) -> [String; HEADS.len()] {
    let f = &entry.figures;
    let figure = |v: f64| format!("{v:.4}");
    let mark = if timing == Timing::Wall { "*" } else { "" };
    [
        entry.spec.clone(),
        figure(f.average_error),
        figure(f.rmse),
        figure(f.p99),
        figure(f.leak),
        figure(f.acne),
        figure(f.ssim),
        figure(f.flip),
        format!("{:.2}{mark}", entry.total_ms),
        format!("{:.1}", entry.total_bytes as f64 * 1e-6),
    ]
}

/// The first column to the left, numbers to the right.
fn line(row: &[String; HEADS.len()], widths: &[usize; HEADS.len()]) -> String {
    let cells = row.iter().zip(widths).enumerate().map(|(c, (cell, &width))| match c {
        0 => format!("{cell:<width$}"),
        _ => format!("{cell:>width$}"),
    });
    cells.collect::<Vec<_>>().join("  ") + "\n"
}
