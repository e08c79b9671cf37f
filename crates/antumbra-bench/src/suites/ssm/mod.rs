//! Soft shadow maps: the paper's curves of error and cost, the gain of gathering on levels, and the paper's way over
//! the CPU.

mod cost;
mod error;
mod levels;
mod readback;
mod scenes;
mod stage;
mod targets;
mod truth;

use crate::Error;
use crate::kit::{Content, Experiment, Report, Runner, Section, Suite, Trial};
use scenes::{Occluder, Placement};

pub const SUITE: Suite = Suite {
    name: "ssm",
    title: "Soft shadow maps",
    source: "Atty 2006",
    summary: "errors and costs of figures 14 to 25; --scene takes scanned meshes",
    scenes: true,
    run,
};

const SIZE: [u32; 2] = [256, 256];
/// The paper's setting, our default, and competitors.
const PICTURED: [&str; 5] =
    ["ssm:map=128,hierarchy=false,passes=1", "ssm:map=128,hierarchy=false", "ssm", "pcss", "backprojection"];

fn run(runner: &Runner) -> Result<Report, Error> {
    let occluders = occluders(runner)?;
    let usual = |o: &Occluder| Experiment::new(&o.name, o.scene(Placement::default()), runner.size(SIZE), PICTURED);
    let experiments = occluders.iter().map(usual).collect::<Result<Vec<_>, _>>()?;
    let (curves, at_paper) = error::measure(runner, &occluders)?;
    // The costs are those of the largest mesh.
    let largest = experiments.iter().zip(&occluders).max_by_key(|(e, _)| e.scene.triangle_count());
    let (_, largest) = largest.expect("the square at least");
    let half = error::half_precision(runner, largest)?;
    let mut measured = cost::Measured::default();
    let costs = cost::measure(runner, largest, &mut measured)?;
    let trials = runner.run_all(&experiments)?;
    let (targets, lead) = targets::section(&at_paper, &costs);
    let mut sections = vec![targets, images(&trials)];
    sections.extend(curves);
    sections.push(half);
    sections.extend(measured.sections);
    Ok(Report { lead, sections, ratios: measured.ratios, trials })
}

/// The square and the command line's scenes; without those, balls in place of scanned meshes.
fn occluders(runner: &Runner) -> Result<Vec<Occluder>, Error> {
    let given = runner.scenes.iter().map(|scene| Occluder::of_scene(&short(&scene.name), scene));
    let mut all: Vec<Occluder> = std::iter::once(Occluder::square()).chain(given).collect();
    if all.len() == 1 {
        all.push(Occluder::of_builtin("balls", "spheres:segments=48")?);
    }
    Ok(all)
}

/// A file's name without its folder and ending.
fn short(name: &str) -> String {
    let file = name.rsplit(['/', '\\']).next().unwrap_or(name);
    file.rsplit_once('.').map_or(file, |(stem, _)| stem).to_owned()
}

fn images(trials: &[Trial]) -> Section {
    Section::new(
        "The scenes",
        "The occluders under a light of 0.1 at a height of 0.75, shaded with the reference. The CSV has the errors of the \
         technique, over the occluders too, which take no shadow.",
        vec![Content::references(trials)],
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::FRAC_1_SQRT_2;

    #[test]
    fn names_are_those_of_files() {
        assert_eq!(["models/horse.ply", "builtin:fence", "a.b.obj"].map(short), ["horse", "builtin:fence", "a.b"]);
    }

    #[test]
    fn occluders_have_the_paper_s_size_and_place() {
        for occluder in [Occluder::square(), Occluder::of_builtin("balls", "spheres:segments=8").unwrap()] {
            let scene = occluder.scene(Placement { offset: 0.1, bottom: Some(0.25), ..Placement::default() });
            let bounds = scene.bounds_of(|i| !i.receiver_only);
            assert!((bounds.size().max_element() - 0.2).abs() < 1e-5, "{}: {:?}", occluder.name, bounds);
            assert!((bounds.min.y - 0.25).abs() < 1e-5 && (bounds.center().x - 0.1).abs() < 1e-5, "{bounds:?}");
        }
        let copies = Occluder::square().copies(4, 0.1);
        let bounds = copies.bounds_of(|i| !i.receiver_only);
        assert!((bounds.size().length() * FRAC_1_SQRT_2 - 0.42).abs() < 1e-4, "{bounds:?}");
    }
}
