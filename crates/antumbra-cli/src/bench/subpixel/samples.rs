//! Figure 10: milliseconds over the samples of a pixel, beside supersampled alias-free shadow maps.

use super::super::kit::{Lab, Part, Shown, Trial};
use super::{Job, SIZE, read, table, with_point_light};
use crate::error::CliError;
use crate::report::lines::{Curve, Spot};
use crate::report::{Lines, text};
use antumbra_scene::builtin;

/// The paper's pterosaur is one smooth body over a plane.
const SCENE: &str = "disk";
const NAME: &str = "samples";
const OURS: [u32; 6] = [1, 8, 16, 32, 64, 128];
/// The paper has no 128: its supersampled picture was larger than a texture could be.
const BRUTE: [u32; 5] = [1, 8, 16, 32, 64];

fn brute(samples: u32) -> String {
    format!("{}:samples={samples}", table::EXACT)
}

fn specs() -> Vec<String> {
    OURS.iter().map(|n| table::spec(*n)).chain(BRUTE.iter().map(|n| brute(*n))).collect()
}

/// Name of the trial, with its SPECs.
#[cfg(test)]
pub fn name() -> (String, Vec<String>) {
    (NAME.to_owned(), specs())
}

pub fn jobs(lab: &Lab) -> Result<Vec<Job>, CliError> {
    let scene = with_point_light(builtin::build(SCENE)?);
    let size = lab.size(SIZE);
    Ok(vec![Job { name: NAME.to_owned(), scene, size, specs: read(&specs())?, frames: lab.args.gpu.frames }])
}

pub fn part(trials: &[Trial]) -> Part {
    let curve = |color: usize, label: &str, counts: &[u32], spec: fn(u32) -> String| {
        let runs = counts.iter().filter_map(|n| Some((*n, trials.first()?.run(&spec(*n))?)));
        let points = runs
            .map(|(n, run)| {
                let (x, y) = (f64::from(n), run.cost.total_ms);
                Spot { x, y, note: format!("{}: {} ms, RMSE {}", run.spec, run.ms(), text::figure(run.figures.rmse)) }
            })
            .collect();
        Curve { label: label.into(), color, dashed: color > 0, points }
    };
    let curves = vec![curve(0, "subpixel", &OURS, table::spec), curve(1, "alias-free, supersampled", &BRUTE, brute)];
    Part {
        title: "Milliseconds over samples (figure 10)".into(),
        text: "The paper, pterosaur: supersampling grows with the samples, to about 180 ms at 32 and 350 ms at 64; \
               sub-pixel masks stay near 15 ms at all rates."
            .into(),
        shown: vec![Shown::Lines(Lines {
            x: "samples a pixel".into(),
            y: "milliseconds a frame".into(),
            less_is_better: false,
            curves,
            guides: Vec::new(),
        })],
    }
}
