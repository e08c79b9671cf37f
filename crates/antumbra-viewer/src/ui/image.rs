//! The image: drawing and navigation.

use super::{UiState, panel, style};
use crate::light::{self, Handle, Screen};
use crate::session::Session;
use crate::view_state::{Compare, ViewState};
use crate::{camera, ui::bar};
use antumbra::View;
use antumbra_scene::RectLight;
use eframe::egui::{self, Color32, CursorIcon, Key, PointerButton, Pos2, Rect, Sense, Stroke, pos2, vec2};
use eframe::egui_wgpu::RenderState;
use glam::{Vec2, Vec3};

/// Rotation per point of a drag, radians.
const TURN: f32 = 0.006;
/// Distance at which the pointer grabs a handle, and the divider, points.
const REACH: f32 = 13.0;
const DIVIDER_REACH: f32 = 7.0;

/// The object that the pointer drags.
#[derive(Clone, Copy)]
pub enum Grab {
    /// The scene.
    View,
    /// The divider.
    Divider,
    /// A handle of the light; the light and the pointer at the start of the drag.
    Light(Handle, RectLight, Vec2),
    /// The light, which orbits its target.
    Sun,
}

/// Draws the images, handles navigation and paints the result.
pub fn show(
    ui: &mut egui::Ui,
    render: &RenderState,
    view_state: &mut ViewState,
    session: &mut Session,
    memory: &mut UiState,
) {
    let area = ui.max_rect();
    memory.area = Some(area);
    let response = ui.interact(area, ui.scope_id().with("image"), Sense::click_and_drag());
    let screen = screen(view_state, area);
    pointer(ui, &response, view_state, session, memory, &screen);
    keys(ui, view_state, session);
    if let (Some(loaded), Some(open)) = (&session.loaded, &view_state.open) {
        camera::fit_depth(&mut view_state.camera, [open.scene.camera.near, open.scene.camera.far], &loaded.bounds);
    }
    let size = pixels(ui, view_state, session, area);
    session.trace(view_state, size);
    if let Err(error) = session.draw(view_state, size) {
        memory.notices.error(format!("the image cannot be drawn: {error}"));
    }
    session.measure(view_state);
    register(render, session, memory);
    paint(ui, area, view_state, session, memory);
    if view_state.handles && session.loaded.is_some() {
        paint_light(ui, view_state, memory, &self::screen(view_state, area), response.hover_pos());
    }
}

/// Image size in pixels.
fn pixels(ui: &egui::Ui, view_state: &ViewState, session: &Session, area: Rect) -> [u32; 2] {
    let scale = ui.pixels_per_point() * view_state.resolution.unwrap_or_else(|| panel::automatic(session));
    let most = session.gpu.capabilities.max_texture_size as f32;
    [area.width(), area.height()].map(|s| (s * scale).round().clamp(0.0, most) as u32)
}

/// The projection of the image on the screen, for handles.
pub fn screen(view_state: &ViewState, area: Rect) -> Screen {
    let size = [area.width().max(1.0) as u32, area.height().max(1.0) as u32];
    Screen {
        view: View::of_camera(&view_state.camera, size),
        min: vec(area.min),
        size: Vec2::new(area.width().max(1.0), area.height().max(1.0)),
    }
}

fn vec(p: Pos2) -> Vec2 {
    Vec2::new(p.x, p.y)
}

fn pos(p: Vec2) -> Pos2 {
    pos2(p.x, p.y)
}

fn divider_x(view_state: &ViewState, area: Rect) -> f32 {
    area.left() + area.width() * view_state.divider
}

/// The object under the pointer.
fn under(view_state: &ViewState, screen: &Screen, area: Rect, at: Pos2, sun: bool) -> Grab {
    if sun {
        return Grab::Sun;
    }
    if view_state.handles {
        let near = |(_, p): &(Handle, Vec2)| (*p - vec(at)).length();
        let handles = light::handles(&view_state.light, screen);
        let nearest = handles.iter().rev().filter(|h| near(h) < REACH).min_by(|a, b| near(a).total_cmp(&near(b)));
        if let Some((handle, _)) = nearest {
            return Grab::Light(*handle, view_state.light, vec(at));
        }
    }
    let at_divider = view_state.compare != Compare::One && (at.x - divider_x(view_state, area)).abs() < DIVIDER_REACH;
    if at_divider { Grab::Divider } else { Grab::View }
}

