//! The user's choices. They outlive a lost device.

use crate::choice::Choice;
use crate::inspector::Part;
use crate::show::Show;
use antumbra::Spec;
use antumbra_scene::{Camera, RectLight, Scene};
use std::sync::Arc;

/// Content of the two halves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Compare {
    /// One technique in the whole image.
    One,
    /// Two techniques.
    Two,
    /// A technique and the ray-traced truth.
    Truth,
}

/// An open scene.
#[derive(Clone)]
pub struct OpenScene {
    /// Command-line argument: a path or `builtin:NAME`.
    pub source: String,
    /// Text of the scene file, if it is one.
    pub text: Option<String>,
    /// The scene.
    pub scene: Arc<Scene>,
}

/// Selection in the window of debug views.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DebugSelection {
    /// 0 the left technique, 1 the right.
    pub half: usize,
    /// Name of the debug view; the first if the technique has none of this name.
    pub name: String,
    /// Its layer, level and channel.
    pub part: Part,
}

/// Everything that the user sets.
#[derive(Clone)]
pub struct ViewState {
    /// The open scene.
    pub open: Option<OpenScene>,
    /// Camera.
    pub camera: Camera,
    /// Light.
    pub light: RectLight,
    /// The techniques of the left and of the right half.
    pub choices: [Choice; 2],
    /// Content of the halves.
    pub compare: Compare,
    /// Displayed quantity.
    pub show: Show,
    /// Position of the divider, as a fraction of the width.
    pub divider: f32,
    /// True while occluders turn.
    pub turning: bool,
    /// Their rotation, radians.
    pub angle: f32,
    /// Image pixels per screen pixel; none is 1 on a GPU and 1/2 in software.
    pub resolution: Option<f32>,
    /// Draws every frame, not only after changes.
    pub keeps_drawing: bool,
    /// Whether the handles of the light are drawn.
    pub handles: bool,
    /// The window of debug views, if open.
    pub debug: Option<DebugSelection>,
    /// Whether the graph of times is open.
    pub times: bool,
    /// Whether the help is open.
    pub help: bool,
}

impl ViewState {
    /// The state at the start: one given technique is shown beside the truth; with none,
    /// `hard` and `backprojection` are shown.
    pub fn new(specs: &[Spec]) -> ViewState {
        let named = |name| Choice::named(name).expect("it is in the list");
        let (choices, compare) = match specs {
            [] => ([named("hard"), named("backprojection")], Compare::Two),
            [one] => ([Choice::of_spec(one), named("backprojection")], Compare::Truth),
            [left, right, ..] => ([Choice::of_spec(left), Choice::of_spec(right)], Compare::Two),
        };
        let nowhere = antumbra_scene::builtin::build("square").expect("it is in the list");
        ViewState {
            open: None,
            camera: nowhere.camera,
            light: nowhere.light,
            choices,
            compare,
            show: Show::Image,
            divider: 0.5,
            turning: false,
            angle: 0.0,
            resolution: None,
            keeps_drawing: false,
            handles: true,
            debug: None,
            times: true,
            help: false,
        }
    }

    /// Opens a scene with its own camera and light.
    pub fn take(&mut self, open: OpenScene) {
        (self.camera, self.light) = (open.scene.camera, open.scene.light);
        (self.turning, self.angle) = (false, 0.0);
        self.open = Some(open);
    }

    /// The same, unless this scene is open already, as after a lost device.
    pub fn take_unless_open(&mut self, open: OpenScene) {
        if self.open.as_ref().is_none_or(|o| !Arc::ptr_eq(&o.scene, &open.scene)) {
            self.take(open);
        }
    }

    /// True if camera, light and occluders are the scene's own.
    pub fn is_as_opened(&self) -> bool {
        let Some(open) = &self.open else { return true };
        self.camera == open.scene.camera && self.light == open.scene.light && self.angle == 0.0
    }

    /// Number of techniques.
    pub fn techniques(&self) -> usize {
        if self.compare == Compare::Two { 2 } else { 1 }
    }

    /// True if the debug views of this half are open.
    pub fn shows_debug_views(&self, half: usize) -> bool {
        self.debug.as_ref().is_some_and(|i| i.half.min(self.techniques() - 1) == half)
    }

    /// True if the truth is needed: it is on the right, or errors are shown.
    pub fn wants_truth(&self) -> bool {
        self.compare == Compare::Truth || self.show == Show::Error
    }
}
