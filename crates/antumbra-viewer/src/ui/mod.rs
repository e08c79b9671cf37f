//! The controls: bars, panels, and what is drawn over the picture.

mod bar;
mod controls;
mod graph;
mod help;
mod inside;
mod notices;
mod numbers;
mod overlay;
mod panel;
mod picture;
mod sky;
pub mod style;

pub use notices::Notices;
pub use picture::{Grab, screen};

use crate::desk::Desk;
use crate::open::Source;
use crate::session::Session;
use eframe::egui;
use eframe::egui_wgpu::RenderState;

/// What the controls ask of the program.
#[derive(Default)]
pub struct Wishes {
    /// To open a scene.
    pub open: Option<Source>,
    /// To be asked for a file by the desktop's or the browser's dialog.
    pub choose: bool,
    /// To take something away.
    pub save: Option<Save>,
}

/// What can be taken away.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Save {
    /// The picture as a PNG file.
    Picture,
    /// The whole window as a PNG file.
    Window,
    /// A scene file.
    Scene,
    /// The SPEC of a half, to the clipboard.
    Spec(usize),
    /// The command line that draws the same with a half's technique, to the clipboard.
    Command(usize),
}

/// What hints tell of.
#[derive(Clone, Copy, Debug, Default)]
pub struct Known {
    /// That the scene can be turned, panned and zoomed.
    pub moving: bool,
    /// That the line between the halves can be dragged.
    pub dividing: bool,
}

/// What the controls remember from frame to frame and nobody else needs.
#[derive(Default)]
pub struct Memory {
    /// Messages on the screen.
    pub notices: Notices,
    /// What the pointer holds.
    pub grab: Option<Grab>,
    /// The path that is being typed.
    pub path: String,
    /// What the user has found out already, so that it need not be said any more.
    pub known: Known,
    /// Where the picture is on the screen, points.
    pub area: Option<egui::Rect>,
    /// Textures of the pictures as egui knows them, and for which sizes.
    pub textures: Option<([egui::TextureId; 2], u64)>,
    /// GPU errors that have been shown.
    pub faults_shown: usize,
    /// The inner picture as egui knows it.
    pub inner: Option<egui::TextureId>,
}

/// One frame of controls. The picture is drawn in between, when its size is known.
pub fn show(
    ui: &mut egui::Ui,
    render: &RenderState,
    desk: &mut Desk,
    session: &mut Session,
    memory: &mut Memory,
) -> Wishes {
    let mut wishes = Wishes::default();
    if ui.available_size().min_elem() < style::LEAST {
        return wishes;
    }
    egui::Panel::top("bar").show(ui, |ui| bar::show(ui, desk, session, memory, &mut wishes));
    egui::Panel::right("panel")
        .default_size(style::PANEL)
        .size_range(240.0..=460.0)
        .show(ui, |ui| panel::show(ui, desk, session, &mut wishes));
    if desk.times {
        egui::Panel::bottom("times").exact_size(style::GRAPH).show(ui, |ui| graph::show(ui, desk, session));
    }
    egui::CentralPanel::no_frame().show(ui, |ui| {
        picture::show(ui, render, desk, session, memory);
        if let Some(area) = memory.area {
            // Messages are where hints are.
            let moving = memory.known.moving || !memory.notices.is_empty();
            overlay::show(ui, area, desk, session, &Known { moving, ..memory.known });
        }
    });
    inside::show(ui.ctx(), render, desk, session, memory);
    help::show(ui.ctx(), desk);
    notices::show(ui.ctx(), memory.area, session, &mut memory.notices);
    wishes
}
