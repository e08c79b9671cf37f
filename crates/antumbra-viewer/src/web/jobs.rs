//! Jobs in slices between the frames: a page has one thread.

use crate::job::Died;
use js_sys::Promise;
use std::future::Future;
use wasm_bindgen_futures::{JsFuture, spawn_local};

/// Runs the work after the current task, in slices between frames. A panic ends the page.
pub fn run<T, F: Future<Output = T> + 'static>(
    work: impl FnOnce() -> F + Send + 'static,
    done: impl FnOnce(Result<T, Died>) + Send + 'static,
) {
    spawn_local(async move {
        yield_to_frame().await;
        done(Ok(work().await));
    });
}

/// Jobs without slices block the frame.
pub const HAS_THREADS: bool = false;

/// Yields to the browser: input, a frame, other jobs.
pub async fn yield_to_frame() {
    let turn = Promise::new(&mut |resolve, _| {
        if let Some(window) = web_sys::window() {
            // A window always has timers.
            let _ = window.set_timeout_with_callback(&resolve);
        }
    });
    // A timer does not fail.
    let _ = JsFuture::from(turn).await;
}

/// Number of jobs that run in parallel with the frame.
pub fn workers() -> usize {
    1
}
