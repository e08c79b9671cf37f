//! Sub-pixel antialiased shadow maps: table 1, figures 8, 10 and 11 [Pan 2009], and rays at the same samples.

mod rays;
mod samples;
mod table;

use crate::Error;
use crate::kit::{Report, Runner, Suite, Trial, split};

pub const SUITE: Suite = Suite {
    name: "subpixel",
    title: "Sub-pixel antialiased shadow maps",
    source: "Pan 2009",
    summary: "silhouettes, tests and milliseconds of seven scenes, cost over samples, rays at the same samples",
    scenes: true,
    run,
};

fn run(runner: &Runner) -> Result<Report, Error> {
    let (trials, counts) = runner.run_groups([table::experiments(runner)?, samples::experiments(runner)?])?;
    Ok(report(trials, counts, rays::compare(runner)?))
}

fn report(trials: Vec<Trial>, counts: [usize; 2], compared: rays::Compared) -> Report {
    let [of_table, of_curves] = split(&trials, counts);
    let mut sections = vec![table::section(of_table), table::costs(of_table, of_curves), samples::section(of_curves)];
    let lead = format!("{} {}", table::lead(of_table, of_curves), compared.lead());
    sections.extend(compared.sections());
    let ratios = table::ratios(of_table, of_curves);
    Report { lead, sections, ratios, trials }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kit::Content;
    use crate::kit::made_up::{run, trial};

    #[test]
    fn every_scene_has_the_papers_row_beside_ours() {
        let named = |(name, specs): (String, Vec<String>)| {
            trial(&name, specs.iter().map(|s| run(s, 4.0, &[("silhouette texels", 9.0)])).collect())
        };
        let trials: Vec<Trial> = table::names().into_iter().chain([samples::name()]).map(named).collect();
        let (tables, curves) = trials.split_at(trials.len() - 1);
        let section = table::section(tables);
        let [Content::Gallery(_), Content::Table(shown)] = &section.contents[..] else {
            panic!("pictures and a table")
        };
        assert_eq!(shown.groups.len(), 7);
        assert!(shown.groups.iter().all(|g| g.rows.len() == 2));
        assert!(shown.rows().all(|row| row.len() == shown.headings.len()));
        let ratios = table::ratios(tables, curves);
        assert_eq!(ratios.iter().filter(|r| r.ours == 1.0).count(), ratios.len(), "all took as long");
        assert!(ratios.len() >= 15, "{}", ratios.len());
        let Content::Lines(lines) = &samples::section(curves).contents[0] else { panic!("a plot") };
        assert!(lines.curves.iter().all(|c| c.points.len() >= 5));
    }
}
