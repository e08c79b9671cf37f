//! Predicted virtual soft shadow maps: the paper's two tables, its figures 8, 10, 11 and 13 [Shen 2011, section 6], then
//! time over triangles and pixels.

mod antialiasing;
mod figures;
mod lights;
mod scaling;
mod stages;

use super::Suite;
use super::kit::{Findings, Group, Lab, Order, Run, Shown, Table, Trial, specs};
use crate::error::CliError;
use crate::report::text;
use antumbra::Spec;
use antumbra_scene::{Scene, builtin};

pub const SUITE: Suite = Suite {
    name: "pvssm",
    title: "Predicted virtual soft shadow maps",
    source: "Shen 2011",
    summary: "tables 1 and 2 and figures 8, 10, 11 and 13; --size 1024x1024 takes the paper's sizes of scenes too",
    scenes: false,
    run,
};

/// Pictures that a software adapter draws in reasonable time; the paper's are 1024 a side.
const SIZE: [u32; 2] = [384, 384];
const PAPER_SIDE: f64 = 1024.0;

/// One trial to be, with all that it needs.
pub struct Job {
    pub name: String,
    pub scene: Scene,
    pub size: [u32; 2],
    pub specs: Vec<Spec>,
    /// Whether pictures are shown.
    pub pictures: bool,
}

/// How large everything is: a smaller picture than the paper's sees scenes of as many triangles a pixel, and maps of as
/// many texels, as powers of two.
#[derive(Clone, Copy)]
pub struct Scale {
    pub size: [u32; 2],
    /// Pixels over the paper's; no more than 1.
    pixels: f64,
}

impl Scale {
    fn of(lab: &Lab) -> Scale {
        let size = lab.size(SIZE);
        let pixels = f64::from(size[0]) * f64::from(size[1]) / (PAPER_SIDE * PAPER_SIDE);
        Scale { size, pixels: pixels.min(1.0) }
    }

    /// A map of the paper's.
    pub fn map(&self, paper: u32) -> u32 {
        ((f64::from(paper) * self.pixels.sqrt()).round() as u32).next_power_of_two()
    }

    /// A forest of about as many triangles as the paper's scene, for each of its pixels.
    pub fn forest(&self, triangles: f64) -> Result<Scene, CliError> {
        let trees = (triangles * self.pixels / 9194.0).round().clamp(1.0, 540.0);
        Ok(builtin::build(&format!("forest:trees={trees}"))?)
    }

    /// The same of pipes, of which there are no fewer than 300 000.
    pub fn pipes(&self, triangles: f64) -> Result<Scene, CliError> {
        let count = (triangles * self.pixels).round().clamp(300_000.0, 10_000_000.0);
        Ok(builtin::build(&format!("pipes:triangles={count}"))?)
    }
}

fn run(lab: &Lab) -> Result<Findings, CliError> {
    let scale = Scale::of(lab);
    let groups = [stages::jobs(scale)?, lights::jobs(scale)?, figures::jobs(lab, scale)?, scaling::jobs(scale)?];
    let counts = groups.each_ref().map(Vec::len);
    let jobs: Vec<Job> = groups.into_iter().flatten().collect();
    let (truth, frames) = (&lab.args.truth, lab.args.gpu.frames);
    let orders: Vec<Order> = jobs
        .iter()
        .map(|Job { name, scene, size, specs, pictures, .. }| Order {
            name,
            scene,
            size: *size,
            specs,
            frames,
            truth,
            pictures: *pictures,
        })
        .collect();
    let trials = lab.trials(&orders)?;
    let smoothed = antialiasing::measure(lab)?;
    Ok(findings(trials, counts, &smoothed))
}

/// Puts into words, tables, pictures and curves what was measured, in the order of the jobs.
fn findings(trials: Vec<Trial>, counts: [usize; 4], smoothed: &antialiasing::Smoothed) -> Findings {
    let mut starts = [0; 5];
    for (i, count) in counts.iter().enumerate() {
        starts[i + 1] = (starts[i] + count).min(trials.len());
    }
    let of = |group: usize| &trials[starts[group]..starts[group + 1]];
    let mut ratios = lights::ratios(of(1));
    ratios.extend(figures::ratios(of(2)));
    ratios.extend(smoothed.ratios());
    let mut parts = vec![stages::part(of(0)), lights::part(of(1), starts[1])];
    parts.extend(figures::parts(of(2), starts[2]));
    parts.push(smoothed.part());
    parts.push(scaling::part(of(3)));
    let lead = lights::lead(of(1)) + &smoothed.lead();
    Findings { lead, parts, ratios, trials }
}

/// The SPECs of a list.
fn read(texts: Vec<String>) -> Result<Vec<Spec>, CliError> {
    specs(texts)
}

/// A row a run of a trial: what it drew, how well, and what it took.
fn cost_table(trial: &Trial) -> Shown {
    let row = |run: &Run| {
        vec![
            run.spec.clone(),
            text::figure(run.figures.average_error),
            text::figure(run.figures.flip),
            run.ms(),
            text::megabytes(run.cost.total_bytes),
            run.count("tiles"),
            run.work.get("megatexels").map_or_else(|| "–".to_owned(), |n| format!("{n:.1}")),
        ]
    };
    let heads = vec![
        ("technique", "Name and settings"),
        ("error", "Average error over shadow and penumbra"),
        ("FLIP", "Mean FLIP error"),
        ("ms", "Milliseconds of the shadow"),
        ("MB", "GPU memory that it owns"),
        ("tiles", "Tiles that were drawn"),
        ("Mtexels", "Texels of all tiles, in 2²⁰"),
    ];
    let groups = vec![Group { title: trial.heading(), rows: trial.runs.iter().map(row).collect() }];
    Shown::Table(Table { heads, groups })
}

#[cfg(test)]
mod tests {
    use super::super::kit::tests::{run, trial};
    use super::*;

    #[test]
    fn smaller_pictures_see_smaller_scenes_and_maps() {
        let paper = Scale { size: [1024; 2], pixels: 1.0 };
        let small = Scale { size: [256; 2], pixels: 1.0 / 16.0 };
        assert_eq!([paper.map(4096), small.map(4096)], [4096, 1024]);
        let trees = |scale: Scale| scale.forest(782_000.0).unwrap().name;
        assert_eq!([trees(paper), trees(small)].map(|n| n.contains("trees=85")), [true, false]);
    }

    #[test]
    fn every_part_has_something_to_show() {
        let scale = Scale { size: [64; 2], pixels: 0.004 };
        let made = |jobs: Vec<Job>| -> Vec<Trial> {
            let runs = |job: &Job| job.specs.iter().map(|s| run(&s.text, 4.0, &[("tiles", 3.0)])).collect();
            jobs.iter().map(|job| trial(&job.name, runs(job))).collect()
        };
        let groups = [stages::jobs(scale), lights::jobs(scale), figures::jobs_at(scale, 2.0), scaling::jobs(scale)];
        let groups = groups.map(|jobs| made(jobs.unwrap()));
        let counts = groups.each_ref().map(Vec::len);
        let found = findings(groups.into_iter().flatten().collect(), counts, &antialiasing::Smoothed::made_up());
        assert_eq!(found.parts.len(), 6, "tables 1 and 2, figures 8, 10 and 11, curves");
        assert!(found.parts.iter().all(|part| !part.shown.is_empty() && !part.text.is_empty()));
        assert!(found.ratios.iter().all(|ratio| ratio.paper.is_some() && ratio.ours.is_finite()));
        assert!(found.lead.contains("paper"), "{}", found.lead);
    }
}
