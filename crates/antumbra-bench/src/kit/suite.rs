//! List entry of a suite.

use super::report::Report;
use super::runner::Runner;
use crate::Error;

/// The experiments that repeat those of a paper.
#[derive(Debug)]
pub struct Suite {
    /// Name on the command line and of its files.
    pub name: &'static str,
    /// Descriptive name.
    pub title: &'static str,
    /// The paper: authors, year.
    pub source: &'static str,
    /// One line for the help.
    pub summary: &'static str,
    /// Whether it measures the command line's scenes too.
    pub scenes: bool,
    /// Runs the experiments.
    pub run: fn(&Runner) -> Result<Report, Error>,
}
