//! Warnings of an import: each kind once, with the number of places and the first of them.

use std::cell::RefCell;

/// Collects what an import leaves out, and says it when the import ends.
pub(crate) struct Warnings<'a> {
    file: &'a str,
    kinds: RefCell<Vec<Kind>>,
}

struct Kind {
    message: String,
    first: String,
    count: usize,
}

impl<'a> Warnings<'a> {
    pub fn new(file: &'a str) -> Warnings<'a> {
        Warnings { file, kinds: RefCell::default() }
    }

    /// Adds a place. Places with the same message are one kind.
    pub fn add(&self, place: impl Into<String>, message: impl Into<String>) {
        self.add_many(1, place, message);
    }

    /// Adds `count` places at once.
    pub fn add_many(&self, count: usize, first: impl Into<String>, message: impl Into<String>) {
        let (message, mut kinds) = (message.into(), self.kinds.borrow_mut());
        match kinds.iter_mut().find(|k| k.message == message) {
            Some(kind) => kind.count += count,
            None => kinds.push(Kind { message, first: first.into(), count }),
        }
    }
}

impl Drop for Warnings<'_> {
    fn drop(&mut self) {
        let file = self.file;
        for Kind { message, first, count } in self.kinds.get_mut() {
            match count {
                1 => tracing::warn!("{file}, {first}: {message}"),
                _ => tracing::warn!("{file}, {count} places, the first is {first}: {message}"),
            }
        }
    }
}
