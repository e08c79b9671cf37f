//! Jobs: long work on threads, or in slices between frames on platforms without threads.

use crate::here;
use std::future::Future;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::sync::{Arc, Mutex};
use web_time::{Duration, Instant};

/// A running job. Dropping it cancels the work.
pub struct Job<T> {
    /// Name of the work, for people.
    pub title: String,
    started: Instant,
    status: Status,
    receiver: Receiver<Result<T, Died>>,
}

/// Progress of a job, and whether its result is still wanted.
#[derive(Clone, Default)]
pub struct Status {
    step: Arc<Mutex<String>>,
    cancelled: Arc<AtomicBool>,
}

impl Status {
    /// Sets the current step and yields to the frame; false once the job is cancelled.
    pub async fn step(&self, what: &str) -> bool {
        what.clone_into(&mut self.step.lock().expect("only text is moved under the lock"));
        here::yield_to_frame().await;
        !self.is_cancelled()
    }

    /// True once the job is cancelled.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }
}

impl<T: Send + 'static> Job<T> {
    /// Starts `work`; `wake` is called when there is something to show.
    pub fn start<F: Future<Output = T> + 'static>(
        title: impl Into<String>,
        wake: impl Fn() + Send + 'static,
        work: impl FnOnce(Status) -> F + Send + 'static,
    ) -> Job<T> {
        let (send, receiver) = channel();
        let status = Status::default();
        let own = status.clone();
        let done = move |result| {
            // A cancelled job has no receiver.
            let _ = send.send(result);
            wake();
        };
        here::run_job(move || work(own), done);
        Job { title: title.into(), started: Instant::now(), status, receiver }
    }
}

impl<T> Job<T> {
    /// Takes the result.
    pub fn poll(&self) -> Option<Result<T, Died>> {
        match self.receiver.try_recv() {
            Ok(result) => Some(result),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Err(Died("it went away".to_owned()))),
        }
    }

    /// The current step.
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

/// The work ended without a result: a bug of ours, unless the device is lost.
#[derive(Debug, thiserror::Error)]
#[error("the work broke off, which is a bug in antumbra, please report it: {0}")]
pub struct Died(pub String);

/// Length of a slice, where jobs and frames share a thread.
const SLICE: Duration = Duration::from_millis(10);

/// A slice of work between two frames.
pub struct Slice(Instant);

impl Default for Slice {
    fn default() -> Slice {
        Slice(Instant::now())
    }
}

impl Slice {
    /// Runs an iterator to its end, with frames in between; false if `is_wanted`
    /// returns false.
    pub async fn run(&mut self, pieces: &mut impl Iterator<Item = ()>, is_wanted: impl Fn() -> bool) -> bool {
        while pieces.next().is_some() {
            self.breathe().await;
            if !is_wanted() {
                return false;
            }
        }
        true
    }

    /// Yields to the frame once the slice is used up; call it every few milliseconds. On a thread of its own
    /// it does nothing.
    pub async fn breathe(&mut self) {
        if self.0.elapsed() > SLICE {
            here::yield_to_frame().await;
            *self = Slice::default();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ended<T>(job: &Job<T>) -> Result<T, Died> {
        loop {
            if let Some(result) = job.poll() {
                return result;
            }
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
    }

    #[test]
    fn a_result_comes_and_a_panic_is_told() {
        let work = Job::start(
            "seven",
            || (),
            |status| async move {
                status.step("counting").await;
                7
            },
        );
        assert_eq!((ended(&work).unwrap(), work.step().as_str()), (7, "counting"));
        let broken = Job::start(
            "broken",
            || (),
            |_| async move {
                if true {
                    panic!("nothing there")
                }
            },
        );
        assert!(ended(&broken).unwrap_err().to_string().contains("nothing there"));
    }

    #[test]
    fn dropping_a_job_asks_it_to_stop() {
        let (send, receive) = channel();
        let job = Job::start(
            "long",
            || (),
            move |status| async move {
                while status.step("on").await {
                    std::thread::sleep(std::time::Duration::from_millis(1));
                }
                // The test waits for this.
                let _ = send.send(());
            },
        );
        drop(job);
        receive.recv_timeout(std::time::Duration::from_secs(20)).expect("it ends");
    }
}
