//! Tools of the suites: experiments, a runner that measures them, and a report with its files.

pub mod columns;
mod experiment;
mod files;
mod page;
mod report;
mod runner;
mod suite;
mod trial;

#[cfg(test)]
pub mod made_up;
#[cfg(test)]
mod tests;

pub use experiment::{Experiment, point_light, with_map};
pub use files::write;
pub use report::{Content, Context, GalleryImage, Ratio, Report, Scatter, Section};
pub use runner::Runner;
pub use suite::Suite;
pub use trial::{Run, Trial, split};
