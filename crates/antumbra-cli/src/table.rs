//! The figures of a comparison, as a table for the terminal.

use crate::measure::Timing;
use crate::report::Entry;

const HEADS: [&str; 10] = ["technique", "avg error", "RMSE", "p99", "leak", "acne", "SSIM", "FLIP", "ms", "MB"];

/// What a star after milliseconds means.
pub const WALL: &str = "* wall time of the submitted work: the adapter has no timestamps, or they contradict it\n";

/// One row a technique.
pub fn of(entries: &[(Entry, Timing)]) -> String {
    let mut rows = vec![HEADS.map(str::to_owned).to_vec()];
    rows.extend(entries.iter().map(|(entry, timing)| row(entry, *timing)));
    let mut text = aligned(&rows);
    if entries.iter().any(|(_, timing)| *timing == Timing::Wall) {
        text += WALL;
    }
    text
}

fn row(entry: &Entry, timing: Timing) -> Vec<String> {
    let f = &entry.figures;
    let figure = |v: f64| format!("{v:.4}");
    let mark = if timing == Timing::Wall { "*" } else { "" };
    vec![
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

/// Rows of cells as lines: the first column to the left, numbers to the right.
pub fn aligned(rows: &[Vec<String>]) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let length = |row: &Vec<String>, c: usize| row.get(c).map_or(0, |cell| cell.chars().count());
    let widths: Vec<usize> = (0..columns).map(|c| rows.iter().map(|row| length(row, c)).max().unwrap_or(0)).collect();
    rows.iter().map(|row| line(row, &widths)).collect()
}

fn line(row: &[String], widths: &[usize]) -> String {
    let cells = row.iter().zip(widths).enumerate().map(|(c, (cell, &width))| match c {
        0 => format!("{cell:<width$}"),
        _ => format!("{cell:>width$}"),
    });
    cells.collect::<Vec<_>>().join("  ").trim_end().to_owned() + "\n"
}
