//! The controls: bars, panels and overlays.

mod bar;
mod controls;
mod debug_views;
mod graph;
mod help;
mod image;
mod light;
mod notices;
mod numbers;
mod overlay;
mod panel;
pub mod style;

pub use image::{Grab, screen};
pub use notices::Notices;

use crate::open::Source;
use crate::session::Session;
use crate::view_state::ViewState;
use eframe::egui;
use eframe::egui_wgpu::RenderState;

/// Requests of the controls to the program.
#[derive(Default)]
pub struct UiActions {
    /// Open a scene.
    pub open: Option<Source>,
    /// Show the file dialog.
    pub choose: bool,
    /// Save or copy something.
    pub save: Option<Save>,
}

/// Content that can be saved or copied.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Save {
    /// The image as a PNG file.
    Image,
    /// Saves the whole window as a PNG file.
    Window,
    /// A scene file.
    Scene,
    /// The SPEC of a half, to the clipboard.
    Spec(usize),
    /// The command line that draws the same with a half's technique, to the clipboard.
    Command(usize),
}

/// Hints that the user no longer needs.
#[derive(Clone, Copy, Debug, Default)]
pub struct Hints {
    /// Orbit, pan and zoom.
    pub moving: bool,
    /// The divider.
    pub dividing: bool,
}

/// State of the controls that outlives a frame.
#[derive(Default)]
pub struct UiState {
    /// Messages on the screen.
    pub notices: Notices,
    /// The object that the pointer drags.
    pub grab: Option<Grab>,
    /// Text of the path field.
    pub path: String,
    /// Hints that are no longer shown.
    pub known: Hints,
    /// Area of the image on the screen, points.
    pub area: Option<egui::Rect>,
    /// egui's textures of the images, and the number of the size that they belong to.
    pub textures: Option<([egui::TextureId; 2], u64)>,
    /// GPU errors that have been shown.
    pub faults_shown: usize,
    /// egui's texture of the debug view.
    pub debug_view: Option<egui::TextureId>,
}

/// Draws the controls, and the image once its size is known.
pub fn show(
    ui: &mut egui::Ui,
    render: &RenderState,
    view_state: &mut ViewState,
    session: &mut Session,
    memory: &mut UiState,
) -> UiActions {
    let mut actions = UiActions::default();
    if ui.available_size().min_elem() < style::LEAST {
        return actions;
    }
    egui::Panel::top("bar").show(ui, |ui| bar::show(ui, view_state, session, memory, &mut actions));
    egui::Panel::right("panel")
        .default_size(style::PANEL)
        .size_range(240.0..=460.0)
        .show(ui, |ui| panel::show(ui, view_state, session, &mut actions));
    if view_state.times {
        egui::Panel::bottom("times").exact_size(style::GRAPH).show(ui, |ui| graph::show(ui, view_state, session));
    }
    egui::CentralPanel::no_frame().show(ui, |ui| {
        image::show(ui, render, view_state, session, memory);
        if let Some(area) = memory.area {
            // Messages take the place of hints.
            let moving = memory.known.moving || !memory.notices.is_empty();
            overlay::show(ui, area, view_state, session, &Hints { moving, ..memory.known });
        }
    });
    debug_views::show(ui.ctx(), render, view_state, session, memory);
    help::show(ui.ctx(), view_state);
    notices::show(ui.ctx(), memory.area, session, &mut memory.notices);
    actions
}
