//! Predicted virtual soft shadow maps: the paper's two tables, its figures 8, 10, 11 and 13 [Shen 2011, section 6],
//! then time over triangles and pixels.

mod antialiasing;
mod figures;
mod lights;
mod scale;
mod scaling;
mod stages;

use crate::Error;
use crate::kit::{Experiment, Report, Runner, Suite, Trial, split};
use scale::Scale;

pub const SUITE: Suite = Suite {
    name: "pvssm",
    title: "Predicted virtual soft shadow maps",
    source: "Shen 2011",
    summary: "tables 1 and 2 and figures 8, 10, 11 and 13; --size 1024x1024 takes the paper's sizes of scenes too",
    scenes: false,
    run,
};

fn run(runner: &Runner) -> Result<Report, Error> {
    let scale = Scale::of(runner);
    let slope = figures::tuned_slope(runner, scale)?;
    let (trials, counts) = runner.run_groups(groups(scale, slope)?)?;
    Ok(report(trials, counts, &antialiasing::measure(runner)?))
}

/// Experiments of table 1, of table 2, of figures 8 and 10, and of the curves.
fn groups(scale: Scale, slope: f64) -> Result<[Vec<Experiment>; 4], Error> {
    let figures = figures::experiments(scale, slope)?;
    Ok([stages::experiments(scale)?, lights::experiments(scale)?, figures, scaling::experiments(scale)?])
}

/// The report on the trials, in the order of the experiments.
fn report(trials: Vec<Trial>, counts: [usize; 4], antialiased: &antialiasing::Antialiased) -> Report {
    let [of_stages, of_lights, of_figures, of_scaling] = split(&trials, counts);
    let mut ratios = lights::ratios(of_lights);
    ratios.extend(figures::ratios(of_figures));
    ratios.push(antialiased.ratio());
    let mut sections = vec![stages::section(of_stages), lights::section(of_lights)];
    sections.extend(figures::sections(of_figures));
    sections.push(antialiased.section());
    sections.push(scaling::section(of_scaling));
    let lead = lights::lead(of_lights) + &antialiased.lead();
    Report { lead, sections, ratios, trials }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kit::made_up::{run, trial};

    #[test]
    fn every_part_has_something_to_show() {
        let scale = Scale { size: [64; 2], pixels: 0.004 };
        let made = |experiments: Vec<Experiment>| -> Vec<Trial> {
            let runs = |e: &Experiment| e.specs.iter().map(|s| run(&s.text, 4.0, &[("tiles", 3.0)])).collect();
            experiments.iter().map(|e| trial(&e.name, runs(e))).collect()
        };
        let groups = groups(scale, 2.0).unwrap().map(made);
        let counts = groups.each_ref().map(Vec::len);
        let found = report(groups.into_iter().flatten().collect(), counts, &antialiasing::Antialiased::made_up());
        assert_eq!(found.sections.len(), 6, "tables 1 and 2, figures 8, 10 and 11, curves");
        assert!(found.sections.iter().all(|s| !s.contents.is_empty() && !s.text.is_empty()));
        assert!(found.ratios.iter().all(|ratio| ratio.paper.is_some() && ratio.ours.is_finite()));
        assert!(found.lead.contains("paper"), "{}", found.lead);
    }
}
