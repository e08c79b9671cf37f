//! The bar on top: the scene, what stands beside what, what is shown, and what can be taken away.

use super::{Memory, Save, Wishes};
use crate::desk::{Compare, Desk};
use crate::open::{Source, thousands};
use crate::session::Session;
use crate::show::Show;
use antumbra_scene::builtin;
use eframe::egui::{self, RichText};

/// Points that the choices and what follows them take with words before them.
const LABELS: f32 = 860.0;
/// Points that the choice of what is shown takes, and the buttons that move things.
const SHOWS: f32 = 210.0;
const TURNS: f32 = 220.0;
/// Points that what stands on the right takes.
const LAST: f32 = 110.0;

/// A line before the next group, or the next row where this one has no room for it.
fn separator_or_row(ui: &mut egui::Ui, group: f32) {
    if ui.available_size_before_wrap().x > group {
        ui.separator();
    } else {
        ui.end_row();
    }
}

/// The bar.
pub fn show(ui: &mut egui::Ui, desk: &mut Desk, session: &mut Session, memory: &mut Memory, wishes: &mut Wishes) {
    egui::MenuBar::new().ui(ui, |ui| ui.horizontal_wrapped(|ui| row(ui, desk, session, memory, wishes)));
}

fn row(ui: &mut egui::Ui, desk: &mut Desk, session: &mut Session, memory: &mut Memory, wishes: &mut Wishes) {
    ui.menu_button("Scene", |ui| scenes(ui, desk, memory, wishes)).response.on_hover_text("Built-in scenes, or a file");
    if ui.button("Open …").on_hover_text("A model or a scene file; or drop one on the picture").clicked() {
        wishes.choose = true;
    }
    if let Some(open) = &desk.open {
        let triangles = session.stage.as_ref().map_or(0, |s| s.triangles);
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
        (Compare::One, "One", "One technique on the whole picture (1)"),
        (Compare::Two, "Two side by side", "Two techniques; drag the line between them (2)"),
        (
            Compare::Truth,
            "Against the truth",
            "A technique beside the ray-traced truth, which gets finer by itself (3)",
        ),
    ] {
        ui.selectable_value(&mut desk.compare, value, text).on_hover_text(help);
    }
    separator_or_row(ui, SHOWS);
    if is_wide {
        ui.weak("show");
    }
    for (value, text, help) in [
        (Show::Picture, "Picture", "The shaded picture (P)"),
        (Show::Visibility, "Visibility", "The part of the light that each pixel sees: white all, black none (V)"),
        (Show::Error, "Error", "Red where a technique is lighter than the truth, blue where it is darker (X)"),
    ] {
        ui.selectable_value(&mut desk.show, value, text).on_hover_text(help);
    }
    separator_or_row(ui, TURNS);
    let can_turn = session.stage.as_ref().is_some_and(|s| s.has_occluders());
    ui.add_enabled_ui(can_turn, |ui| {
        let text = if desk.turning { "Pause" } else { "Turn occluders" };
        if ui.button(text).on_hover_text("Turns what casts shadows (space)").clicked() {
            desk.turning = !desk.turning;
        }
    });
    if !desk.is_as_opened()
        && ui.button("Reset view").on_hover_text("Camera, light and occluders as the scene has them (R)").clicked()
    {
        reset(desk);
    }
    // On the right, or in the next row where there is no room for both.
    if ui.available_size_before_wrap().x > LAST {
        let layout = egui::Layout::right_to_left(egui::Align::Center);
        ui.with_layout(layout, |ui| {
            ui.toggle_value(&mut desk.help, "Help");
            ui.menu_button("Save", |ui| saves(ui, desk, wishes));
        });
    } else {
        ui.end_row();
        ui.menu_button("Save", |ui| saves(ui, desk, wishes));
        ui.toggle_value(&mut desk.help, "Help");
    }
}

/// Camera, light and occluders as the scene asks for.
pub fn reset(desk: &mut Desk) {
    if let Some(open) = desk.open.clone() {
        desk.take(open);
    }
}

fn scenes(ui: &mut egui::Ui, desk: &Desk, memory: &mut Memory, wishes: &mut Wishes) {
    ui.set_min_width(320.0);
    for info in builtin::list() {
        let argument = format!("builtin:{}", info.name);
        let is_open = desk.open.as_ref().is_some_and(|o| o.source == argument);
        let text = format!("{}  ·  {}, {} triangles", info.name, info.title, thousands(info.triangles));
        let button = ui.selectable_label(is_open, text).on_hover_ui(|ui| {
            ui.strong(info.title);
            ui.label(info.description);
        });
        if button.clicked() {
            wishes.open = Some(Source::Argument(argument));
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
            wishes.open = Some(Source::Argument(path));
            ui.close();
        }
    });
    ui.weak("Or drop a file on the window: .glb, .gltf, .obj, .ply, or a scene file (.toml, .json).");
}

fn saves(ui: &mut egui::Ui, desk: &Desk, wishes: &mut Wishes) {
    ui.set_min_width(250.0);
    let halves = desk.techniques();
    let side = |i: usize| if halves == 1 { "" } else { [" of the left", " of the right"][i] };
    let mut items = vec![
        ("Picture (.png)".to_owned(), Save::Picture),
        ("Whole window (.png)".to_owned(), Save::Window),
        ("Scene file (.toml)".to_owned(), Save::Scene),
    ];
    items.extend((0..halves).map(|i| (format!("Copy SPEC{}", side(i)), Save::Spec(i))));
    items.extend((0..halves).map(|i| (format!("Copy command line{}", side(i)), Save::Command(i))));
    for (text, save) in items {
        if ui.button(text).clicked() {
            wishes.save = Some(save);
            ui.close();
        }
    }
}
