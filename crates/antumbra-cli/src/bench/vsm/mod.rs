//! Variance shadow maps and their family: the paper's two tables of frames per second and its four figures
//! [Donnelly, Lauritzen 2006, section 5], then error and cost over what they depend on.

mod family;
mod figures;
mod tables;

use super::Suite;
use super::kit::{Findings, Lab, Order, Trial, specs};
use crate::cli::TruthArgs;
use crate::error::CliError;
use antumbra::Spec;
use antumbra_scene::Scene;

pub const SUITE: Suite = Suite {
    name: "vsm",
    title: "Variance shadow maps",
    source: "Donnelly, Lauritzen 2006",
    summary: "filtered moments beside filtered comparisons, and the family over light, map and filter",
    scenes: false,
    run,
};

/// One trial to be, with all that it needs.
pub struct Job {
    pub name: String,
    pub scene: Scene,
    pub size: [u32; 2],
    pub specs: Vec<Spec>,
    /// Whether the light is a point, of which one ray a pixel sample tells all.
    pub hard: bool,
    /// Whether pictures are shown.
    pub pictures: bool,
    /// Frames that count; 0 where only the error matters.
    pub frames: u32,
}

impl Job {
    fn order<'a>(&'a self, truth: &'a TruthArgs) -> Order<'a> {
        let Job { name, scene, size, specs, pictures, frames, .. } = self;
        Order { name, scene, size: *size, specs, frames: *frames, truth, pictures: *pictures }
    }
}

fn run(lab: &Lab) -> Result<Findings, CliError> {
    let parts = [tables::jobs(lab)?, figures::jobs(lab)?, family::jobs(lab)?];
    let counts = [parts[0].len(), parts[1].len()];
    let jobs: Vec<Job> = parts.into_iter().flatten().collect();
    let truth = &lab.args.truth;
    let through_pixel = TruthArgs { light_samples: truth.pixel_samples, ..truth.clone() };
    let trials: Vec<Trial> = lab
        .trials(&jobs.iter().map(|job| job.order(if job.hard { &through_pixel } else { truth })).collect::<Vec<_>>())?;
    Ok(findings(trials, counts))
}

/// Puts into words, tables, pictures and curves what was measured, in the order of the jobs.
fn findings(trials: Vec<Trial>, [tables, figures]: [usize; 2]) -> Findings {
    let (of_tables, rest) = trials.split_at(tables.min(trials.len()));
    let (of_figures, of_family) = rest.split_at(figures.min(rest.len()));
    let mut parts = tables::parts(of_tables);
    parts.extend(figures::parts(of_figures, tables));
    parts.extend(family::parts(of_family));
    let (lead, ratios) = (tables::lead(of_tables), of_tables.iter().flat_map(tables::ratios).collect());
    Findings { lead, parts, ratios, trials }
}

/// The SPECs of a list.
fn read(texts: &[&str]) -> Result<Vec<Spec>, CliError> {
    specs(texts.iter().map(|text| (*text).to_owned()).collect())
}

/// The scene with its light shrunk to a point.
fn with_point_light(mut scene: Scene) -> Scene {
    scene.light.size = [0.0; 2].into();
    scene
}

#[cfg(test)]
mod tests {
    use super::super::kit::Shown;
    use super::super::kit::tests::{run, trial};
    use super::*;

    #[test]
    fn every_table_has_the_papers_rows_beside_ours() {
        let named = |names: Vec<(String, Vec<String>)>| {
            names.into_iter().map(|(n, s)| trial(&n, s.iter().map(|s| run(s, 4.0, &[])).collect())).collect::<Vec<_>>()
        };
        let trials = named(tables::names());
        let parts = tables::parts(&trials);
        assert_eq!(parts.len(), 2);
        for part in &parts {
            let [Shown::Table(table), Shown::Table(passes)] = &part.shown[..] else { panic!("two tables") };
            assert_eq!(table.groups.len(), 4);
            assert!(table.groups.iter().all(|g| g.rows.len() == 6));
            assert!(table.groups.iter().flat_map(|g| &g.rows).all(|row| row.len() == table.heads.len()));
            assert!(passes.groups.iter().flat_map(|g| &g.rows).all(|row| row.len() == passes.heads.len()));
        }
        assert!(tables::lead(&trials).contains("paper: 7.0"), "{}", tables::lead(&trials));
    }
}
