//! User actions on a page: touch, files, downloads, and external events.

mod files;
mod goes_on;
mod limits;
mod long_work;
mod touch;

use crate::Outcome;
use crate::page::Page;
use serde_json::Value;

/// A check returns its observation, or the error.
pub type Check = fn(&mut Page) -> Outcome<String>;

/// All checks by name; each opens the page again.
pub const CHECKS: [(&str, Check); 11] = [
    ("touch: one finger turns the scene", touch::one_finger_turns),
    ("touch: two fingers zoom", touch::two_fingers_zoom),
    ("files: a dropped model opens, a broken one says so", files::dropped),
    ("files: a chosen model opens", files::chosen),
    ("files: a screenshot is downloaded", files::screenshot),
    ("files: a scene file is downloaded", files::scene_file),
    ("goes on: after the device was lost", goes_on::after_a_loss),
    ("goes on: resized to nothing and back", goes_on::resized_to_nothing),
    ("goes on: on a screen of another scale", goes_on::another_scale),
    ("limits: what cannot run is said beforehand", limits::refused),
    ("long work: two million triangles", long_work::pipes),
];

/// A small scene that is quick to draw.
const QUERY: &str = "?scene=builtin:square&technique=hard:map=256&compare=one&resolution=0.25";

/// Three numbers.
fn vector(value: &Value) -> Outcome<[f64; 3]> {
    let numbers: Option<Vec<f64>> = value.as_array().map(|v| v.iter().filter_map(Value::as_f64).collect());
    numbers.and_then(|n| n.try_into().ok()).ok_or_else(|| format!("{value} is no vector"))
}

fn difference(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| a[i] - b[i])
}

fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Eye and target of the camera.
fn camera(state: &Value) -> Outcome<[[f64; 3]; 2]> {
    Ok([vector(&state["camera"][0])?, vector(&state["camera"][1])?])
}