fn pointer(
    ui: &egui::Ui,
    response: &egui::Response,
    view_state: &mut ViewState,
    session: &Session,
    memory: &mut UiState,
    screen: &Screen,
) {
    let area = response.rect;
    let sun = ui.input(|i| i.key_down(Key::K));
    let any_drag = [PointerButton::Primary, PointerButton::Secondary, PointerButton::Middle];
    if let Some(start) = ui.input(|i| i.pointer.press_origin()).filter(|_| response.drag_started()) {
        let is_primary = response.drag_started_by(PointerButton::Primary);
        memory.grab = Some(if is_primary { under(view_state, screen, area, start, sun) } else { Grab::View });
    }
    if !any_drag.iter().any(|b| response.dragged_by(*b)) {
        memory.grab = None;
    }
    let moved = response.drag_delta();
    if let (Some(grab), Some(at)) = (memory.grab, response.interact_pointer_pos()) {
        let largest = session.loaded.as_ref().map_or(100.0, |s| s.bounds.size().length());
        match grab {
            Grab::Divider => {
                memory.known.dividing = true;
                view_state.divider = ((at.x - area.left()) / area.width()).clamp(0.02, 0.98);
            }
            Grab::Light(handle, light, start) => {
                view_state.light = light::dragged(&light, handle, screen, start, vec(at), largest);
            }
            Grab::Sun => view_state.light = light::swung(&view_state.light, Vec2::new(moved.x, -moved.y) * TURN),
            Grab::View => {
                memory.known.moving |= moved != egui::Vec2::ZERO;
                move_view(ui, response, view_state, moved);
            }
        }
    }
    if let Some(at) = response.hover_pos() {
        let cursor = match memory.grab.unwrap_or_else(|| under(view_state, screen, area, at, sun)) {
            Grab::Divider => CursorIcon::ResizeHorizontal,
            Grab::Light(..) | Grab::Sun => CursorIcon::Move,
            Grab::View => CursorIcon::Default,
        };
        ui.ctx().set_cursor_icon(cursor);
        let (scroll, pinch) = ui.input(|i| (i.smooth_scroll_delta().y, i.zoom_delta()));
        let factor = pinch * (0.0025 * scroll).exp();
        if factor != 1.0 {
            memory.known.moving = true;
            camera::zoom(&mut view_state.camera, factor, radius(session));
        }
    }
}

fn move_view(ui: &egui::Ui, response: &egui::Response, view_state: &mut ViewState, moved: egui::Vec2) {
    let touch = ui.input(|i| i.multi_touch());
    let modifiers = ui.input(|i| i.modifiers);
    let by_height = Vec2::new(-moved.x, moved.y) / response.rect.height().max(1.0);
    let angles = Vec2::new(moved.x, moved.y) * TURN;
    let is_primary = response.dragged_by(PointerButton::Primary);
    if let Some(touch) = touch {
        let by = touch.translation_delta / response.rect.height().max(1.0);
        camera::pan(&mut view_state.camera, Vec2::new(-by.x, by.y));
    } else if !is_primary || modifiers.shift {
        camera::pan(&mut view_state.camera, by_height);
    } else if modifiers.command || modifiers.ctrl {
        camera::look(&mut view_state.camera, Vec2::new(angles.x, -angles.y));
    } else {
        camera::orbit(&mut view_state.camera, angles);
    }
}

fn radius(session: &Session) -> f32 {
    session.loaded.as_ref().map_or(1.0, |s| 0.5 * s.bounds.size().length())
}

