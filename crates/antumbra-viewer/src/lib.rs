//! The interactive viewer: techniques side by side, or beside the ray-traced truth, in a window.
//!
//! [`run`] opens the window. [`app`] is the program, [`ui`] its controls, [`session`] what goes on behind them: scenes
//! are opened ([`open`]), techniques compiled, the truth traced ([`truth`]) and errors measured ([`metrics`]) in the
//! background ([`job`]). [`view_state`] is what the user has chosen; it outlives the graphics device, which may be lost
//! at any time. [`commands`] drive all of it from outside, for tests.
#![deny(missing_docs)]

pub mod app;
pub mod camera;
pub mod choice;
pub mod commands;
pub mod export;
mod fitter;
pub mod inspector;
pub mod job;
pub mod light;
pub mod loaded_scene;
pub mod metrics;
pub mod open;
mod readback;
pub mod render_targets;
mod save;
pub mod session;
pub mod show;
pub mod times;
pub mod truth;
pub mod ui;
pub mod view_state;

#[cfg(not(target_arch = "wasm32"))]
mod native;
#[cfg(not(target_arch = "wasm32"))]
use native as here;
#[cfg(not(target_arch = "wasm32"))]
pub use native::{Options, WindowError, run};

#[cfg(target_arch = "wasm32")]
mod web;
#[cfg(target_arch = "wasm32")]
use web as here;
#[cfg(target_arch = "wasm32")]
pub use web::open_page;

/// The scene that is shown where none is named.
const FIRST_SCENE: &str = "builtin:fence";
