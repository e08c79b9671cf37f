//! Progress bars for work that takes over a second, and stopping at Ctrl-C.

use crate::error::CliError;
use indicatif::{ProgressBar, ProgressStyle};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// How long work may take unannounced.
const PATIENCE: Duration = Duration::from_secs(1);

/// Set by Ctrl-C.
static CANCEL: AtomicBool = AtomicBool::new(false);

/// Makes Ctrl-C a request to stop; a second one ends the program on the spot.
pub fn catch_ctrl_c() {
    let handler = || {
        if CANCEL.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    };
    // Without a handler Ctrl-C ends the program as it always does, and files are whole all the same.
    let _ = ctrlc::set_handler(handler);
}

/// True once Ctrl-C was pressed.
pub fn cancelled() -> &'static AtomicBool {
    &CANCEL
}

/// An error once Ctrl-C was pressed: long work asks between its steps.
pub fn check_cancelled() -> Result<(), CliError> {
    if CANCEL.load(Ordering::Relaxed) { Err(CliError::Stopped) } else { Ok(()) }
}

/// A bar on stderr that shows itself after a second, and only on a terminal. It goes away when it is dropped.
pub struct Progress {
    what: String,
    started: Instant,
    bar: OnceLock<ProgressBar>,
}

impl Progress {
    /// Work that starts now.
    pub fn new(what: impl Into<String>) -> Progress {
        Progress { what: what.into(), started: Instant::now(), bar: OnceLock::new() }
    }

    /// The fraction that is done.
    pub fn set(&self, done: f32) {
        if self.started.elapsed() > PATIENCE {
            let bar = self.bar.get_or_init(|| bar(self.what.clone()));
            bar.set_position((done * 1000.0) as u64);
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = self.bar.get() {
            bar.finish_and_clear();
        }
    }
}

fn bar(what: String) -> ProgressBar {
    let bar = ProgressBar::new(1000).with_message(what);
    match ProgressStyle::with_template("{msg} [{bar:40}] {percent:>3} % {eta:>5} left") {
        Ok(style) => bar.with_style(style.progress_chars("=> ")),
        Err(_) => bar,
    }
}
