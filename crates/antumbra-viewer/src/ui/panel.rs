//! The side panel: techniques with their settings, the light, the image.

use super::{UiActions, controls, light, numbers, style};
use crate::choice::Choice;
use crate::session::Session;
use crate::truth::Progress;
use crate::view_state::{Compare, DebugSelection, ViewState};
use antumbra::Gpu;
use antumbra::techniques::TECHNIQUES;
use eframe::egui::{self, RichText};

/// The panel.
pub fn show(ui: &mut egui::Ui, view_state: &mut ViewState, session: &mut Session, actions: &mut UiActions) {
    egui::ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        ui.add_space(4.0);
        for half in 0..view_state.techniques() {
            let title = match (view_state.compare, half) {
                (Compare::One, _) => "Technique",
                (_, 0) => "Left",
                _ => "Right",
            };
            section(ui, title, |ui| technique(ui, view_state, session, half, actions));
        }
        if view_state.compare == Compare::Truth {
            section(ui, "Right", |ui| truth(ui, session));
        }
        section(ui, "Light", |ui| light::show(ui, view_state, session));
        section(ui, "Drawing", |ui| drawing(ui, view_state, session));
    });
}

fn section(ui: &mut egui::Ui, title: &str, content: impl FnOnce(&mut egui::Ui)) {
    egui::CollapsingHeader::new(RichText::new(title).strong()).default_open(true).show_unindented(ui, content);
    ui.add_space(4.0);
}

fn technique(
    ui: &mut egui::Ui,
    view_state: &mut ViewState,
    session: &mut Session,
    half: usize,
    actions: &mut UiActions,
) {
    let choice = &mut view_state.choices[half];
    let title = |t: &antumbra::TechniqueInfo| format!("{}  ·  {}", t.name, t.title);
    egui::ComboBox::from_id_salt(("technique", half))
        .width(ui.available_width() - 8.0)
        .height(480.0)
        .truncate()
        .selected_text(title(choice.technique))
        .show_ui(ui, |ui| pick(ui, choice, &session.gpu));
    ui.add(
        egui::Label::new(
            RichText::new(format!("{}: {}", choice.technique.source, choice.technique.summary)).weak().small(),
        )
        .wrap(),
    );
    let state = &mut session.halves[half];
    if let Some((_, error)) = state.failed.as_ref().filter(|f| f.0 == *choice) {
        ui.colored_label(style::BAD, error);
    }
    controls::show(ui, choice, half);
    ui.horizontal(|ui| {
        let fresh = Choice::new(choice.technique);
        if ui
            .add_enabled(*choice != fresh, egui::Button::new("Reset"))
            .on_hover_text("All settings as they come")
            .clicked()
        {
            *choice = fresh;
        }
        if ui.button("Copy SPEC").on_hover_text(choice.text()).clicked() {
            actions.save = Some(super::Save::Spec(half));
        }
        let can_look = state.made.as_ref().is_some_and(|m| !m.1.debug_views().is_empty());
        ui.add_enabled_ui(can_look, |ui| {
            if ui.button("Debug views").on_hover_text("Maps and lists of the technique").clicked() {
                view_state.debug = Some(DebugSelection { half, ..DebugSelection::default() });
            }
        });
    });
    numbers::show(ui, session, half);
}

/// The list of techniques. Those that this adapter cannot run are disabled and say why.
pub fn pick(ui: &mut egui::Ui, choice: &mut Choice, gpu: &Gpu) {
    for technique in TECHNIQUES {
        let is_chosen = technique.name == choice.technique.name;
        let refused = technique.check(gpu).err();
        let text = format!("{}  ·  {}", technique.name, technique.title);
        let button = egui::Button::selectable(is_chosen, text);
        let about = |ui: &mut egui::Ui| {
            ui.set_max_width(300.0);
            if let Some(why) = &refused {
                ui.colored_label(style::BAD, format!("Not on this adapter: {why}."));
            }
            ui.strong(technique.source);
            ui.label(technique.summary);
        };
        let item = ui.add_enabled(refused.is_none(), button).on_hover_ui(about).on_disabled_hover_ui(about);
        if item.clicked() && !is_chosen {
            *choice = Choice::new(technique);
        }
    }
}

fn truth(ui: &mut egui::Ui, session: &Session) {
    ui.label("Ray-traced truth")
        .on_hover_text("What `antumbra reference` traces: 1024 shadow rays per pixel in the end");
    let Some(truth) = &session.truth else {
        ui.weak("traced once camera, light and occluders rest");
        return;
    };
    let progress = truth.progress();
    let done = match &progress {
        Progress::Died(_) => {
            ui.colored_label(style::BAD, progress.to_string());
            return;
        }
        Progress::Preparing => 0.0,
        Progress::Tracing { done, .. } => *done,
        Progress::Done => 1.0,
    };
    let text = RichText::new(progress.to_string()).small();
    ui.add(egui::ProgressBar::new(done).text(text).desired_height(14.0));
}

fn drawing(ui: &mut egui::Ui, view_state: &mut ViewState, session: &Session) {
    egui::Grid::new("drawing").num_columns(2).spacing([10.0, 6.0]).show(ui, |ui| {
        ui.label("resolution").on_hover_text("Image pixels per screen pixel, along each axis");
        let text = |r: Option<f32>| match r {
            None => format!("auto ({:.0} %)", 100.0 * automatic(session)),
            Some(r) => format!("{:.0} %", 100.0 * r),
        };
        egui::ComboBox::from_id_salt("resolution").selected_text(text(view_state.resolution)).show_ui(ui, |ui| {
            for r in [None, Some(1.0), Some(0.75), Some(0.5), Some(1.0 / 3.0), Some(0.25)] {
                ui.selectable_value(&mut view_state.resolution, r, text(r));
            }
        });
        ui.end_row();
        ui.label("frames").on_hover_text("Drawn only when something changes, or one after the other");
        ui.checkbox(&mut view_state.keeps_drawing, "keep drawing");
        ui.end_row();
        ui.label("graph");
        ui.checkbox(&mut view_state.times, "times of passes");
        ui.end_row();
    });
    let gpu = &session.gpu;
    let host = session.targets.as_ref().map_or(0, crate::render_targets::RenderTargets::bytes);
    ui.add(egui::Label::new(RichText::new(&gpu.info.name).small().weak()).truncate()).on_hover_text(format!(
        "{}\n{:?}, {} {}\ngeometry buffer: {}",
        gpu.info.name,
        gpu.info.backend,
        gpu.info.driver,
        gpu.info.driver_info,
        numbers::bytes(host)
    ));
}

/// Default resolution: image pixels per screen pixel.
pub fn automatic(session: &Session) -> f32 {
    if session.gpu.is_software() { 0.5 } else { 1.0 }
}
