//! The window that looks into a technique.

use super::{Memory, style};
use crate::desk::{Desk, Inside};
use crate::inspect;
use crate::session::Session;
use antumbra::gpu::debug_view::{DebugContent, DebugLayout, DebugView};
use eframe::egui::{self, Color32, Rect, RichText, Sense, Stroke, Vec2, pos2};
use eframe::egui_wgpu::RenderState;

/// The window, if it is open.
pub fn show(ctx: &egui::Context, render: &RenderState, desk: &mut Desk, session: &mut Session, memory: &mut Memory) {
    let Some(mut inside) = desk.inside.clone() else { return };
    inside.half = inside.half.min(desk.techniques() - 1);
    let mut open = true;
    egui::Window::new("Debug views")
        .open(&mut open)
        .default_size([380.0, 470.0])
        .default_pos(pos2(24.0, 120.0))
        .show(ctx, |ui| window(ui, render, session, memory, &mut inside, desk.techniques()));
    desk.inside = open.then_some(inside);
}

fn window(
    ui: &mut egui::Ui,
    render: &RenderState,
    session: &mut Session,
    memory: &mut Memory,
    inside: &mut Inside,
    halves: usize,
) {
    if halves > 1 {
        ui.horizontal(|ui| {
            for (i, side) in ["Left", "Right"].into_iter().enumerate() {
                ui.selectable_value(&mut inside.half, i, side);
            }
        });
    }
    let Some((choice, technique)) = &session.halves[inside.half].made else {
        ui.weak("nothing is drawn yet");
        return;
    };
    let pictures: Vec<DebugView> = technique.debug_views().into_iter().filter(inspect::is_shown).collect();
    let Some(picture) = pictures.iter().find(|p| p.name == inside.name).or(pictures.first()) else {
        ui.weak(format!("{} has nothing to look at", choice.technique.name));
        return;
    };
    picture.name.clone_into(&mut inside.name);
    ui.horizontal_wrapped(|ui| {
        for p in &pictures {
            if ui.selectable_label(p.name == inside.name, p.name).on_hover_text(p.help).clicked() {
                p.name.clone_into(&mut inside.name);
            }
        }
    });
    ui.label(RichText::new(picture.help).small().weak());
    if inspect::parts(&picture.content) != [1; 3] {
        part(ui, &picture.content, inside);
    }
    session.inspector.poll();
    session.inspector.draw(&session.gpu, picture, inside.part);
    let side = ui.available_width().min(ui.available_height() - 22.0).max(64.0);
    let (rect, _) = ui.allocate_exact_size(Vec2::splat(side), Sense::hover());
    match &picture.content {
        DebugContent::LightPoints(points) => dots(ui, rect, points),
        content => {
            let id = *memory.inner.get_or_insert_with(|| {
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

/// Layer, level and channel, where there are several.
fn part(ui: &mut egui::Ui, content: &DebugContent, inside: &mut Inside) {
    let [layers, levels, channels] = inspect::parts(content);
    let part = &mut inside.part;
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
        let [width, height] = inspect::size(content).map(|side| (side >> part.level).max(1));
        ui.weak(format!("{width} × {height}"));
    });
}

/// The widest rectangle of a shape within another.
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
