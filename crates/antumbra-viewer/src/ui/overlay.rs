//! Text over the image: techniques, cost, error, colour bar, hints.

use super::{Hints, numbers, panel, style};
use crate::session::Session;
use crate::show::Show;
use crate::truth::{Progress, Truth};
use crate::view_state::{Compare, ViewState};
use antumbra_metrics::{HEAT_SCALE, heat_color};
use eframe::egui::{self, Align2, Color32, FontId, Pos2, Rect, RichText, pos2, vec2};

/// Draws labels in the upper corners, the colour bar while errors are shown, and hints for new users.
pub fn show(ui: &mut egui::Ui, area: Rect, view_state: &mut ViewState, session: &mut Session, known: &Hints) {
    // A window may be as small as a title bar.
    if area.width() < 60.0 || area.height() < 60.0 {
        return;
    }
    if session.loaded.is_some() {
        let middle = area.left() + area.width() * view_state.divider;
        let is_split = view_state.compare != Compare::One;
        label(ui, area, area.left_top(), Align2::LEFT_TOP, |ui| technique(ui, view_state, session, 0));
        if is_split {
            let corner = pos2(area.right(), area.top());
            let is_narrow = area.right() - middle < 60.0;
            if !is_narrow {
                label(ui, area, corner, Align2::RIGHT_TOP, |ui| match view_state.compare {
                    Compare::Two => technique(ui, view_state, session, 1),
                    _ => truth(ui, session),
                });
            }
        }
    }
    if view_state.show == Show::Error {
        color_bar(ui, area, session);
    }
    if session.loaded.is_some() {
        hints(ui, area, view_state, known);
    }
}

/// Hints about the mouse, until the user has moved something.
fn hints(ui: &egui::Ui, area: Rect, view_state: &ViewState, known: &Hints) {
    let hint = |at: Pos2, pivot: Align2, text: &str| {
        let most = (area.width() - 40.0).max(60.0);
        let painter = ui.painter_at(area);
        let galley = painter.layout(text.to_owned(), FontId::proportional(12.5), style::ON_IMAGE, most);
        let place = pivot.anchor_size(at, galley.size());
        painter.rect_filled(place.expand2(vec2(9.0, 4.0)), 5.0, style::SHADE);
        painter.galley(place.min, galley, style::ON_IMAGE);
    };
    if !known.moving {
        let above = if view_state.show == Show::Error { 92.0 } else { 16.0 };
        let text = "drag: turn      wheel or pinch: zoom      right drag: move      F1: all keys";
        hint(area.center_bottom() - vec2(0.0, above), Align2::CENTER_BOTTOM, text);
    }
    if view_state.compare != Compare::One && !known.dividing && area.height() > 240.0 {
        let middle = pos2(area.left() + area.width() * view_state.divider, area.center().y + 26.0);
        hint(middle, Align2::CENTER_TOP, "drag the line");
    }
}

fn label(ui: &egui::Ui, area: Rect, corner: Pos2, pivot: Align2, content: impl FnOnce(&mut egui::Ui)) {
    let inwards = if pivot == Align2::LEFT_TOP { vec2(10.0, 10.0) } else { vec2(-10.0, 10.0) };
    egui::Area::new(ui.scope_id().with(("label", pivot.x() == egui::Align::Min)))
        .order(egui::Order::Middle)
        .pivot(pivot)
        .fixed_pos(corner + inwards)
        .constrain_to(area)
        .show(ui.ctx(), |ui| style::card().show(ui, content));
}

