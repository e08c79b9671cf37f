//! Milliseconds over triangles and over pixels: what grows with the scene, and what with the picture.

use super::super::kit::{Part, Run, Shown, Trial};
use super::{Job, Scale, read};
use crate::error::CliError;
use crate::report::lines::{Curve, Guide, Lines, Spot};
use crate::report::text;
use antumbra_scene::builtin;

const SPECS: [&str; 3] = ["pvssm", "fvsm", "smooth-pcss"];
/// Trees of 9194 triangles: from 100 000 triangles to 5 million at the paper's size.
const TREES: [f64; 4] = [11.0, 41.0, 149.0, 540.0];
const TRIANGLES: &str = "triangles";
const PIXELS: &str = "pixels";

pub fn jobs(scale: Scale) -> Result<Vec<Job>, CliError> {
    let specs = || read(SPECS.map(str::to_owned).to_vec());
    let mut jobs = Vec::new();
    for trees in TREES.map(|trees| (trees * scale.pixels.sqrt()).round().max(1.0)) {
        let scene = builtin::build(&format!("forest:trees={trees}"))?;
        let (name, size) = (format!("{TRIANGLES}, {trees} trees"), scale.size.map(|s| (s / 2).max(1)));
        jobs.push(Job { name, scene, size, specs: specs()?, pictures: false });
    }
    for part in [0.25, 0.5, 1.0] {
        let size = scale.size.map(|s| ((f64::from(s) * part).round() as u32).max(1));
        let scene = builtin::build("forest:trees=11")?;
        jobs.push(Job { name: format!("{PIXELS}, {} a side", size[0]), scene, size, specs: specs()?, pictures: false });
    }
    Ok(jobs)
}

/// Milliseconds of the passes that draw and cull tiles.
fn tiles_of(run: &Run) -> f64 {
    let passes = run.cost.passes.iter().filter(|p| p.name == "tiles" || p.name == "tile culling");
    passes.filter_map(|p| p.ms).sum()
}

fn plot(x: &str, trials: &[&Trial], at: impl Fn(&Trial) -> f64) -> Shown {
    let curve = |label: &str, color: usize, dashed: bool, ms: &dyn Fn(&Trial) -> Option<f64>| {
        let spot = |trial: &&Trial| {
            let (x, y) = (at(trial), ms(trial)?);
            Some(Spot { x, y, note: format!("{label}, {}: {} ms", trial.name, text::ms(y)) })
        };
        let points = trials.iter().filter_map(spot).collect();
        Curve { label: label.to_owned(), color, dashed, points }
    };
    let whole = SPECS.iter().enumerate();
    let mut curves: Vec<Curve> =
        whole.map(|(color, spec)| curve(spec, color, false, &|t| t.run(spec).map(|run| run.cost.total_ms))).collect();
    let tiles = |t: &Trial| t.run(SPECS[0]).map(tiles_of).filter(|ms| *ms > 0.0);
    curves.push(curve("pvssm, its tiles alone", 0, true, &tiles));
    Shown::Lines(Lines {
        x: x.into(),
        y: "milliseconds a frame".into(),
        less_is_better: false,
        curves,
        guides: vec![Guide { label: "x".into(), exponent: 1.0 }],
    })
}

pub fn part(trials: &[Trial]) -> Part {
    let of = |name: &str| trials.iter().filter(|t| t.name.starts_with(name)).collect::<Vec<_>>();
    let pixels = |trial: &Trial| f64::from(trial.width) * f64::from(trial.height);
    Part {
        title: "Milliseconds over triangles and pixels".into(),
        text:
            "Forests of more and more trees at one size of picture, and one forest at several. The tiles' own passes \
               are shown apart: they grow with the clusters that their windows hold, not with the scene."
                .into(),
        shown: vec![
            plot("triangles", &of(TRIANGLES), |trial| trial.triangles as f64),
            plot("pixels", &of(PIXELS), pixels),
        ],
    }
}
