//! Long loops that can be broken off: between their parts they wait for a `pause`, in which a program with one thread does
//! what else it has to do.

use std::future::Future;
use std::pin::pin;
use std::task::{Context, Poll, Waker};

/// What a loop over triangles does at a stretch: some milliseconds.
pub const RUN: usize = 1 << 14;

/// Work whose pauses never wait, done at once.
///
/// # Panics
/// If it does wait: nothing would ever wake it.
pub fn at_once<T>(work: impl Future<Output = T>) -> T {
    match pin!(work).poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(done) => done,
        Poll::Pending => panic!("a pause waits where nothing can wake it"),
    }
}
