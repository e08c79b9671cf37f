//! The menu bar: scene, comparison, displayed quantity, saving.

use super::{Save, UiActions, UiState};
use crate::open::{Source, thousands};
use crate::session::Session;
use crate::show::Show;
use crate::view_state::{Compare, ViewState};
use antumbra_scene::builtin;
use eframe::egui::{self, RichText};

/// Width of the comparison group with its labels, points.
const LABELS: f32 = 860.0;
/// Width of the display group and the animation buttons, points.
const SHOWS: f32 = 210.0;
const TURNS: f32 = 220.0;
/// Width of the right group, points.
const LAST: f32 = 110.0;

/// A separator before the next group, or a new row if this one is full.
fn separator_or_row(ui: &mut egui::Ui, group: f32) {
    if ui.available_size_before_wrap().x > group {
        ui.separator();
    } else {
        ui.end_row();
    }
}

/// The bar.
pub fn show(
    ui: &mut egui::Ui,
    view_state: &mut ViewState,
    session: &mut Session,
    memory: &mut UiState,
    actions: &mut UiActions,
) {
    egui::MenuBar::new().ui(ui, |ui| ui.horizontal_wrapped(|ui| row(ui, view_state, session, memory, actions)));
}

fn row(
    ui: &mut egui::Ui,
    view_state: &mut ViewState,
    session: &mut Session,
    memory: &mut UiState,
    actions: &mut UiActions,
) {
    ui.menu_button("Scene", |ui| scenes(ui, view_state, memory, actions))
        .response
        .on_hover_text("Built-in scenes, or a file");
    if ui.button("Open …").on_hover_text("A model or a scene file; or drop one on the image").clicked() {
        actions.choose = true;
    }
    if let Some(open) = &view_state.open {
        let triangles = session.loaded.as_ref().map_or(0, |s| s.triangles);
        let name = open.scene.name.trim_start_matches("builtin:");
        ui.label(RichText::new(name).strong()).on_hover_text(&open.source);
        ui.weak(format!("{} triangles", thousands(triangles)));
    }
    let is_wide = ui.available_width() > LABELS;
    ui.separator();
    if is_wide {
        ui.weak("compare");
    }
    for (value, text, help) in [
        (Compare::One, "One", "One technique on the whole image (1)"),
        (Compare::Two, "Two side by side", "Two techniques; drag the line between them (2)"),
        (
            Compare::Truth,
            "Against the truth",
            "A technique beside the ray-traced truth, which gets finer by itself (3)",
        ),
    ] {
        ui.selectable_value(&mut view_state.compare, value, text).on_hover_text(help);
    }
    separator_or_row(ui, SHOWS);
    if is_wide {
        ui.weak("show");
    }
    for (value, text, help) in [
        (Show::Image, "Image", "The shaded image (P)"),
        (Show::Visibility, "Visibility", "The part of the light that each pixel sees: white all, black none (V)"),
        (Show::Error, "Error", "Red where a technique is lighter than the truth, blue where it is darker (X)"),
    ] {
        ui.selectable_value(&mut view_state.show, value, text).on_hover_text(help);
    }
    separator_or_row(ui, TURNS);
    let can_turn = session.loaded.as_ref().is_some_and(|s| s.has_occluders());
    ui.add_enabled_ui(can_turn, |ui| {
        let text = if view_state.turning { "Pause" } else { "Turn occluders" };
        if ui.button(text).on_hover_text("Turns what casts shadows (space)").clicked() {
            view_state.turning = !view_state.turning;
        }
    });
    if !view_state.is_as_opened()
        && ui.button("Reset view").on_hover_text("Camera, light and occluders as the scene has them (R)").clicked()
    {
        reset(view_state);
    }
    // At the right, or in the next row if this one is full.
    if ui.available_size_before_wrap().x > LAST {
        let layout = egui::Layout::right_to_left(egui::Align::Center);
        ui.with_layout(layout, |ui| {
            ui.toggle_value(&mut view_state.help, "Help");
            ui.menu_button("Save", |ui| saves(ui, view_state, actions));
        });
    } else {
        ui.end_row();
        ui.menu_button("Save", |ui| saves(ui, view_state, actions));
        ui.toggle_value(&mut view_state.help, "Help");
    }
}

/// Resets camera, light and occluders to the scene's.
pub fn reset(view_state: &mut ViewState) {
    if let Some(open) = view_state.open.clone() {
        view_state.take(open);
    }
}

fn scenes(ui: &mut egui::Ui, view_state: &ViewState, memory: &mut UiState, actions: &mut UiActions) {
    ui.set_min_width(320.0);
    for info in builtin::list() {
        let argument = format!("builtin:{}", info.name);
        let is_open = view_state.open.as_ref().is_some_and(|o| o.source == argument);
        let text = format!("{}  ·  {}, {} triangles", info.name, info.title, thousands(info.triangles));
        let button = ui.selectable_label(is_open, text).on_hover_ui(|ui| {
            ui.strong(info.title);
            ui.label(info.description);
        });
        if button.clicked() {
            actions.open = Some(Source::Argument(argument));
            ui.close();
        }
    }
    ui.separator();
    ui.horizontal(|ui| {
        let hint = "path of a .glb, .obj, .ply or scene file";
        let edit = ui.add(egui::TextEdit::singleline(&mut memory.path).hint_text(hint).desired_width(230.0));
        let enter = edit.lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Enter));
        let path = memory.path.trim().trim_matches(['"', '\'']).to_owned();
        if (ui.add_enabled(!path.is_empty(), egui::Button::new("Open")).clicked() || enter) && !path.is_empty() {
            actions.open = Some(Source::Argument(path));
            ui.close();
        }
    });
    ui.weak("Or drop a file on the window: .glb, .gltf, .obj, .ply, or a scene file (.toml, .json).");
}

fn saves(ui: &mut egui::Ui, view_state: &ViewState, actions: &mut UiActions) {
    ui.set_min_width(250.0);
    let halves = view_state.techniques();
    let side = |i: usize| if halves == 1 { "" } else { [" of the left", " of the right"][i] };
    let mut items = vec![
        ("Image (.png)".to_owned(), Save::Image),
        ("Whole window (.png)".to_owned(), Save::Window),
        ("Scene file (.toml)".to_owned(), Save::Scene),
    ];
    items.extend((0..halves).map(|i| (format!("Copy SPEC{}", side(i)), Save::Spec(i))));
    items.extend((0..halves).map(|i| (format!("Copy command line{}", side(i)), Save::Command(i))));
    for (text, save) in items {
        if ui.button(text).clicked() {
            actions.save = Some(save);
            ui.close();
        }
    }
}
