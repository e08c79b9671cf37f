//! Figure 8: the perceptual function beside a line that costs as much, and beside a single map. Figure 10: hard shadows
//! beside soft ones.

use super::scale::Scale;
use crate::Error;
use crate::kit::{Content, Experiment, Ratio, Run, Runner, Section, Trial, columns};
use crate::page::text;
use crate::table::{Table, column};

const CUBIC: &str = "pvssm";
/// Tolerance of the line's number of texels, relative to the cubic's.
const TOLERANCE: f64 = 0.05;

fn line(slope: f64) -> String {
    format!("pvssm:rho=linear,slope={slope:.4}")
}

/// The experiments of figures 8 and 10; the line of figure 8 has this slope.
pub fn experiments(scale: Scale, slope: f64) -> Result<Vec<Experiment>, Error> {
    let single = format!("smooth-pcss:map={}", scale.map(4096));
    let experiment =
        |name: &str, specs: &[&str]| Ok(Experiment::new(name, scale.pipes(1.5e6)?, scale.size, specs)?.with_images());
    [("figure 8", &[CUBIC, &line(slope), &single][..]), ("figure 10", &["fvsm", "pvssm"])]
        .map(|(name, specs)| experiment(name, specs))
        .into_iter()
        .collect()
}

/// The slope of a line with as many texels as the cubic.
pub fn tuned_slope(runner: &Runner, scale: Scale) -> Result<f64, Error> {
    let loaded = runner.load(&scale.pipes(1.5e6)?, scale.size)?;
    let texels = |text: &str| -> Result<f64, Error> {
        let rendered = loaded.render(&text.parse()?, 0, |_| ())?;
        Ok(rendered.stats.get("megatexels").copied().unwrap_or(0.0))
    };
    let wanted = texels(CUBIC)?;
    let (mut low, mut high, mut slope) = (0.1, 16.0, 2.0);
    for _ in 0..8 {
        let found = texels(&line(slope))?;
        if (found / wanted - 1.0).abs() < TOLERANCE {
            break;
        }
        *(if found < wanted { &mut low } else { &mut high }) = slope;
        slope = f64::sqrt(low * high);
    }
    Ok(slope)
}

pub fn sections(trials: &[Trial]) -> Vec<Section> {
    let texts = [
        (
            "Figure 8: the perceptual function",
            "The cubic polynomial of the kernel's size, a line that asks for as many texels, and a single map. The \
             paper: 4.8, 4.7 and 11 frames per second, the line and the map being much worse to look at.",
        ),
        (
            "Figure 10: hard and soft",
            "One texel per pixel for hard shadows, fewer for soft ones. The paper: 15 and 27 frames per second.",
        ),
    ];
    let section = |(trial, (title, text)): (&Trial, (&str, &str))| {
        Section::new(title, text, vec![Content::renders(trial), costs(trial).into()])
    };
    trials.iter().zip(texts).map(section).collect()
}

/// Error and cost of each run.
fn costs(trial: &Trial) -> Table {
    let columns = [
        columns::technique::<(&Trial, &Run)>(),
        columns::error(),
        columns::metric("FLIP", "Mean FLIP error", |run| run.metrics.flip),
        columns::ms(),
        columns::megabytes(),
        columns::count("tiles", "Rendered tiles", "tiles"),
        column("Mtexels", "Texels of all tiles", "2²⁰", |(_, run): &(&Trial, &Run)| {
            text::or_dash(run.stats.get("megatexels").map(|n| format!("{n:.1}")))
        }),
    ];
    Table::new(&columns, trial.heading(), trial.rows())
}

pub fn ratios(trials: &[Trial]) -> Vec<Ratio> {
    let of = |i: usize, what, run: usize, base: usize, paper: f64| {
        let trial = trials.get(i)?;
        Some(Ratio::speed(what, trial, &trial.runs[run], &trial.runs[base], Some(paper)))
    };
    let ratios = [
        of(0, "speed of the cubic over the line", 0, 1, 4.8 / 4.7),
        of(0, "speed of the cubic over a single map", 0, 2, 4.8 / 11.0),
        of(1, "speed of soft over hard", 1, 0, 27.0 / 15.0),
    ];
    ratios.into_iter().flatten().collect()
}
