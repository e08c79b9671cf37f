//! Progress bars for work of over a second, and requests to stop by Ctrl-C.

use antumbra_bench::Monitor;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::Write;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Time before a bar appears.
const PATIENCE: Duration = Duration::from_secs(1);

/// Set by Ctrl-C.
static CANCEL: AtomicBool = AtomicBool::new(false);

/// Makes Ctrl-C a request to stop; a second one ends the program at once.
pub fn catch_ctrl_c() {
    let handler = || {
        if CANCEL.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    };
    // Without a handler Ctrl-C ends the program as usual, and files are still complete.
    let _ = ctrlc::set_handler(handler);
}

/// Progress on stderr.
pub struct Terminal;

impl Monitor for Terminal {
    /// The bar appears after a second, and only on a terminal.
    fn task(&self, name: &str) -> Box<dyn Fn(f32) + Sync> {
        let progress = Progress { name: name.to_owned(), started: Instant::now(), bar: OnceLock::new() };
        Box::new(move |done| progress.set(done))
    }

    fn log(&self, line: &str) {
        // Unlike `eprintln!` this does not panic where stderr is a pipe whose reader is gone.
        let _ = writeln!(std::io::stderr(), "{line}");
    }

    fn stop(&self) -> &AtomicBool {
        &CANCEL
    }
}

struct Progress {
    name: String,
    started: Instant,
    bar: OnceLock<ProgressBar>,
}

impl Progress {
    fn set(&self, done: f32) {
        if self.started.elapsed() > PATIENCE {
            let bar = self.bar.get_or_init(|| bar(self.name.clone()));
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

fn bar(name: String) -> ProgressBar {
    let bar = ProgressBar::new(1000).with_message(name);
    match ProgressStyle::with_template("{msg} [{bar:40}] {percent:>3} % {eta:>5} left") {
        Ok(style) => bar.with_style(style.progress_chars("=> ")),
        Err(_) => bar,
    }
}