fn keys(ui: &egui::Ui, view_state: &mut ViewState, session: &Session) {
    if ui.ctx().egui_wants_keyboard_input() {
        return;
    }
    let is_plain = ui.input(|i| !i.modifiers.command && !i.modifiers.ctrl && !i.modifiers.alt);
    if !is_plain {
        return;
    }
    let pressed = |key| ui.input(|i| i.key_pressed(key));
    for (key, compare) in [(Key::Num1, Compare::One), (Key::Num2, Compare::Two), (Key::Num3, Compare::Truth)] {
        if pressed(key) {
            view_state.compare = compare;
        }
    }
    for (key, show) in [
        (Key::P, crate::show::Show::Image),
        (Key::V, crate::show::Show::Visibility),
        (Key::X, crate::show::Show::Error),
    ] {
        if pressed(key) {
            view_state.show = show;
        }
    }
    if pressed(Key::Space) {
        view_state.turning = !view_state.turning && session.loaded.as_ref().is_some_and(|s| s.has_occluders());
    }
    if pressed(Key::R) {
        bar::reset(view_state);
    }
    if pressed(Key::L) {
        view_state.handles = !view_state.handles;
    }
    if pressed(Key::F1) {
        view_state.help = !view_state.help;
    }
    let down = |key| ui.input(|i| if i.key_down(key) { 1.0 } else { 0.0 });
    let along = Vec3::new(down(Key::D) - down(Key::A), down(Key::E) - down(Key::Q), down(Key::W) - down(Key::S));
    if along != Vec3::ZERO {
        let (passed, fast) = ui.input(|i| (i.stable_dt.min(0.1), if i.modifiers.shift { 4.0 } else { 1.0 }));
        camera::fly(&mut view_state.camera, along * passed * fast * 0.35 * radius(session));
        ui.ctx().request_repaint();
    }
}

/// Registers the textures of both halves with egui.
fn register(render: &RenderState, session: &Session, memory: &mut UiState) {
    let Some(targets) = &session.targets else { return };
    if memory.textures.as_ref().is_some_and(|(_, resized)| *resized == session.resized) {
        return;
    }
    let mut renderer = render.renderer.write();
    if let Some((old, _)) = memory.textures.take() {
        old.iter().for_each(|id| renderer.free_texture(id));
    }
    let mut add = |i: usize| {
        let view = &targets.halves[i].image.view;
        renderer.register_native_texture(&render.device, view, wgpu::FilterMode::Linear)
    };
    memory.textures = Some(([add(0), add(1)], session.resized));
}

fn paint(ui: &egui::Ui, area: Rect, view_state: &ViewState, session: &Session, memory: &UiState) {
    let painter = ui.painter_at(area);
    painter.rect_filled(area, 0.0, ui.visuals().extreme_bg_color);
    let (Some((textures, _)), Some(_)) = (&memory.textures, &session.loaded) else { return };
    if session.drawn == 0 {
        return;
    }
    let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
    if view_state.compare == Compare::One {
        painter.image(textures[0], area, uv, Color32::WHITE);
        return;
    }
    let x = divider_x(view_state, area);
    let (left, right) = (area.with_max_x(x), area.with_min_x(x));
    painter.with_clip_rect(left).image(textures[0], area, uv, Color32::WHITE);
    painter.with_clip_rect(right).image(textures[1], area, uv, Color32::WHITE);
    let is_held = matches!(memory.grab, Some(Grab::Divider));
    let color = if is_held { style::ACCENT } else { style::ON_IMAGE };
    painter.vline(x, area.y_range(), Stroke::new(3.0, Color32::from_black_alpha(120)));
    painter.vline(x, area.y_range(), Stroke::new(1.5, color));
    let grip = pos2(x, area.center().y);
    painter.circle(grip, 13.0, style::SHADE, Stroke::new(1.5, color));
    for side in [-1.0, 1.0] {
        let tip = grip + vec2(side * 8.0, 0.0);
        let back = [vec2(-side * 4.5, -4.5), vec2(-side * 4.5, 4.5)];
        painter.add(egui::Shape::convex_polygon(vec![tip, tip + back[0], tip + back[1]], color, Stroke::NONE));
    }
}

