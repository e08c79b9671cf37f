//! Controls of settings, made from their descriptions.

use crate::choice::Choice;
use antumbra::technique::settings::{Kind, Setting};
use eframe::egui::{self, RichText};
use serde_json::Value;

/// All settings of a technique. They apply when a drag ends, as each change compiles and allocates anew.
pub fn show(ui: &mut egui::Ui, choice: &mut Choice, id: usize) {
    let mut changed = None;
    egui::Grid::new(("settings", id)).num_columns(2).spacing([10.0, 6.0]).show(ui, |ui| {
        for setting in choice.technique.settings {
            let is_changed = *choice.value(setting) != choice.default_of(setting);
            let text = RichText::new(setting.key.replace('_', " "));
            let text = if is_changed { text.color(super::style::ACCENT) } else { text };
            let label = ui.add(egui::Label::new(text).sense(egui::Sense::click()));
            let label = label.on_hover_text(format!("{}\n\n{}", setting.help, range(setting)));
            if is_changed {
                let default = choice.default_of(setting);
                label.context_menu(|ui| {
                    if ui.button("Back to the default").clicked() {
                        changed = Some((setting, default.clone()));
                        ui.close();
                    }
                });
            }
            ui.horizontal(|ui| {
                if let Some(value) = control(ui, choice, setting, id) {
                    changed = Some((setting, value));
                }
            });
            ui.end_row();
        }
    });
    if let Some((setting, value)) = changed {
        choice.set(setting, value);
    }
}

/// The range of a setting as text.
fn range(setting: &Setting) -> String {
    match setting.kind {
        Kind::Integer { min, max } => format!("{}: whole number, {min} to {max}", setting.key),
        Kind::Number { min, max } => format!("{}: number, {min} to {max}", setting.key),
        Kind::Toggle => format!("{}: true or false", setting.key),
        Kind::Choice { options } => format!("{}: {}", setting.key, options.join(", ")),
        Kind::Points { max } => format!("{}: x y;x y;..., from 0 to 1, up to {max} points", setting.key),
    }
}

/// Draws the control; returns a value after a change.
fn control(ui: &mut egui::Ui, choice: &Choice, setting: &Setting, id: usize) -> Option<Value> {
    let value = choice.value(setting);
    match setting.kind {
        Kind::Toggle => {
            let mut on = value.as_bool().unwrap_or_default();
            ui.checkbox(&mut on, "").changed().then(|| on.into())
        }
        Kind::Choice { options } => choose(ui, value.as_str().unwrap_or_default(), options, (setting.key, id)),
        Kind::Integer { min, max } if min >= 16 => texels(ui, value.as_u64()? as u32, [min, max], (setting.key, id)),
        Kind::Integer { min, max } => {
            let number = slide(ui, value.as_f64()?, [min.into(), max.into()], true, (setting.key, id))?;
            Some((number.round() as u32).into())
        }
        Kind::Number { min, max } => {
            let number = slide(ui, value.as_f64()?, [min.into(), max.into()], false, (setting.key, id))?;
            Some((number as f32).into())
        }
        Kind::Points { max } => points(ui, value, max as usize, (setting.key, id)),
    }
}

/// Points as text in the form of a SPEC; text that cannot be read changes nothing.
fn points(ui: &mut egui::Ui, value: &Value, max: usize, id: (&str, usize)) -> Option<Value> {
    let memory = ui.scope_id().with(("typed", id));
    let pairs: Vec<[f32; 2]> = serde_json::from_value(value.clone()).unwrap_or_default();
    let written = pairs.iter().map(|[x, y]| format!("{x} {y}")).collect::<Vec<_>>().join(";");
    let mut text: String = ui.data_mut(|d| d.remove_temp(memory)).unwrap_or(written);
    let response = ui.add(egui::TextEdit::singleline(&mut text).hint_text("none").desired_width(140.0));
    if response.has_focus() {
        ui.data_mut(|d| d.insert_temp(memory, text));
        return None;
    }
    let number = |word: &str| word.parse::<f32>().ok().filter(|v| (0.0..=1.0).contains(v));
    let pair = |point: &str| {
        let numbers: Option<Vec<f32>> = point.split_whitespace().map(number).collect();
        numbers.and_then(|n| <[f32; 2]>::try_from(n).ok())
    };
    let typed: Option<Vec<[f32; 2]>> = text.split(';').filter(|p| !p.trim().is_empty()).map(pair).collect();
    typed.filter(|typed| *typed != pairs && typed.len() <= max).map(|typed| serde_json::json!(typed))
}

/// Words: up to three side by side, more in a list.
fn choose(ui: &mut egui::Ui, value: &str, options: &[&'static str], id: (&str, usize)) -> Option<Value> {
    let mut chosen = None;
    let mut offer = |ui: &mut egui::Ui| {
        for option in options {
            if ui.selectable_label(value == *option, *option).clicked() && value != *option {
                chosen = Some(Value::from(*option));
            }
        }
    };
    let letters: usize = options.iter().map(|o| o.len() + 2).sum();
    if letters <= 26 {
        offer(ui);
    } else {
        egui::ComboBox::from_id_salt(id).selected_text(value).show_ui(ui, offer);
    }
    chosen
}

/// Sizes of maps: powers of two in a list, other numbers by typing.
fn texels(ui: &mut egui::Ui, value: u32, [min, max]: [u32; 2], id: (&str, usize)) -> Option<Value> {
    let mut chosen = None;
    egui::ComboBox::from_id_salt(id).width(70.0).selected_text(value.to_string()).show_ui(ui, |ui| {
        for side in (4..=14).map(|p| 1u32 << p).filter(|s| (min.max(64)..=max).contains(s)) {
            if ui.selectable_label(side == value, side.to_string()).clicked() {
                chosen = Some(side);
            }
        }
    });
    let typed = until_let_go(ui, id, value.into(), |ui, number| {
        ui.add(egui::DragValue::new(number).range(min..=max).speed(8.0).max_decimals(0).update_while_editing(false))
    });
    chosen.or(typed.map(|t| t.round() as u32)).filter(|c| *c != value).map(Value::from)
}

fn slide(ui: &mut egui::Ui, value: f64, [min, max]: [f64; 2], whole: bool, id: (&str, usize)) -> Option<f64> {
    until_let_go(ui, id, value, |ui, number| {
        let mut slider = egui::Slider::new(number, min..=max).update_while_editing(false);
        if max - min > 64.0 {
            slider = slider.logarithmic(true).smallest_positive(if whole { 1.0 } else { 0.01 });
        }
        // A slider rounds what it shows, so it must show all digits that defaults have.
        ui.add(if whole { slider.integer() } else { slider.max_decimals(5) })
    })
}

/// A control whose value applies when the pointer releases it or typing ends.
fn until_let_go(
    ui: &mut egui::Ui,
    id: (&str, usize),
    value: f64,
    control: impl FnOnce(&mut egui::Ui, &mut f64) -> egui::Response,
) -> Option<f64> {
    let memory = ui.scope_id().with(("held", id));
    let kept: Option<f64> = ui.data_mut(|d| d.remove_temp(memory));
    let mut number = kept.unwrap_or(value);
    let response = control(ui, &mut number);
    // A slider is several widgets; only the pointer's state covers them all.
    if ui.input(|i| i.pointer.any_down()) && (response.changed() || kept.is_some()) {
        ui.data_mut(|d| d.insert_temp(memory, number));
        return None;
    }
    ((number - value).abs() > 1e-9 * value.abs().max(1.0)).then_some(number)
}
