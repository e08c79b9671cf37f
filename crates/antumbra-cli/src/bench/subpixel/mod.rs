//! Sub-pixel antialiased shadow maps: table 1, figures 8, 10 and 11 [Pan 2009], and rays at the same samples.

mod rays;
mod samples;
mod table;

use super::Suite;
use super::kit::{Findings, Lab, Order, Trial, specs};
use crate::cli::TruthArgs;
use crate::error::CliError;
use antumbra::Spec;
use antumbra_scene::Scene;

pub const SUITE: Suite = Suite {
    name: "subpixel",
    title: "Sub-pixel antialiased shadow maps",
    source: "Pan 2009",
    summary: "silhouettes, tests and milliseconds of seven scenes, cost over samples, rays at the same samples",
    scenes: true,
    run,
};

/// The paper's picture.
const SIZE: [u32; 2] = [800, 600];

/// One trial to be.
struct Job {
    name: String,
    scene: Scene,
    size: [u32; 2],
    specs: Vec<Spec>,
    frames: u32,
}

fn run(lab: &Lab) -> Result<Findings, CliError> {
    let (tables, curves) = (table::jobs(lab)?, samples::jobs(lab)?);
    let split = tables.len();
    let jobs: Vec<Job> = tables.into_iter().chain(curves).collect();
    // The light is a point: a ray tells all that a place of the pixel sees.
    let truth = TruthArgs { light_samples: lab.args.truth.pixel_samples, ..lab.args.truth.clone() };
    let orders: Vec<Order> = jobs
        .iter()
        .map(|j| Order {
            name: &j.name,
            scene: &j.scene,
            size: j.size,
            specs: &j.specs,
            frames: j.frames,
            truth: &truth,
            pictures: false,
        })
        .collect();
    let trials = lab.trials(&orders)?;
    let compared = rays::compare(lab)?;
    Ok(findings(trials, split, compared))
}

/// Puts into words, tables, pictures and curves what was measured.
fn findings(trials: Vec<Trial>, split: usize, compared: rays::Compared) -> Findings {
    let (of_table, of_curves) = trials.split_at(split.min(trials.len()));
    let mut parts = vec![table::part(of_table), table::costs(of_table, of_curves), samples::part(of_curves)];
    let lead = format!("{} {}", table::lead(of_table, of_curves), compared.lead());
    parts.extend(compared.parts());
    let ratios = table::ratios(of_table, of_curves);
    Findings { lead, parts, ratios, trials }
}

/// The SPECs of a list.
fn read(texts: &[String]) -> Result<Vec<Spec>, CliError> {
    specs(texts.to_vec())
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
    fn every_scene_has_the_papers_row_beside_ours() {
        let named = |(name, specs): (String, Vec<String>)| {
            trial(&name, specs.iter().map(|s| run(s, 4.0, &[("silhouette texels", 9.0)])).collect())
        };
        let trials: Vec<Trial> = table::names().into_iter().chain([samples::name()]).map(named).collect();
        let (tables, curves) = trials.split_at(trials.len() - 1);
        let part = table::part(tables);
        let [Shown::Pictures(_), Shown::Table(shown)] = &part.shown[..] else { panic!("pictures and a table") };
        assert_eq!(shown.groups.len(), 7);
        assert!(shown.groups.iter().all(|g| g.rows.len() == 2));
        assert!(shown.groups.iter().flat_map(|g| &g.rows).all(|row| row.len() == shown.heads.len()));
        let ratios = table::ratios(tables, curves);
        assert_eq!(ratios.iter().filter(|r| r.ours == 1.0).count(), ratios.len(), "all took as long");
        assert!(ratios.len() >= 15, "{}", ratios.len());
        let Shown::Lines(lines) = &samples::part(curves).shown[0] else { panic!("a plot") };
        assert!(lines.curves.iter().all(|c| c.points.len() >= 5));
    }
}
