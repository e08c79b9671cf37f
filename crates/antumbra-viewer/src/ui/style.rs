//! Colours and sizes of the controls.

use eframe::egui::{self, Color32, CornerRadius, FontId, Margin, Stroke, TextStyle, Visuals};

/// Smallest size of a window that shows controls, points: below, bars and panels would have negative sizes.
pub const LEAST: f32 = 100.0;
/// Width of the side panel, points.
pub const PANEL: f32 = 296.0;
/// Height of the graph, points.
pub const GRAPH: f32 = 132.0;
/// Handles and selections.
pub const ACCENT: Color32 = Color32::from_rgb(255, 196, 84);
/// Text over the image.
pub const ON_IMAGE: Color32 = Color32::from_rgb(240, 240, 244);
/// Behind text over the image.
pub const SHADE: Color32 = Color32::from_rgba_premultiplied(14, 15, 20, 205);
/// Errors.
pub const BAD: Color32 = Color32::from_rgb(255, 122, 105);
/// The world's axes.
pub const AXES: [Color32; 3] =
    [Color32::from_rgb(240, 92, 92), Color32::from_rgb(122, 200, 92), Color32::from_rgb(92, 148, 255)];

/// Colours of passes, repeated after the last; neighbours are distinct.
const PASSES: [Color32; 8] = [
    Color32::from_rgb(92, 148, 214),
    Color32::from_rgb(240, 170, 80),
    Color32::from_rgb(122, 190, 132),
    Color32::from_rgb(206, 118, 190),
    Color32::from_rgb(232, 214, 110),
    Color32::from_rgb(120, 204, 214),
    Color32::from_rgb(222, 118, 108),
    Color32::from_rgb(160, 150, 220),
];

/// The colour of a pass.
pub fn pass_color(index: usize) -> Color32 {
    PASSES[index % PASSES.len()]
}

/// Applies the style to egui.
pub fn apply(ctx: &egui::Context) {
    ctx.set_theme(egui::Theme::Dark);
    let mut visuals = Visuals::dark();
    visuals.panel_fill = Color32::from_rgb(27, 28, 33);
    visuals.window_fill = Color32::from_rgb(33, 34, 40);
    visuals.extreme_bg_color = Color32::from_rgb(17, 18, 22);
    visuals.selection.bg_fill = Color32::from_rgb(120, 86, 22);
    visuals.selection.stroke = Stroke::new(1.0, Color32::from_rgb(255, 232, 190));
    visuals.hyperlink_color = ACCENT;
    visuals.widgets.noninteractive.fg_stroke.color = Color32::from_rgb(202, 204, 212);
    visuals.widgets.inactive.fg_stroke.color = Color32::from_rgb(222, 224, 230);
    visuals.widgets.inactive.weak_bg_fill = Color32::from_rgb(48, 50, 58);
    for widget in [&mut visuals.widgets.inactive, &mut visuals.widgets.hovered, &mut visuals.widgets.active] {
        widget.corner_radius = CornerRadius::same(4);
    }
    ctx.set_visuals_of(egui::Theme::Dark, visuals);
    ctx.style_mut_of(egui::Theme::Dark, |style| {
        style.spacing.item_spacing = egui::vec2(7.0, 5.0);
        style.spacing.button_padding = egui::vec2(7.0, 3.0);
        style.spacing.slider_width = 118.0;
        style.text_styles.insert(TextStyle::Body, FontId::proportional(13.0));
        style.text_styles.insert(TextStyle::Button, FontId::proportional(13.0));
        style.text_styles.insert(TextStyle::Small, FontId::proportional(11.0));
        style.text_styles.insert(TextStyle::Heading, FontId::proportional(15.0));
        style.text_styles.insert(TextStyle::Monospace, FontId::monospace(12.0));
    });
}

/// A card over the image.
pub fn card() -> egui::Frame {
    egui::Frame::new().fill(SHADE).corner_radius(CornerRadius::same(5)).inner_margin(Margin::symmetric(8, 5))
}
