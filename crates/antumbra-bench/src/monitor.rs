//! Progress display and requests to stop: the seam between measurements and the program.

use crate::error::Error;
use std::sync::atomic::{AtomicBool, Ordering};

/// Displays progress and carries the user's request to stop.
pub trait Monitor: Sync {
    /// Shows a task until the returned function is dropped. The function takes the completed fraction in [0, 1].
    fn task(&self, name: &str) -> Box<dyn Fn(f32) + Sync>;

    /// Shows one line of progress.
    fn log(&self, line: &str);

    /// Set once the work has to stop.
    fn stop(&self) -> &AtomicBool;

    /// Fails with [`Error::Stopped`] once the work has to stop. Long work calls this between its steps.
    fn check(&self) -> Result<(), Error> {
        if self.stop().load(Ordering::Relaxed) { Err(Error::Stopped) } else { Ok(()) }
    }
}

/// A monitor without a display.
#[derive(Debug, Default)]
pub struct Silent {
    /// Set this to stop the work.
    pub stop: AtomicBool,
}

impl Monitor for Silent {
    fn task(&self, _: &str) -> Box<dyn Fn(f32) + Sync> {
        Box::new(|_| ())
    }

    fn log(&self, _: &str) {}

    fn stop(&self) -> &AtomicBool {
        &self.stop
    }
}
