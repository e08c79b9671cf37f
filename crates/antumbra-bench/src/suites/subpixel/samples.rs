//! Figure 10: milliseconds over the samples of a pixel, beside supersampled alias-free shadow maps.

use super::table;
use crate::Error;
use crate::kit::{Experiment, Runner, Section, Trial};
use crate::page::lines::{Curve, Lines, Point};
use crate::page::text;
use antumbra_scene::builtin;

/// The paper's pterosaur is one smooth body over a plane.
const SCENE: &str = "disk";
const NAME: &str = "samples";
const OURS: [u32; 6] = [1, 8, 16, 32, 64, 128];
/// The paper has no 128: its supersampled image was larger than a texture could be.
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

pub fn experiments(runner: &Runner) -> Result<Vec<Experiment>, Error> {
    let experiment = Experiment::new(NAME, builtin::build(SCENE)?, runner.size(table::SIZE), specs())?;
    Ok(vec![experiment.with_point_light()])
}

pub fn section(trials: &[Trial]) -> Section {
    let curve = |color: usize, label: &str, counts: &[u32], spec: fn(u32) -> String| {
        let point = |n: &u32| {
            let run = trials.first()?.run(&spec(*n))?;
            let note = format!("{}: {} ms, RMSE {}", run.spec, run.ms(), text::metric(run.metrics.rmse));
            Some(Point::new(f64::from(*n), run.cost.total_ms, note))
        };
        Curve::new(label, color, counts.iter().filter_map(point)).dashed(color > 0)
    };
    let curves = [curve(0, "subpixel", &OURS, table::spec), curve(1, "alias-free, supersampled", &BRUTE, brute)];
    Section::new(
        "Milliseconds over samples (figure 10)",
        "The paper, pterosaur: supersampling grows with the samples, to about 180 ms at 32 and 350 ms at 64; sub-pixel \
         masks stay near 15 ms at all rates.",
        vec![Lines::new("samples per pixel", "milliseconds per frame", curves).into()],
    )
}