fn paint_light(ui: &egui::Ui, view_state: &ViewState, memory: &UiState, screen: &Screen, hover: Option<Pos2>) {
    let area = Rect::from_min_size(pos(screen.min), egui::vec2(screen.size.x, screen.size.y));
    let painter = ui.painter_at(area);
    let light = &view_state.light;
    let corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)];
    let corners: Option<Vec<Pos2>> =
        corners.iter().map(|(u, v)| screen.project(light.point(*u, *v)).map(pos)).collect();
    let shines_here = (screen.view.eye() - light.center).dot(light.basis().2) > 0.0;
    let glow = Color32::from_rgba_unmultiplied(255, 226, 150, if shines_here { 150 } else { 60 });
    if let Some(corners) = corners {
        painter.add(egui::Shape::convex_polygon(
            corners.clone(),
            glow,
            Stroke::new(4.0, Color32::from_black_alpha(90)),
        ));
        painter.add(egui::Shape::closed_line(corners, Stroke::new(1.6, style::ACCENT)));
    }
    let handles = light::handles(light, screen);
    let place = |wanted: Handle| handles.iter().find(|(h, _)| *h == wanted).map(|(_, p)| pos(*p));
    let Some(center) = place(Handle::Move) else { return };
    let has_room = area.width() > 80.0 && area.height() > 180.0;
    if !area.contains(center) && has_room {
        point_to(&painter, area, center);
    }
    if let Some(aim) = place(Handle::Aim) {
        let line =
            egui::Shape::dashed_line(&[center, aim], Stroke::new(1.2, style::ACCENT.gamma_multiply(0.55)), 7.0, 5.0);
        painter.extend(line);
    }
    let held = match memory.grab {
        Some(Grab::Light(handle, ..)) => Some(handle),
        Some(_) => None,
        None => hover.and_then(|at| match under(view_state, screen, area, at, false) {
            Grab::Light(handle, ..) => Some(handle),
            _ => None,
        }),
    };
    for (handle, at) in &handles {
        paint_handle(&painter, *handle, center, pos(*at), held == Some(*handle));
    }
    if let (Some(handle), Some(at)) = (held, hover) {
        let text = match handle {
            Handle::Move => "move the light",
            Handle::Along(0) => "move along x",
            Handle::Along(1) => "move along y",
            Handle::Along(_) => "move along z",
            Handle::Width(_) => &format!("{:.3} m wide", light.size.x),
            Handle::Height(_) => &format!("{:.3} m high", light.size.y),
            Handle::Aim => "turn the light",
        };
        let galley = painter.layout_no_wrap(text.to_owned(), egui::FontId::proportional(12.0), style::ON_IMAGE);
        let rect = Rect::from_min_size(at + vec2(16.0, 12.0), galley.size() + vec2(10.0, 6.0));
        painter.rect_filled(rect, 4.0, style::SHADE);
        painter.galley(rect.min + vec2(5.0, 3.0), galley, style::ON_IMAGE);
    }
}

fn paint_handle(painter: &egui::Painter, handle: Handle, center: Pos2, at: Pos2, held: bool) {
    let dark = Stroke::new(1.5, Color32::from_black_alpha(160));
    let grow = if held { 1.8 } else { 0.0 };
    let fill = if held { Color32::WHITE } else { style::ACCENT };
    match handle {
        Handle::Along(axis) => {
            let color = if held { Color32::WHITE } else { style::AXES[axis] };
            let direction = (at - center).normalized();
            painter.line_segment([center + direction * 9.0, at], Stroke::new(2.0, color));
            let side = direction.rot90() * (4.5 + grow);
            let tip = at + direction * 8.0;
            painter.add(egui::Shape::convex_polygon(vec![tip, at + side, at - side], color, Stroke::NONE));
        }
        Handle::Width(_) | Handle::Height(_) => {
            let rect = Rect::from_center_size(at, egui::Vec2::splat(8.0 + 2.0 * grow));
            painter.rect(rect, 2.0, fill, dark, egui::StrokeKind::Outside);
        }
        Handle::Move => {
            painter.circle(at, 6.0 + grow, fill, dark);
        }
        Handle::Aim => {
            painter.circle_stroke(at, 6.5 + grow, Stroke::new(4.5, Color32::from_black_alpha(130)));
            painter.circle_stroke(at, 6.5 + grow, Stroke::new(2.0, fill));
            painter.circle_filled(at, 2.2, fill);
        }
    }
}

/// A small arrow at the border, towards a light outside of the image.
fn point_to(painter: &egui::Painter, area: Rect, center: Pos2) {
    // The corners have labels.
    let inner = area.shrink(22.0).with_min_y(area.top() + 100.0);
    let at = inner.clamp(center);
    let direction = (center - at).normalized();
    let side = direction.rot90() * 7.0;
    let back = at - direction * 10.0;
    painter.add(egui::Shape::convex_polygon(
        vec![at + direction * 6.0, back + side, back - side],
        style::ACCENT,
        Stroke::new(1.5, Color32::from_black_alpha(160)),
    ));
    let text = painter.layout_no_wrap("light".to_owned(), egui::FontId::proportional(12.0), style::ACCENT);
    let rect = Rect::from_center_size(back - direction * 20.0, text.size() + vec2(10.0, 4.0));
    painter.rect_filled(rect, 4.0, style::SHADE);
    painter.galley(rect.min + vec2(5.0, 2.0), text, style::ACCENT);
}
