//! The four figures, as images and tables of errors.

use super::errors;
use crate::Error;
use crate::kit::{Content, Experiment, Runner, Section, Trial};
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

pub fn experiments(runner: &Runner) -> Result<Vec<Experiment>, Error> {
    let experiment = |figure: &Figure| {
        let scene = builtin::build(figure.scene)?;
        let experiment = Experiment::new(figure.title, scene, runner.half_size(SIZE), figure.specs)?;
        Ok(experiment.with_point_light().with_images().untimed())
    };
    FIGURES.iter().map(experiment).collect()
}

/// One section per figure.
pub fn sections(trials: &[Trial]) -> Vec<Section> {
    let section = |(trial, figure): (&Trial, &Figure)| {
        let text = format!(
            "{} The reference is a hard shadow, filtered over the pixel by a box. The scene: {}.",
            figure.text,
            trial.description()
        );
        Section::new(figure.title, text, vec![Content::renders(trial), errors::table(trial).into()])
    };
    trials.iter().zip(&FIGURES).map(section).collect()
}