fn technique(ui: &mut egui::Ui, view_state: &mut ViewState, session: &mut Session, half: usize) {
    ui.set_max_width(280.0);
    let choice = &mut view_state.choices[half];
    let name = RichText::new(choice.technique.name).strong().size(15.0).color(style::ON_IMAGE);
    let button = egui::Button::new((name, egui::containers::menu::SubMenuButton::arrow_atom(None)));
    let gpu = &session.gpu;
    let menu = egui::containers::menu::MenuButton::from_button(button).ui(ui, |ui| panel::pick(ui, choice, gpu));
    menu.0.on_hover_text("Another technique");
    ui.label(RichText::new(choice.technique.title).small().color(Color32::from_gray(190)));
    let state = &mut session.halves[half];
    let mut facts = Vec::new();
    if !state.times.frames.is_empty() && !state.times.untimed {
        facts.push(numbers::milliseconds(state.times.median_total()));
    }
    if let Some(Ok(metrics)) = state.measured.metrics.as_ref().filter(|_| session.truth.is_some()) {
        facts.push(format!("error {:.4}", metrics.average_error));
    }
    if !facts.is_empty() {
        ui.label(RichText::new(facts.join("   ")).monospace().color(style::ON_IMAGE));
    }
    let mut back = None;
    if let Some((making, job)) = state.making.as_ref().filter(|(c, _)| *c == *choice) {
        ui.horizontal(|ui| {
            ui.add(egui::Spinner::new().size(12.0));
            ui.label(RichText::new(format!("compiling {} s", job.seconds() as u32)).small());
            let before = state.made.as_ref().map(|m| m.0.clone()).filter(|m| m != making);
            if before.is_some() && job.seconds() > 1.0 && ui.small_button("Cancel").clicked() {
                back = before;
            }
        });
    }
    if let Some(before) = back {
        *choice = before;
        state.making = None;
    }
    if let Some((_, error)) = state.failed.as_ref().filter(|f| f.0 == *choice) {
        ui.label(RichText::new(error).color(style::BAD));
    }
}

fn truth(ui: &mut egui::Ui, session: &Session) {
    ui.label(RichText::new("Ray-traced truth").strong().size(15.0).color(style::ON_IMAGE));
    let (text, color) = progress(session);
    ui.set_max_width(280.0);
    ui.add(egui::Label::new(RichText::new(text).small().color(color)).wrap());
}

/// Progress of the truth as text, with its colour.
fn progress(session: &Session) -> (String, Color32) {
    match session.truth.as_ref().map(Truth::progress) {
        None => ("waits until everything rests".to_owned(), Color32::from_gray(190)),
        Some(died @ Progress::Died(_)) => (died.to_string(), style::BAD),
        Some(other) => (other.to_string(), Color32::from_gray(190)),
    }
}

fn color_bar(ui: &egui::Ui, area: Rect, session: &Session) {
    let painter = ui.painter_at(area);
    let size = vec2(220.0f32.min(area.width() * 0.5), 12.0);
    let bar = Rect::from_center_size(pos2(area.center().x, area.bottom() - 38.0), size);
    let card = bar.expand2(vec2(34.0, 7.0)).translate(vec2(0.0, 8.0)).expand2(vec2(0.0, 9.0));
    painter.rect_filled(card, 5.0, style::SHADE);
    let (text, color) = progress(session);
    let most = (area.width() - 40.0).max(60.0);
    let galley = painter.layout(format!("the truth: {text}"), FontId::proportional(11.0), color, most);
    let place = Align2::CENTER_BOTTOM.anchor_size(card.center_top() - vec2(0.0, 6.0), galley.size());
    painter.rect_filled(place.expand2(vec2(8.0, 3.0)), 4.0, style::SHADE);
    painter.galley(place.min, galley, color);
    let steps = 64;
    for i in 0..steps {
        let part = |k: i32| bar.left() + bar.width() * k as f32 / steps as f32;
        let strip = Rect::from_x_y_ranges(part(i)..=part(i + 1) + 0.5, bar.y_range());
        let [r, g, b] = heat_color((f64::from(i) + 0.5 - f64::from(steps) / 2.0) / f64::from(steps) * 2.0 * HEAT_SCALE);
        painter.rect_filled(strip, 0.0, Color32::from_rgb(r, g, b));
    }
    let font = FontId::proportional(11.0);
    let y = bar.bottom() + 4.0;
    let ends = [(0.0, format!("{:+.2}", -HEAT_SCALE)), (0.5, "0".to_owned()), (1.0, format!("{HEAT_SCALE:+.2}"))];
    for (part, text) in ends {
        painter.text(pos2(bar.left() + bar.width() * part, y), Align2::CENTER_TOP, text, font.clone(), style::ON_IMAGE);
    }
    for (part, text) in [(0.25, "too dark"), (0.75, "too light")] {
        painter.text(
            pos2(bar.left() + bar.width() * part, y),
            Align2::CENTER_TOP,
            text,
            font.clone(),
            Color32::from_gray(180),
        );
    }
}
