//! The report of `antumbra compare`: a self-contained page, the results as JSON and CSV, and the images.

mod cards;
mod columns;
mod files;
mod html;
mod images;
mod measure;
mod model;

#[cfg(test)]
mod tests;

pub use columns::terminal;
pub use files::write;
pub use measure::compare;
pub use model::{Comparison, Entry, Reference};
