//! The window of a technique's debug views.

use super::{UiState, style};
use crate::inspector;
use crate::session::Session;
use crate::view_state::{DebugSelection, ViewState};
use antumbra::gpu::debug_view::{DebugContent, DebugLayout, DebugView};
use eframe::egui::{self, Color32, Rect, RichText, Sense, Stroke, Vec2, pos2};
use eframe::egui_wgpu::RenderState;

/// The window, if it is open.
pub fn show(
    ctx: &egui::Context,
    render: &RenderState,
    view_state: &mut ViewState,
    session: &mut Session,
    memory: &mut UiState,
) {
    let Some(mut debug) = view_state.debug.clone() else { return };
    debug.half = debug.half.min(view_state.techniques() - 1);
    let mut open = true;
    egui::Window::new("Debug views")
        .open(&mut open)
        .default_size([380.0, 470.0])
        .default_pos(pos2(24.0, 120.0))
        .show(ctx, |ui| window(ui, render, session, memory, &mut debug, view_state.techniques()));
    view_state.debug = open.then_some(debug);
}

fn window(
    ui: &mut egui::Ui,
    render: &RenderState,
    session: &mut Session,
    memory: &mut UiState,
    debug: &mut DebugSelection,
    halves: usize,
) {
    if halves > 1 {
        ui.horizontal(|ui| {
            for (i, side) in ["Left", "Right"].into_iter().enumerate() {
                ui.selectable_value(&mut debug.half, i, side);
            }
        });
    }
    let Some((choice, technique)) = &session.halves[debug.half].made else {
        ui.weak("nothing is drawn yet");
        return;
    };
    let views: Vec<DebugView> = technique.debug_views().into_iter().filter(inspector::is_shown).collect();
    let Some(view) = views.iter().find(|p| p.name == debug.name).or(views.first()) else {
        ui.weak(format!("{} has no debug views", choice.technique.name));
        return;
    };
    view.name.clone_into(&mut debug.name);
    ui.horizontal_wrapped(|ui| {
        for p in &views {
            if ui.selectable_label(p.name == debug.name, p.name).on_hover_text(p.help).clicked() {
                p.name.clone_into(&mut debug.name);
            }
        }
    });
    ui.label(RichText::new(view.help).small().weak());
    if inspector::parts(&view.content) != [1; 3] {
        part(ui, &view.content, debug);
    }
    session.inspector.poll();
    session.inspector.draw(&session.gpu, view, debug.part);
    let side = ui.available_width().min(ui.available_height() - 22.0).max(64.0);
    let (rect, _) = ui.allocate_exact_size(Vec2::splat(side), Sense::hover());
    match &view.content {
        DebugContent::LightPoints(points) => dots(ui, rect, points),
        content => {
            let id = *memory.debug_view.get_or_insert_with(|| {
                let view = &session.inspector.shown.view;
                render.renderer.write().register_native_texture(&render.device, view, wgpu::FilterMode::Nearest)
            });
            let rect = match content {
                DebugContent::Buffer(_, DebugLayout::Pixels { size } | DebugLayout::Numbers { size, .. }) => {
                    fitted(rect, size[0] as f32 / size[1].max(1) as f32)
                }
                _ => rect,
            };
            let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
            ui.painter().image(id, rect, uv, Color32::WHITE);
        }
    }
    if let Some([low, high]) = session.inspector.range {
        ui.label(RichText::new(format!("black {low:.5}    white {high:.5}")).monospace().small());
    }
}

/// Choice of layer, mip level and channel.
fn part(ui: &mut egui::Ui, content: &DebugContent, debug: &mut DebugSelection) {
    let [layers, levels, channels] = inspector::parts(content);
    let part = &mut debug.part;
    part.layer = part.layer.min(layers - 1);
    part.level = part.level.min(levels - 1);
    part.channel = part.channel.min(channels - 1);
    ui.horizontal(|ui| {
        for (name, value, count) in [
            ("layer", &mut part.layer, layers),
            ("level", &mut part.level, levels),
            ("channel", &mut part.channel, channels),
        ] {
            if count > 1 {
                ui.add(
                    egui::DragValue::new(value)
                        .range(0..=count - 1)
                        .speed(0.05)
                        .prefix(format!("{name} "))
                        .suffix(format!(" of {count}")),
                );
            }
        }
        let [width, height] = inspector::size(content).map(|side| (side >> part.level).max(1));
        ui.weak(format!("{width} × {height}"));
    });
}

/// The largest rectangle of an aspect ratio within another.
fn fitted(rect: Rect, aspect: f32) -> Rect {
    let size = if aspect > 1.0 {
        Vec2::new(rect.width(), rect.width() / aspect)
    } else {
        Vec2::new(rect.height() * aspect, rect.height())
    };
    Rect::from_min_size(rect.min, size)
}

fn dots(ui: &egui::Ui, rect: Rect, points: &[glam::Vec2]) {
    let rect = rect.shrink(10.0);
    ui.painter().rect(
        rect,
        0.0,
        ui.visuals().extreme_bg_color,
        Stroke::new(1.0, style::ACCENT),
        egui::StrokeKind::Inside,
    );
    for p in points {
        let at = pos2(rect.center().x + p.x * rect.width(), rect.center().y - p.y * rect.height());
        ui.painter().circle_filled(at, 3.0, style::ACCENT);
    }
}
