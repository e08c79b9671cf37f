//! Soft shadow maps: the paper's curves of error and cost, what gathering on levels gains, and the paper's way over the
//! CPU.

mod cost;
mod error;
mod readback;
mod scenes;
mod stage;
mod targets;
mod truth;

use super::Suite;
use super::kit::{self, Findings, Lab, Order, Part, Shown, Trial};
use crate::error::CliError;
use scenes::{Occluder, Place};

pub const SUITE: Suite = Suite {
    name: "ssm",
    title: "Soft shadow maps",
    source: "Atty 2006",
    summary: "errors and costs of figures 14 to 25; --scene takes scanned meshes",
    scenes: true,
    run,
};

const SIZE: [u32; 2] = [256, 256];
/// What is drawn of each occluder: the paper's setting, ours, and what competes.
const PICTURED: [&str; 5] =
    ["ssm:map=128,hierarchy=false,passes=1", "ssm:map=128,hierarchy=false", "ssm", "pcss", "backprojection"];

fn run(lab: &Lab) -> Result<Findings, CliError> {
    let specs = kit::specs(PICTURED.map(str::to_owned).to_vec())?;
    let occluders = occluders(lab);
    let (curves, at_paper) = error::measure(lab, &occluders)?;
    // Costs are those of the largest mesh.
    let largest = occluders.iter().max_by_key(|o| o.scene(Place::default()).triangle_count());
    let largest = largest.expect("the square at least");
    let mut measured = cost::Measured::default();
    let half = error::half_precision(lab, largest)?;
    let costs = cost::measure(lab, largest, &mut measured)?;
    let scenes: Vec<_> = occluders.iter().map(|o| (o.name.clone(), o.scene(Place::default()))).collect();
    let (size, frames, truth) = (lab.size(SIZE), lab.args.gpu.frames, &lab.args.truth);
    let orders: Vec<Order> = scenes
        .iter()
        .map(|(name, scene)| Order { name, scene, size, specs: &specs, frames, truth, pictures: false })
        .collect();
    let trials = lab.trials(&orders)?;
    let (targets, lead) = targets::part(&at_paper, &costs);
    let mut parts = vec![targets, pictures(&trials)];
    parts.extend(curves);
    parts.push(half);
    parts.extend(measured.parts);
    Ok(Findings { lead, parts, ratios: measured.ratios, trials })
}

/// The square, and what the command line gives; without that, balls in the place of scanned meshes.
fn occluders(lab: &Lab) -> Vec<Occluder> {
    let given = lab.scenes.iter().map(|scene| Occluder::of_scene(&short(&scene.name), scene));
    let mut all: Vec<Occluder> = std::iter::once(Occluder::square()).chain(given).collect();
    if all.len() == 1 {
        all.push(Occluder::of_builtin("balls", "spheres:segments=48"));
    }
    all
}

/// A file's name without its folder and ending.
fn short(name: &str) -> String {
    let file = name.rsplit(['/', '\\']).next().unwrap_or(name);
    file.rsplit_once('.').map_or(file, |(stem, _)| stem).to_owned()
}

fn pictures(trials: &[Trial]) -> Part {
    Part {
        title: "The scenes".into(),
        text: "The occluders under a light of 0.1 at a height of 0.75, shaded with the truth. What the technique makes of \
               them is in the CSV, where the occluders count too, which take no shadow."
            .into(),
        shown: vec![Shown::Pictures((0..trials.len()).collect())],
    }
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
        for occluder in [Occluder::square(), Occluder::of_builtin("balls", "spheres:segments=8")] {
            let scene = occluder.scene(Place { aside: 0.1, bottom: Some(0.25), ..Place::default() });
            let bounds = scene.bounds_of(|i| !i.receiver_only);
            assert!((bounds.size().max_element() - 0.2).abs() < 1e-5, "{}: {:?}", occluder.name, bounds);
            assert!((bounds.min.y - 0.25).abs() < 1e-5 && (bounds.center().x - 0.1).abs() < 1e-5, "{bounds:?}");
        }
        let copies = Occluder::square().copies(4, 0.1);
        let bounds = copies.bounds_of(|i| !i.receiver_only);
        assert!((bounds.size().length() * FRAC_1_SQRT_2 - 0.42).abs() < 1e-4, "{bounds:?}");
    }
}
