//! Messages and progress.

use super::style;
use crate::session::Session;
use eframe::egui::{self, Align2, Color32, Rect, RichText, vec2};
use web_time::{Duration, Instant};

/// How long a message of success stays on the screen.
const SHOWN: Duration = Duration::from_secs(6);

/// Messages on the screen. Errors stay until they are closed.
#[derive(Default)]
pub struct Notices {
    list: Vec<Notice>,
}

struct Notice {
    text: String,
    is_error: bool,
    count: usize,
    since: Instant,
}

impl Notices {
    /// Adds an error.
    pub fn error(&mut self, text: impl Into<String>) {
        self.push(text.into(), true);
    }

    /// Adds a message of success.
    pub fn done(&mut self, text: impl Into<String>) {
        self.push(text.into(), false);
    }

    /// All errors on the screen.
    pub fn errors(&self) -> impl Iterator<Item = &str> {
        self.list.iter().filter(|n| n.is_error).map(|n| n.text.as_str())
    }

    /// True if nothing is on the screen.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Closes all messages.
    pub fn clear(&mut self) {
        self.list.clear();
    }

    fn push(&mut self, text: String, is_error: bool) {
        match self.list.iter_mut().find(|n| n.text == text) {
            Some(known) => (known.count, known.since) = (known.count + 1, Instant::now()),
            None => self.list.push(Notice { text, is_error, count: 1, since: Instant::now() }),
        }
    }
}

/// Draws messages at the lower left of the image, and a progress card while a scene is opened.
pub fn show(ctx: &egui::Context, area: Option<Rect>, session: &mut Session, notices: &mut Notices) {
    let area = area.unwrap_or(ctx.content_rect());
    opening(ctx, area, session);
    notices.list.retain(|n| n.is_error || n.since.elapsed() < SHOWN);
    let mut closed = None;
    egui::Area::new(egui::Id::unique("notices"))
        .pivot(Align2::LEFT_BOTTOM)
        .fixed_pos(area.left_bottom() + vec2(10.0, -10.0))
        .constrain_to(area)
        .show(ctx, |ui| {
            ui.set_max_width((area.width() - 40.0).clamp(120.0, 620.0));
            for (i, notice) in notices.list.iter().enumerate() {
                style::card().show(ui, |ui| {
                    ui.horizontal_top(|ui| {
                        let color = if notice.is_error { style::BAD } else { Color32::from_rgb(160, 220, 170) };
                        ui.colored_label(color, if notice.is_error { "Error" } else { "Done" });
                        let times =
                            if notice.count > 1 { format!("  ({} times)", notice.count) } else { String::new() };
                        let text = RichText::new(format!("{}{times}", notice.text)).color(style::ON_IMAGE);
                        ui.add(egui::Label::new(text).wrap().selectable(true));
                        if ui.small_button("close").clicked() {
                            closed = Some(i);
                        }
                    });
                });
            }
        });
    if let Some(i) = closed {
        notices.list.remove(i);
    }
    if notices.list.iter().any(|n| !n.is_error) {
        ctx.request_repaint_after(Duration::from_millis(500));
    }
}

fn opening(ctx: &egui::Context, area: Rect, session: &mut Session) {
    let Some(job) = &session.opening else { return };
    let mut cancelled = false;
    egui::Area::new(egui::Id::unique("opening")).pivot(Align2::CENTER_CENTER).fixed_pos(area.center()).show(
        ctx,
        |ui| {
            egui::Frame::window(ui.style()).show(ui, |ui| {
                ui.set_width(300.0);
                ui.horizontal(|ui| {
                    ui.spinner();
                    ui.add(egui::Label::new(RichText::new(&job.title).strong()).truncate());
                });
                ui.label(format!("{} …   {:.0} s", job.step(), job.seconds()));
                cancelled = ui.button("Cancel").clicked();
            });
        },
    );
    ctx.request_repaint_after(Duration::from_millis(120));
    if cancelled {
        session.opening = None;
    }
}
