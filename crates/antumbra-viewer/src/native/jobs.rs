//! Jobs on threads.

use crate::job::Died;
use std::future::Future;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};

/// Name of the threads that work.
const THREAD: &str = "antumbra job";

/// Runs the work on a thread.
pub fn run<T, F: Future<Output = T>>(
    work: impl FnOnce() -> F + Send + 'static,
    done: impl FnOnce(Result<T, Died>) + Send + 'static,
) {
    let work = move || {
        let result = catch_unwind(AssertUnwindSafe(|| pollster::block_on(work())));
        done(result.map_err(|panic| {
            let text = panic.downcast_ref::<String>().cloned();
            Died(text.or(panic.downcast_ref::<&str>().map(|t| (*t).to_owned())).unwrap_or_default())
        }));
    };
    let started = std::thread::Builder::new().name(THREAD.to_owned()).spawn(work);
    // Without a thread the channel closes, and the owner says so.
    drop(started);
}

/// Jobs need no slices.
pub const HAS_THREADS: bool = true;

/// Another thread draws the frame: nothing to yield.
pub async fn yield_to_frame() {}

/// Number of jobs that run in parallel with the frame.
pub fn workers() -> usize {
    std::thread::available_parallelism().map_or(1, |n| n.get().saturating_sub(1).max(1))
}

/// Hides panics of jobs, whose owners report them; others are reported as usual.
pub fn leave_panics_of_jobs_to_their_owners() {
    let usual = take_hook();
    set_hook(Box::new(move |info| {
        if std::thread::current().name() != Some(THREAD) {
            usual(info);
        }
    }));
}
