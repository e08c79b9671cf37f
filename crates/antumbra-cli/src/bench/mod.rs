//! `antumbra bench`: the tables and curves of papers, beside what this machine measures.
//!
//! A suite is one file here and one line in [`SUITES`]: the command line, its help and the files are made from that.

mod adaptive;
mod backprojection;
pub mod kit;
mod pvssm;
mod ssm;
mod subpixel;
mod vsm;

use crate::error::CliError;
use antumbra::technique::settings::nearest;
use kit::{Findings, Lab};

/// Every suite.
pub const SUITES: &[Suite] =
    &[adaptive::SUITE, backprojection::SUITE, pvssm::SUITE, ssm::SUITE, subpixel::SUITE, vsm::SUITE];

/// What is measured of a paper.
#[derive(Debug)]
pub struct Suite {
    /// Name on the command line and of its files.
    pub name: &'static str,
    /// Name for people.
    pub title: &'static str,
    /// The paper: authors, year.
    pub source: &'static str,
    /// One line for the help.
    pub summary: &'static str,
    /// Whether it measures the command line's scenes beside its own.
    pub scenes: bool,
    /// Measures.
    pub run: fn(&Lab) -> Result<Findings, CliError>,
}

/// The suite of this name.
pub fn find(name: &str) -> Result<&'static Suite, String> {
    let names = || SUITES.iter().map(|s| s.name);
    SUITES.iter().find(|s| s.name == name).ok_or_else(|| {
        let hint = nearest(name, names()).map_or(String::new(), |n| format!(" (did you mean `{n}`?)"));
        format!("unknown suite{hint}; the suites are: {}", names().collect::<Vec<_>>().join(", "))
    })
}

/// The suites with a line each, for the help.
pub fn list() -> String {
    let lines = SUITES.iter().map(|s| format!("\n  {:<15} {} [{}]", s.name, s.summary, s.source));
    format!("Suites:{}", lines.collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn suites_are_found_by_name_and_listed() {
        for suite in SUITES {
            assert_eq!(find(suite.name).unwrap().name, suite.name);
            assert!(list().contains(suite.name) && list().contains(suite.source));
            assert!(suite.name.chars().all(|c| c.is_ascii_alphanumeric() || c == '-'), "a file's name");
        }
        assert!(find("adaptve").unwrap_err().contains("did you mean `adaptive`?"));
    }
}
