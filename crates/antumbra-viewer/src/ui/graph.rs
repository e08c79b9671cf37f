//! Graph of pass times, one bar per frame.

use super::{numbers, style};
use crate::session::{Half, Session};
use crate::view_state::ViewState;
use eframe::egui::{self, Align2, Color32, FontId, Rect, RichText, Sense, Vec2, pos2};

/// Width of a frame's bar, points.
const BAR: f32 = 3.0;
/// Width of the list of passes, points.
const PASSES: f32 = 226.0;

/// A graph for each technique.
pub fn show(ui: &mut egui::Ui, view_state: &ViewState, session: &Session) {
    let count = view_state.techniques();
    ui.columns(count, |columns| {
        for (i, ui) in columns.iter_mut().enumerate() {
            one(ui, &session.halves[i], i, count);
        }
    });
}

fn one(ui: &mut egui::Ui, half: &Half, index: usize, count: usize) {
    let Some((choice, technique)) = &half.made else {
        ui.weak("nothing is drawn yet");
        return;
    };
    let side = if count == 1 { "" } else { ["left: ", "right: "][index] };
    ui.horizontal(|ui| {
        ui.label(RichText::new(format!("{side}{}", choice.technique.name)).strong());
        if half.times.untimed {
            ui.weak("this adapter gives no times of passes");
        } else {
            ui.monospace(numbers::milliseconds(half.times.median_total()));
            ui.weak("GPU, median of the last frames");
        }
    });
    ui.horizontal_top(|ui| {
        let memory = technique.memory();
        ui.vertical(|ui| {
            ui.set_width(PASSES);
            let list = egui::ScrollArea::vertical().id_salt(("passes", index)).auto_shrink([false, false]);
            list.show(ui, |ui| {
                ui.spacing_mut().item_spacing.y = 1.0;
                for (k, pass) in half.times.passes.iter().enumerate() {
                    let bytes: u64 = memory.iter().filter(|m| m.pass == pass).map(|m| m.bytes).sum();
                    row(ui, style::pass_color(k), pass, half.times.median(k), bytes);
                }
            });
        });
        let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::hover());
        bars(ui, rect, &response, half);
    });
}

fn row(ui: &mut egui::Ui, color: Color32, pass: &str, ms: f64, bytes: u64) {
    ui.horizontal(|ui| {
        let (dot, _) = ui.allocate_exact_size(Vec2::splat(8.0), Sense::hover());
        ui.painter().rect_filled(dot, 2.0, color);
        ui.label(RichText::new(pass).small());
        let memory = if bytes > 0 {
            format!("{}  {}", numbers::milliseconds(ms), numbers::bytes(bytes))
        } else {
            numbers::milliseconds(ms)
        };
        ui.label(RichText::new(memory).small().weak());
    });
}

fn bars(ui: &egui::Ui, rect: Rect, response: &egui::Response, half: &Half) {
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 3.0, ui.visuals().extreme_bg_color);
    let most = nice(half.times.longest());
    let font = FontId::proportional(10.0);
    let weak = ui.visuals().weak_text_color();
    for part in [0.5, 1.0] {
        let y = rect.bottom() - (rect.height() - 12.0) * part;
        painter.hline(rect.x_range(), y, egui::Stroke::new(1.0, Color32::from_gray(48)));
        let text = numbers::milliseconds(most * f64::from(part));
        painter.text(pos2(rect.left() + 4.0, y - 1.0), Align2::LEFT_BOTTOM, text, font.clone(), weak);
    }
    let per_ms = (rect.height() - 12.0) / most.max(1e-9) as f32;
    for (age, frame) in half.times.frames.iter().rev().enumerate() {
        let right = rect.right() - age as f32 * BAR;
        if right < rect.left() + 44.0 || rect.height() < 16.0 {
            break;
        }
        let mut bottom = rect.bottom();
        for (k, ms) in frame.iter().enumerate() {
            let height = *ms as f32 * per_ms;
            let bar = Rect::from_min_max(pos2(right - BAR + 0.6, bottom - height), pos2(right, bottom));
            painter.rect_filled(bar, 0.0, style::pass_color(k));
            bottom -= height;
        }
        let is_pointed_at = response.hover_pos().is_some_and(|p| p.x <= right && p.x > right - BAR);
        if is_pointed_at {
            response.show_tooltip_ui(|ui| {
                for (name, ms) in half.times.passes.iter().zip(frame) {
                    ui.monospace(format!("{:>9}  {name}", numbers::milliseconds(*ms)));
                }
            });
        }
    }
}

/// The next of 1, 2, 5, 10, 20 …
fn nice(value: f64) -> f64 {
    let base = 10f64.powf(value.max(1e-3).log10().floor());
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * base).find(|v| *v >= value).unwrap_or(10.0 * base)
}
