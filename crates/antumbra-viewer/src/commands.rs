//! Commands from outside, a JSON object each: for tests, and for programs that drive the viewer.
//!
//! They come on stdin, a line each, with `antumbra view --commands`; each is answered by a line on stdout.

use crate::choice::Choice;
use crate::desk::{Compare, Desk, Inside};
use crate::inspect::Part;
use crate::show::Show;
use antumbra::Spec;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// What can be asked for.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Command {
    /// A scene as on the command line.
    Open(String),
    /// A file, as if it were dropped on the window.
    Drop(PathBuf),
    /// What `Open …` does: the file dialog.
    Choose,
    /// The technique of a half, as a SPEC.
    Technique {
        /// 0 left, 1 right.
        half: usize,
        /// As on the command line.
        spec: String,
    },
    /// What stands beside what.
    Compare(Compare),
    /// What is shown.
    Show(Show),
    /// Turning occluders or not.
    Turn(bool),
    /// Where the halves meet, as a part of the width.
    Divider(f32),
    /// Pixels of the picture for one of the screen.
    Resolution(f32),
    /// Looks into the technique of a half; nothing closes the window.
    Inside(Option<usize>),
    /// Which inner picture is looked at, by its name, and which of its channels.
    Inner(String, u32),
    /// Opens or closes the help.
    Help(bool),
    /// Answered once nothing is under way.
    Wait,
    /// What is on the screen, as text.
    State,
    /// The whole window as a PNG file.
    Screenshot(PathBuf),
    /// What `Save` in the menu writes, to this file.
    SaveScene(PathBuf),
    /// Takes all messages off the screen.
    Dismiss,
    /// Loses the device, as drivers do.
    LoseDevice,
    /// Another number of pixels for a point.
    Zoom(f32),
    /// Draws the controls frame after frame and measures the longest time from one to the next, or no longer.
    Watch(bool),
    /// Closes the window.
    Close,
}

/// The answer to a command.
#[derive(Debug, Default, Serialize)]
pub struct Answer {
    /// What went wrong with the command itself.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
    /// For [`Command::State`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub state: Option<State>,
}

/// What is on the screen.
#[derive(Debug, Serialize)]
pub struct State {
    /// The scene's argument.
    pub scene: Option<String>,
    /// SPECs that are drawn, left and right.
    pub drawn: [Option<String>; 2],
    /// Why they are not.
    pub failed: [Option<String>; 2],
    /// Average error of each, where the truth is wanted.
    pub average_error: [Option<f64>; 2],
    /// Messages of errors.
    pub errors: Vec<String>,
    /// GPU errors that nobody expected: there are none unless there is a bug.
    pub faults: Vec<String>,
    /// Frames that were drawn.
    pub frames: u64,
    /// Times that the device was lost.
    pub lost: u32,
    /// Size of the picture, pixels.
    pub picture: Option<[u32; 2]>,
    /// Names of the inner pictures of each technique.
    pub inner: [Vec<&'static str>; 2],
    /// Where the camera is, and what it looks at.
    pub camera: ([f32; 3], [f32; 3]),
    /// Centre and size of the light.
    pub light: ([f32; 3], [f32; 2]),
    /// Places of the light's handles in the window, pixels.
    pub handles: Vec<(String, [f32; 2])>,
    /// The part of the truth that is traced.
    pub truth: Option<f32>,
    /// How far the truth is, as it is said on the screen.
    pub truth_says: Option<String>,
    /// Milliseconds on the GPU of each.
    pub milliseconds: [f64; 2],
    /// The longest time between two frames, milliseconds, since [`Command::Watch`].
    pub longest_frame: Option<f64>,
    /// Techniques that cannot be chosen here, and why.
    pub refused: Vec<(&'static str, String)>,
}

/// Applies a command that only changes what is on the desk; others come back.
pub fn apply(command: Command, desk: &mut Desk) -> Result<Option<Command>, String> {
    match command {
        Command::Technique { half, spec } => {
            let choice = desk.choices.get_mut(half).ok_or("half: 0 is left, 1 is right")?;
            *choice = Choice::of_spec(&spec.parse::<Spec>().map_err(|e| e.to_string())?);
        }
        Command::Compare(compare) => desk.compare = compare,
        Command::Show(show) => desk.show = show,
        Command::Turn(turning) => desk.turning = turning,
        Command::Divider(divider) => desk.divider = divider.clamp(0.02, 0.98),
        Command::Resolution(resolution) => desk.resolution = Some(resolution.clamp(0.05, 2.0)),
        Command::Inside(half) => desk.inside = half.map(|half| Inside { half, ..Inside::default() }),
        Command::Inner(name, channel) => {
            let inside = desk.inside.as_mut().ok_or("nobody looks inside")?;
            (inside.name, inside.part) = (name, Part { channel, ..Part::default() });
        }
        Command::Help(help) => desk.help = help,
        other => return Ok(Some(other)),
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_are_read() {
        let mut desk = Desk::new(&[]);
        for line in [
            r#"{"compare":"truth"}"#,
            r#"{"show":"error"}"#,
            r#"{"technique":{"half":0,"spec":"pcss:map=512"}}"#,
            r#"{"inside":1}"#,
            r#"{"turn":true}"#,
        ] {
            let command = serde_json::from_str(line).unwrap_or_else(|e| panic!("{line}: {e}"));
            assert!(apply(command, &mut desk).unwrap().is_none(), "{line}");
        }
        assert_eq!((desk.compare, desk.show, desk.turning), (Compare::Truth, Show::Error, true));
        assert_eq!(desk.choices[0].text(), "pcss:map=512");
        let wait: Command = serde_json::from_str("\"wait\"").unwrap();
        assert!(matches!(apply(wait, &mut desk), Ok(Some(Command::Wait))));
        let bad = Command::Technique { half: 0, spec: "pcff".to_owned() };
        assert!(apply(bad, &mut desk).unwrap_err().contains("did you mean"));
    }
}
