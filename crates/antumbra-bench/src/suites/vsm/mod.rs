//! Variance shadow maps and their family: the paper's two tables of frames per second and its four figures
//! [Donnelly, Lauritzen 2006, section 5], then error and cost over their parameters.

mod errors;
mod family;
mod figures;
mod tables;

use crate::Error;
use crate::kit::{Report, Runner, Suite, Trial, split};

pub const SUITE: Suite = Suite {
    name: "vsm",
    title: "Variance shadow maps",
    source: "Donnelly, Lauritzen 2006",
    summary: "filtered moments beside filtered comparisons, and the family over light, map and filter",
    scenes: false,
    run,
};

fn run(runner: &Runner) -> Result<Report, Error> {
    let groups = [tables::experiments(runner)?, figures::experiments(runner)?, family::experiments(runner)?];
    let (trials, counts) = runner.run_groups(groups)?;
    Ok(report(trials, counts))
}

/// The report on the trials, in the order of the experiments.
fn report(trials: Vec<Trial>, counts: [usize; 3]) -> Report {
    let [of_tables, of_figures, of_family] = split(&trials, counts);
    let mut sections = tables::sections(of_tables);
    sections.extend(figures::sections(of_figures));
    sections.extend(family::sections(of_family));
    let (lead, ratios) = (tables::lead(of_tables), of_tables.iter().flat_map(tables::ratios).collect());
    Report { lead, sections, ratios, trials }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kit::Content;
    use crate::kit::made_up::{run, trial};

    #[test]
    fn every_table_has_the_papers_rows_beside_ours() {
        let named = |names: Vec<(String, Vec<String>)>| {
            names.into_iter().map(|(n, s)| trial(&n, s.iter().map(|s| run(s, 4.0, &[])).collect())).collect::<Vec<_>>()
        };
        let trials = named(tables::names());
        let sections = tables::sections(&trials);
        assert_eq!(sections.len(), 2);
        for section in &sections {
            let [Content::Table(table), Content::Table(passes)] = &section.contents[..] else { panic!("two tables") };
            assert_eq!(table.groups.len(), 4);
            assert!(table.groups.iter().all(|g| g.rows.len() == 6));
            assert!(table.rows().all(|row| row.len() == table.headings.len()));
            assert!(passes.rows().all(|row| row.len() == passes.headings.len()));
        }
        assert!(tables::lead(&trials).contains("paper: 7.0"), "{}", tables::lead(&trials));
    }
}
