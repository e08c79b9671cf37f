//! What suites are made with: a laboratory that measures, findings to fill, and the files that are written of them.

mod files;
mod findings;
mod lab;
mod markdown;
mod page;

#[cfg(test)]
pub mod tests;

pub use files::write;
pub use findings::{Context, Findings, Group, Part, Ratio, Scatter, Shown, Table};
pub use lab::{Lab, Order, Run, Trial, specs, with_map};
pub use markdown::terminal;
