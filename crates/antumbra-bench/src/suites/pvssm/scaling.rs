//! Milliseconds over triangles and over pixels: growth with the scene and with the image.

use super::scale::Scale;
use crate::Error;
use crate::kit::{Content, Experiment, Section, Trial};
use crate::page::lines::{Curve, Lines, Point};
use crate::page::text;
use antumbra_scene::builtin;

const SPECS: [&str; 3] = ["pvssm", "fvsm", "smooth-pcss"];
/// Trees of 9194 triangles: from 100 000 triangles to 5 million at the paper's size.
const TREES: [f64; 4] = [11.0, 41.0, 149.0, 540.0];
const TRIANGLES: &str = "triangles";
const PIXELS: &str = "pixels";

pub fn experiments(scale: Scale) -> Result<Vec<Experiment>, Error> {
    let forest = |trees: f64| builtin::build(&format!("forest:trees={trees}"));
    let mut experiments = Vec::new();
    for trees in TREES.map(|trees| (trees * scale.pixels.sqrt()).round().max(1.0)) {
        let (name, size) = (format!("{TRIANGLES}, {trees} trees"), scale.size.map(|s| (s / 2).max(1)));
        experiments.push(Experiment::new(name, forest(trees)?, size, SPECS)?);
    }
    for part in [0.25, 0.5, 1.0] {
        let size = scale.size.map(|s| ((f64::from(s) * part).round() as u32).max(1));
        experiments.push(Experiment::new(format!("{PIXELS}, {} a side", size[0]), forest(11.0)?, size, SPECS)?);
    }
    Ok(experiments)
}

fn plot(x: &str, trials: &[&Trial], at: fn(&Trial) -> f64) -> Content {
    let curve = |label: &str, color: usize, ms: &dyn Fn(&Trial) -> Option<f64>| {
        let point = |trial: &&Trial| {
            let y = ms(trial)?;
            Some(Point::new(at(trial), y, format!("{label}, {}: {} ms", trial.name, text::ms(y))))
        };
        Curve::new(label, color, trials.iter().filter_map(point))
    };
    let whole = SPECS.iter().enumerate();
    let whole = whole.map(|(color, spec)| curve(spec, color, &|t| t.run(spec).map(|run| run.cost.total_ms)));
    let tiles = |t: &Trial| t.run(SPECS[0])?.cost.ms_of(|p| ["tiles", "tile culling"].contains(&p.name.as_str()));
    let tiles = |t: &Trial| tiles(t).filter(|ms| *ms > 0.0);
    let curves = whole.chain([curve("pvssm, its tiles alone", 0, &tiles).dashed(true)]);
    Lines::new(x, "milliseconds per frame", curves).guides(&[("x", 1.0)]).into()
}

pub fn section(trials: &[Trial]) -> Section {
    let of = |name: &str| trials.iter().filter(|t| t.name.starts_with(name)).collect::<Vec<_>>();
    Section::new(
        "Milliseconds over triangles and pixels",
        "Forests of more and more trees at one image size, and one forest at several. The tiles' own passes are shown \
         separately: they grow with the clusters in their windows, not with the scene.",
        vec![
            plot("triangles", &of(TRIANGLES), |trial| trial.triangles as f64),
            plot("pixels", &of(PIXELS), Trial::pixel_count),
        ],
    )
}
