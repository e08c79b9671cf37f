//! What the mouse and the keys do.

use crate::view_state::ViewState;
use eframe::egui::{self, Align2};

const MOUSE: &[(&str, &str)] = &[
    ("drag", "orbit"),
    ("right or middle drag, shift + drag", "pan"),
    ("wheel, pinch", "zoom"),
    ("ctrl + drag", "look around"),
    ("W A S D, Q E", "fly; faster with shift"),
    ("the yellow squares, circle, ring", "resize, move and turn the light"),
    ("K + drag", "turn the light around what it faces"),
    ("the line between the halves", "drag it"),
];

const KEYS: &[(&str, &str)] = &[
    ("1  2  3", "one technique, two, one against the truth"),
    ("P  V  X", "image, visibility, error"),
    ("space", "turn the occluders, or pause"),
    ("L", "handles of the light on or off"),
    ("R", "camera, light and occluders as the scene has them"),
    ("F1", "this help"),
];

/// The window, if it is open.
pub fn show(ctx: &egui::Context, view_state: &mut ViewState) {
    egui::Window::new("Help")
        .open(&mut view_state.help)
        .anchor(Align2::CENTER_CENTER, [0.0, 0.0])
        .resizable(false)
        .collapsible(false)
        .show(ctx, |ui| {
            for (title, list) in [("Mouse", MOUSE), ("Keys", KEYS)] {
                ui.strong(title);
                egui::Grid::new(title).num_columns(2).spacing([18.0, 4.0]).show(ui, |ui| {
                    for (what, does) in list {
                        ui.monospace(*what);
                        ui.label(*does);
                        ui.end_row();
                    }
                });
                ui.add_space(6.0);
            }
            ui.label("Drop a model or a scene file on the window to open it. Every control says more when pointed at.");
        });
}
