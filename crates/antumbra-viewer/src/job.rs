//! Long work off the frame: a thread in a window, a task between frames on a web page.

use std::future::Future;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::sync::{Arc, Mutex};
use web_time::Instant;

/// Work under way. Dropping it asks it to stop; what it still finds is thrown away.
pub struct Job<T> {
    /// What is done, for people.
    pub title: String,
    started: Instant,
    status: Status,
    receiver: Receiver<T>,
}

/// What the work says of itself, and whether it shall go on.
#[derive(Clone, Default)]
pub struct Status {
    step: Arc<Mutex<String>>,
    cancelled: Arc<AtomicBool>,
}

impl Status {
    /// Says what comes next; false once nobody waits for it any more.
    pub fn step(&self, what: &str) -> bool {
        what.clone_into(&mut self.step.lock().expect("only text is moved under the lock"));
        !self.is_cancelled()
    }

    /// True once nobody waits for the result.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }
}

impl<T: Send + 'static> Job<T> {
    /// Starts `work`; `wake` is called when there is something to show.
    pub fn start<F: Future<Output = T>>(
        title: impl Into<String>,
        wake: impl Fn() + Send + 'static,
        work: impl FnOnce(Status) -> F + Send + 'static,
    ) -> Job<T>
    where
        F: 'static,
    {
        let (send, receiver) = channel();
        let status = Status::default();
        let own = status.clone();
        run(move || async move {
            let result = work(own).await;
            // Nobody waits for it any more: that is what cancelling means.
            let _ = send.send(result);
            wake();
        });
        Job { title: title.into(), started: Instant::now(), status, receiver }
    }
}

impl<T> Job<T> {
    /// What came out, once.
    pub fn poll(&self) -> Option<Result<T, Died>> {
        match self.receiver.try_recv() {
            Ok(result) => Some(Ok(result)),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Err(Died)),
        }
    }

    /// The step that it is at.
    pub fn step(&self) -> String {
        self.status.step.lock().expect("only text is moved under the lock").clone()
    }

    /// Seconds since the start.
    pub fn seconds(&self) -> f32 {
        self.started.elapsed().as_secs_f32()
    }
}

impl<T> Drop for Job<T> {
    fn drop(&mut self) {
        self.status.cancelled.store(true, Ordering::Relaxed);
    }
}

/// The work ended without a result: a bug of ours, said on stderr or in the console.
#[derive(Debug, thiserror::Error)]
#[error("the work broke off; this is a bug in antumbra, please report it")]
pub struct Died;

#[cfg(not(target_arch = "wasm32"))]
fn run<F: Future<Output = ()>>(work: impl FnOnce() -> F + Send + 'static) {
    std::thread::spawn(|| pollster::block_on(work()));
}

#[cfg(target_arch = "wasm32")]
fn run<F: Future<Output = ()> + 'static>(work: impl FnOnce() -> F + Send + 'static) {
    wasm_bindgen_futures::spawn_local(work());
}
