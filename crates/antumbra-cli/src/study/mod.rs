//! `antumbra study`: what a paper found by asking people, found by a metric of what people see.

mod disk;
mod fit;
mod rho;
mod search;

use crate::bench::kit::Findings;
use crate::cli::StudyArgs;
use crate::error::CliError;
use antumbra::Gpu;

/// A question that can be studied; its name is that of its files.
#[derive(Debug)]
pub struct Study {
    /// Name on the command line.
    pub name: &'static str,
    /// Name for people.
    pub title: &'static str,
    /// The paper: authors, year, place in it.
    pub source: &'static str,
    /// One line for the help.
    pub summary: &'static str,
    /// Finds out.
    pub run: fn(&Gpu, &StudyArgs) -> Result<Findings, CliError>,
}

/// Every study.
pub const STUDIES: &[Study] = &[rho::STUDY];

/// The study of this name.
pub fn find(name: &str) -> Result<&'static Study, String> {
    let names = || STUDIES.iter().map(|s| s.name).collect::<Vec<_>>().join(", ");
    STUDIES.iter().find(|s| s.name == name).ok_or_else(|| format!("unknown study; there are: {}", names()))
}

/// The studies with a line each, for the help.
pub fn list() -> String {
    let lines = STUDIES.iter().map(|s| format!("\n  {:<15} {} [{}]", s.name, s.summary, s.source));
    format!("Studies:{}", lines.collect::<String>())
}
