//! Jobs in slices between the frames: a page has one thread.

use crate::job::Died;
use js_sys::Promise;
use std::future::Future;
use wasm_bindgen_futures::{JsFuture, spawn_local};

/// Does the work once what is running now has ended, and between the frames where it breathes. A panic ends the page.
pub fn run<T, F: Future<Output = T> + 'static>(
    work: impl FnOnce() -> F + Send + 'static,
    done: impl FnOnce(Result<T, Died>) + Send + 'static,
) {
    spawn_local(async move {
        yield_to_frame().await;
        done(Ok(work().await));
    });
}

/// Jobs hold up the frame where they are not cut.
pub const HAS_THREADS: bool = false;

/// Goes on after the browser had its turn: input, a frame, other jobs.
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

/// How many can work at once beside the frame.
pub fn workers() -> usize {
    1
}
