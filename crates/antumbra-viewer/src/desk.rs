//! What the user has chosen. It outlives a device that is lost.

use crate::choice::Choice;
use crate::inspect::Part;
use crate::show::Show;
use antumbra::Spec;
use antumbra_scene::{Camera, RectLight, Scene};
use std::sync::Arc;

/// What is on the two halves of the screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Compare {
    /// One technique on all of it.
    One,
    /// A technique on each.
    Two,
    /// A technique and the ray-traced truth.
    Truth,
}

/// A scene that was opened.
#[derive(Clone)]
pub struct Open {
    /// As on the command line: a path or `builtin:NAME`.
    pub source: String,
    /// The text of a scene file.
    pub text: Option<String>,
    /// What was in it.
    pub scene: Arc<Scene>,
}

/// Which inner picture is looked at.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Inside {
    /// Of the left or of the right technique.
    pub half: usize,
    /// The picture's name; the first where the technique has none of this name.
    pub name: String,
    /// Which part of it.
    pub part: Part,
}

/// All that a person sets.
#[derive(Clone)]
pub struct Desk {
    /// What is open.
    pub open: Option<Open>,
    /// Where it is seen from.
    pub camera: Camera,
    /// What lights it.
    pub light: RectLight,
    /// The techniques of the left and of the right half.
    pub choices: [Choice; 2],
    /// What the halves hold.
    pub compare: Compare,
    /// What is shown of them.
    pub show: Show,
    /// Where they meet, as a part of the width.
    pub divider: f32,
    /// True while occluders turn.
    pub turning: bool,
    /// How far they have turned, radians.
    pub angle: f32,
    /// Pixels of the picture for a pixel of the screen; none is 1 on a GPU and 1/2 in software.
    pub resolution: Option<f32>,
    /// Draws frame after frame, not only when something changes.
    pub keeps_drawing: bool,
    /// Whether the handles of the light are drawn.
    pub handles: bool,
    /// The inner picture, where that window is open.
    pub inside: Option<Inside>,
    /// Whether the graph of times is open.
    pub times: bool,
    /// Whether the help is open.
    pub help: bool,
}

impl Desk {
    /// What one finds when one opens the viewer: with one technique asked for, it stands beside the truth; with none,
    /// the plainest and the default one stand beside each other.
    pub fn new(specs: &[Spec]) -> Desk {
        let named = |name| Choice::named(name).expect("it is in the list");
        let (choices, compare) = match specs {
            [] => ([named("hard"), named("backprojection")], Compare::Two),
            [one] => ([Choice::of_spec(one), named("backprojection")], Compare::Truth),
            [left, right, ..] => ([Choice::of_spec(left), Choice::of_spec(right)], Compare::Two),
        };
        let nowhere = antumbra_scene::builtin::build("square").expect("it is in the list");
        Desk {
            open: None,
            camera: nowhere.camera,
            light: nowhere.light,
            choices,
            compare,
            show: Show::Picture,
            divider: 0.5,
            turning: false,
            angle: 0.0,
            resolution: None,
            keeps_drawing: false,
            handles: true,
            inside: None,
            times: true,
            help: false,
        }
    }

    /// Takes a scene, seen and lit as it asks for.
    pub fn take(&mut self, open: Open) {
        (self.camera, self.light) = (open.scene.camera, open.scene.light);
        (self.turning, self.angle) = (false, 0.0);
        self.open = Some(open);
    }

    /// The same, unless this very scene is open already: its device was lost, and all else stays.
    pub fn take_unless_open(&mut self, open: Open) {
        if self.open.as_ref().is_none_or(|o| !Arc::ptr_eq(&o.scene, &open.scene)) {
            self.take(open);
        }
    }

    /// True if the scene is seen and lit as its file says.
    pub fn is_as_opened(&self) -> bool {
        let Some(open) = &self.open else { return true };
        self.camera == open.scene.camera && self.light == open.scene.light && self.angle == 0.0
    }

    /// Halves that a technique draws.
    pub fn techniques(&self) -> usize {
        if self.compare == Compare::Two { 2 } else { 1 }
    }

    /// True if the window that looks inside is open on this half.
    pub fn shows_debug_views(&self, half: usize) -> bool {
        self.inside.as_ref().is_some_and(|i| i.half.min(self.techniques() - 1) == half)
    }

    /// True if the truth is wanted: it is on the right, or errors are shown.
    pub fn wants_truth(&self) -> bool {
        self.compare == Compare::Truth || self.show == Show::Error
    }
}
