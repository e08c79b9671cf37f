//! The light's controls: numbers, and a pad of the sky.

use super::style;
use crate::light;
use crate::session::Session;
use crate::view_state::ViewState;
use eframe::egui::{self, Align2, Color32, FontId, Pos2, Sense, Stroke, Vec2, pos2, vec2};

/// Radius of the pad, points.
const RADIUS: f32 = 44.0;

/// The light's controls.
pub fn show(ui: &mut egui::Ui, view_state: &mut ViewState, session: &Session) {
    let radius = session.loaded.as_ref().map_or(1.0, |s| 0.5 * s.bounds.size().length());
    ui.horizontal(|ui| {
        pad(ui, view_state);
        ui.vertical(|ui| {
            let (azimuth, elevation, mut distance) = light::placed(&view_state.light);
            let most = (4.0 * radius).max(distance);
            let length = |ui: &mut egui::Ui, value: &mut f32, most: f32, name: &str, help: &str| {
                let drag =
                    egui::DragValue::new(value).range(0.0..=most).speed(0.004 * radius).suffix(" m").max_decimals(3);
                ui.horizontal(|ui| {
                    let response = ui.add_sized([74.0, 18.0], drag).on_hover_text(help);
                    ui.label(name).on_hover_text(help);
                    response.changed()
                })
                .inner
            };
            let largest = 2.0 * radius;
            length(ui, &mut view_state.light.size.x, largest, "wide", "The light's first edge; 0 makes a line");
            length(ui, &mut view_state.light.size.y, largest, "high", "The light's second edge; 0 and 0 make a point");
            if length(ui, &mut distance, most, "away", "Distance from the point that it faces")
                && distance > 1e-3 * radius
            {
                view_state.light = light::at(&view_state.light, azimuth, elevation, distance);
            }
            ui.checkbox(&mut view_state.handles, "handles").on_hover_text("Drawn in the image: drag them (L)");
        });
    });
}

/// Direction of the light: overhead at the centre, the horizon at the border, the camera's side at the bottom.
fn pad(ui: &mut egui::Ui, view_state: &mut ViewState) {
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(2.0 * RADIUS + 8.0), Sense::click_and_drag());
    let response = response
        .on_hover_text("Where the light stands: the middle is overhead, the rim the horizon, your place at the bottom");
    let to_camera = view_state.camera.eye - view_state.camera.target;
    let here = to_camera.x.atan2(to_camera.z);
    let (azimuth, elevation, distance) = light::placed(&view_state.light);
    let middle = rect.center();
    if let Some(p) = response.interact_pointer_pos().filter(|_| response.dragged() || response.clicked()) {
        let v = p - middle;
        let out = (v.length() / RADIUS).min(1.0);
        let angle = if out < 0.03 { azimuth } else { v.x.atan2(v.y) + here };
        view_state.light = light::at(&view_state.light, angle, (1.0 - out) * std::f32::consts::FRAC_PI_2, distance);
    }
    let painter = ui.painter_at(rect);
    painter.circle(middle, RADIUS, ui.visuals().extreme_bg_color, Stroke::new(1.0, Color32::from_gray(70)));
    painter.circle_stroke(middle, 0.5 * RADIUS, Stroke::new(1.0, Color32::from_gray(44)));
    let small = FontId::proportional(9.0);
    painter.text(pos2(middle.x, rect.bottom() - 5.0), Align2::CENTER_BOTTOM, "you", small, Color32::from_gray(120));
    let out = RADIUS * (1.0 - elevation.max(0.0) / std::f32::consts::FRAC_PI_2);
    let at: Pos2 = middle + vec2((azimuth - here).sin(), (azimuth - here).cos()) * out;
    painter.line_segment([middle, at], Stroke::new(1.0, style::ACCENT.gamma_multiply(0.5)));
    // A ring marks a light below the horizon.
    let fill = if elevation >= 0.0 { style::ACCENT } else { Color32::TRANSPARENT };
    painter.circle(at, 6.0, fill, Stroke::new(1.5, style::ACCENT));
}
