//! Error, time and memory of a technique.

use super::style;
use crate::session::Session;
use eframe::egui::{self, RichText};

/// The numbers of a half.
pub fn show(ui: &mut egui::Ui, session: &Session, half: usize) {
    let state = &session.halves[half];
    let Some((_, technique)) = &state.made else { return };
    let bytes_owned: u64 = technique.memory().iter().map(|m| m.bytes).sum();
    egui::Grid::new(("numbers", half)).num_columns(2).spacing([10.0, 3.0]).show(ui, |ui| {
        let mut row = |name: &str, value: String, help: &str| {
            ui.weak(name).on_hover_text(help);
            ui.monospace(value).on_hover_text(help);
            ui.end_row();
        };
        if !state.times.frames.is_empty() {
            let ms = if state.times.untimed {
                "no timestamps here".to_owned()
            } else {
                milliseconds(state.times.median_total())
            };
            row("time", ms, "GPU time of all passes, median over the last frames");
        }
        row("memory", bytes(bytes_owned), "GPU memory that the technique owns");
    });
    let Some(metrics) = state.measured.metrics.as_ref().filter(|_| session.truth.is_some()) else { return };
    match metrics {
        Err(why) => {
            ui.weak(why);
        }
        Ok(f) => {
            let all = [
                ("average error", f.average_error, "mean |error| over shadow and penumbra"),
                ("RMSE", f.rmse, "root of the mean squared error over all pixels"),
                ("leak", f.leak, "light that leaks into the umbra: mean visibility where the truth is 0"),
                ("acne", f.acne, "false darkness: mean darkness where the truth is 1"),
                ("99 %", f.p99, "error that 99 of 100 pixels do not exceed"),
                ("largest", f.max, "largest error of a pixel"),
            ];
            ui.columns(2, |columns| {
                for (i, (name, value, help)) in all.into_iter().enumerate() {
                    columns[i % 2].horizontal(|ui| {
                        ui.add(egui::Label::new(RichText::new(name).small().weak())).on_hover_text(help);
                        ui.label(RichText::new(format!("{value:.4}")).monospace().color(grade(value)))
                            .on_hover_text(help);
                    });
                }
            });
            if !state.measured.is_current() {
                ui.weak(RichText::new("measuring …").small());
            }
        }
    }
}

/// Colour of an error: the larger, the warmer.
fn grade(error: f64) -> egui::Color32 {
    match error {
        e if e < 0.02 => egui::Color32::from_rgb(150, 214, 160),
        e if e < 0.1 => style::ACCENT,
        _ => style::BAD,
    }
}

/// Bytes for people.
pub fn bytes(count: u64) -> String {
    match count {
        0..1024 => format!("{count} B"),
        1024..1_048_576 => format!("{:.1} KiB", count as f64 / 1024.0),
        _ => format!("{:.1} MiB", count as f64 / 1_048_576.0),
    }
}

/// Milliseconds with three digits that matter.
pub fn milliseconds(ms: f64) -> String {
    match ms {
        m if m < 1.0 => format!("{m:.3} ms"),
        m if m < 10.0 => format!("{m:.2} ms"),
        m if m < 100.0 => format!("{m:.1} ms"),
        m => format!("{m:.0} ms"),
    }
}
