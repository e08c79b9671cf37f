//! Remote control by JSON objects, for tests and for programs that drive the viewer.
//!
//! `antumbra view --commands` reads one command per line from stdin and writes one reply per line to stdout.

use crate::choice::Choice;
use crate::inspector::Part;
use crate::show::Show;
use crate::view_state::{Compare, DebugSelection, ViewState};
use antumbra::Spec;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// A command.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Command {
    /// Opens a scene, named as on the command line.
    Open(String),
    /// Opens a file as if it were dropped on the window.
    Drop(PathBuf),
    /// Shows the file dialog, like the button `Open …`.
    Choose,
    /// Sets the technique of a half.
    Technique {
        /// 0 left, 1 right.
        half: usize,
        /// SPEC, as on the command line.
        spec: String,
    },
    /// Sets the content of the halves.
    Compare(Compare),
    /// Sets the quantity that is shown.
    Show(Show),
    /// Turns occluders, or stops them.
    Turn(bool),
    /// Moves the divider between the halves: a fraction of the width.
    Divider(f32),
    /// Sets the resolution: image pixels per screen pixel, along each axis.
    Resolution(f32),
    /// Opens the debug views of a half, or closes them.
    DebugViews(Option<usize>),
    /// Selects a debug view by name, and its channel.
    DebugView(String, u32),
    /// Opens or closes the help.
    Help(bool),
    /// Waits until no work is pending.
    Wait,
    /// Asks for the [`State`].
    State,
    /// Saves the whole window as a PNG file.
    Screenshot(PathBuf),
    /// Saves the scene file, as the menu `Save` does.
    SaveScene(PathBuf),
    /// Closes all messages.
    Dismiss,
    /// Destroys the device, as after a driver reset.
    LoseDevice,
    /// Sets the zoom of the controls.
    Zoom(f32),
    /// Draws every frame and measures the longest time between two frames, or stops.
    Watch(bool),
    /// Closes the window.
    Close,
}

/// The answer to a command.
#[derive(Debug, Default, Serialize)]
pub struct Reply {
    /// The error of the command itself.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
    /// For [`Command::State`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub state: Option<State>,
}

/// State of the viewer.
#[derive(Debug, Serialize)]
pub struct State {
    /// Argument that opened the scene.
    pub scene: Option<String>,
    /// SPECs of the techniques that are drawn, left and right.
    pub drawn: [Option<String>; 2],
    /// Errors of techniques that are not drawn.
    pub failed: [Option<String>; 2],
    /// Average errors, while the truth is needed.
    pub average_error: [Option<f64>; 2],
    /// Messages of errors.
    pub errors: Vec<String>,
    /// Unexpected GPU errors: each is a bug.
    pub faults: Vec<String>,
    /// Number of drawn frames.
    pub frames: u64,
    /// Number of lost devices.
    pub lost: u32,
    /// Image size in pixels.
    pub image: Option<[u32; 2]>,
    /// Names of each technique's debug views.
    pub debug_views: [Vec<&'static str>; 2],
    /// Eye and target of the camera.
    pub camera: ([f32; 3], [f32; 3]),
    /// Centre and size of the light.
    pub light: ([f32; 3], [f32; 2]),
    /// Positions of the light's handles in the window, pixels.
    pub handles: Vec<(String, [f32; 2])>,
    /// Progress of the truth, 0 to 1.
    pub truth: Option<f32>,
    /// Progress of the truth as text.
    pub truth_says: Option<String>,
    /// GPU time of each technique, milliseconds.
    pub milliseconds: [f64; 2],
    /// Longest time between two frames since [`Command::Watch`], milliseconds.
    pub longest_frame: Option<f64>,
    /// Techniques that this adapter cannot run, with the reason.
    pub refused: Vec<(&'static str, String)>,
}

/// Applies a command that only changes the view state; returns others.
pub fn apply(command: Command, view_state: &mut ViewState) -> Result<Option<Command>, String> {
    match command {
        Command::Technique { half, spec } => {
            let choice = view_state.choices.get_mut(half).ok_or("half: 0 is left, 1 is right")?;
            *choice = Choice::of_spec(&spec.parse::<Spec>().map_err(|e| e.to_string())?);
        }
        Command::Compare(compare) => view_state.compare = compare,
        Command::Show(show) => view_state.show = show,
        Command::Turn(turning) => view_state.turning = turning,
        Command::Divider(divider) => view_state.divider = divider.clamp(0.02, 0.98),
        Command::Resolution(resolution) => view_state.resolution = Some(resolution.clamp(0.05, 2.0)),
        Command::DebugViews(half) => {
            view_state.debug = half.map(|half| DebugSelection { half, ..DebugSelection::default() })
        }
        Command::DebugView(name, channel) => {
            let debug = view_state.debug.as_mut().ok_or("no debug views are open")?;
            (debug.name, debug.part) = (name, Part { channel, ..Part::default() });
        }
        Command::Help(help) => view_state.help = help,
        other => return Ok(Some(other)),
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_are_read() {
        let mut view_state = ViewState::new(&[]);
        for line in [
            r#"{"compare":"truth"}"#,
            r#"{"show":"error"}"#,
            r#"{"technique":{"half":0,"spec":"pcss:map=512"}}"#,
            r#"{"debug_views":1}"#,
            r#"{"turn":true}"#,
        ] {
            let command = serde_json::from_str(line).unwrap_or_else(|e| panic!("{line}: {e}"));
            assert!(apply(command, &mut view_state).unwrap().is_none(), "{line}");
        }
        assert_eq!((view_state.compare, view_state.show, view_state.turning), (Compare::Truth, Show::Error, true));
        assert_eq!(view_state.choices[0].text(), "pcss:map=512");
        let wait: Command = serde_json::from_str("\"wait\"").unwrap();
        assert!(matches!(apply(wait, &mut view_state), Ok(Some(Command::Wait))));
        let bad = Command::Technique { half: 0, spec: "pcff".to_owned() };
        assert!(apply(bad, &mut view_state).unwrap_err().contains("did you mean"));
    }
}
