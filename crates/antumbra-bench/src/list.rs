//! The list of suites: one line per suite. The command line, its help and the files follow from it.

use crate::kit::Suite;
use crate::suites::{adaptive, backprojection, pvssm, ssm, subpixel, vsm};
use antumbra::technique::settings::nearest;

/// Every suite.
pub const SUITES: &[Suite] =
    &[adaptive::SUITE, backprojection::SUITE, pvssm::SUITE, ssm::SUITE, subpixel::SUITE, vsm::SUITE];

/// The suite of this name, or a message with the nearest name.
pub fn find(name: &str) -> Result<&'static Suite, String> {
    let names = || SUITES.iter().map(|s| s.name);
    SUITES.iter().find(|s| s.name == name).ok_or_else(|| {
        let hint = nearest(name, names()).map_or(String::new(), |n| format!(" (did you mean `{n}`?)"));
        format!("unknown suite{hint}; the suites are: {}", names().collect::<Vec<_>>().join(", "))
    })
}

/// One line per suite, for the help.
pub fn help() -> String {
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
            assert!(help().contains(suite.name) && help().contains(suite.source));
            assert!(suite.name.chars().all(|c| c.is_ascii_alphanumeric() || c == '-'), "a file's name");
        }
        assert!(find("adaptve").unwrap_err().contains("did you mean `adaptive`?"));
    }
}
