//! The paper's four figures: anisotropy, mip mapping, filters side by side, light bleeding.

use super::super::kit::{Lab, Part, Shown, Trial};
use super::{Job, read, with_point_light};
use crate::error::CliError;
use antumbra_scene::builtin;

/// A figure of the paper on a scene of its kind.
struct Figure {
    title: &'static str,
    text: &'static str,
    scene: &'static str,
    specs: &'static [&'static str],
}

const FIGURES: [Figure; 4] = [
    Figure {
        title: "Figure 1: anisotropic filtering",
        text: "A plain at a grazing angle: bilinear comparisons, then moments without filtering, with a mip chain, and with \
               16x anisotropy.",
        scene: "grid",
        specs: &[
            "pcf:pcf=1,lookup=bilinear",
            "vsm:blur=1,mips=false",
            "vsm:blur=1,anisotropy=1",
            "vsm:blur=1,anisotropy=16",
            "vsm:blur=1,anisotropy=16,multisample=true",
        ],
    },
    Figure {
        title: "Figure 2: mip mapping",
        text: "Where a pixel covers many texels: variance shadow maps without and with a mip chain.",
        scene: "forest:trees=16",
        specs: &["hard", "vsm:blur=1,mips=false", "vsm:blur=1,anisotropy=1", "vsm:blur=1"],
    },
    Figure {
        title: "Figure 3: filters",
        text: "Where texels show: a shadow map, 5x5 comparisons, 5x5 bilinear comparisons, and a 5x5 blur of the moments, all \
               with a map of 512 texels.",
        scene: "fence",
        specs: &[
            "hard:map=512",
            "pcf:map=512,pcf=5,lookup=nearest",
            "pcf:map=512,pcf=5,lookup=bilinear",
            "vsm:map=512,blur=5",
        ],
    },
    Figure {
        title: "Figure 4: light bleeding",
        text: "Where shadows overlap the variance is large and light bleeds into what should be black: the family, and the \
               bound of variance shadow maps rescaled.",
        scene: "layers",
        specs: &["vsm", "vsm:bleeding=0.3", "evsm", "msm", "msm:format=rgba16unorm", "esm", "csm"],
    },
];
const SIZE: [u32; 2] = [512, 384];

pub fn jobs(lab: &Lab) -> Result<Vec<Job>, CliError> {
    let job = |figure: &Figure| {
        Ok(Job {
            name: figure.title.to_owned(),
            scene: with_point_light(builtin::build(figure.scene)?),
            // Half of --size each way, at most.
            size: lab.args.size.map_or(SIZE, |size| size.0.map(|side| (side / 2).max(1))),
            specs: read(figure.specs)?,
            hard: true,
            pictures: true,
            frames: 0,
        })
    };
    FIGURES.iter().map(job).collect()
}

/// One part a figure; `first` is the place of the first trial.
pub fn parts(trials: &[Trial], first: usize) -> Vec<Part> {
    let part = |(i, (trial, figure)): (usize, (&Trial, &Figure))| Part {
        title: figure.title.into(),
        text: format!(
            "{} The truth is a hard shadow, filtered over the pixel by a box. Drawn is {}.",
            figure.text,
            trial.drawn()
        ),
        shown: vec![Shown::Runs(first + i), Shown::Table(super::family::error_table(trial))],
    };
    trials.iter().zip(&FIGURES).enumerate().map(part).collect()
}
