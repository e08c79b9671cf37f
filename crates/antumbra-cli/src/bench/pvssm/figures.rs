//! Figure 8: the perceptual function beside a line that costs as much, and beside a single map. Figure 10: hard shadows
//! beside soft ones.

use super::super::kit::{Lab, Part, Ratio, Shown, Trial};
use super::{Job, Scale, cost_table, read};
use crate::error::CliError;
use crate::{measure, setup};
use antumbra::Spec;

const PREDICTED: &str = "figure 8";
const HARD_AND_SOFT: &str = "figure 10";
const CUBIC: &str = "pvssm";
/// What of the cubic's texels a line may have more or less.
const TUNED: f64 = 0.05;

pub fn jobs(lab: &Lab, scale: Scale) -> Result<Vec<Job>, CliError> {
    jobs_at(scale, tuned_slope(lab, scale)?)
}

/// The jobs, the line having this slope.
pub fn jobs_at(scale: Scale, slope: f64) -> Result<Vec<Job>, CliError> {
    let line = format!("pvssm:rho=linear,slope={slope:.4}");
    let single = format!("smooth-pcss:map={}", scale.map(4096));
    let job = |name: &str, scene, texts: Vec<String>| -> Result<Job, CliError> {
        Ok(Job { name: name.to_owned(), scene, size: scale.size, specs: read(texts)?, pictures: true })
    };
    Ok(vec![
        job(PREDICTED, scale.pipes(1.5e6)?, vec![CUBIC.to_owned(), line, single])?,
        job(HARD_AND_SOFT, scale.pipes(1.5e6)?, ["fvsm", "pvssm"].map(str::to_owned).to_vec())?,
    ])
}

/// The slope of a line that asks for as many texels as the cubic does.
fn tuned_slope(lab: &Lab, scale: Scale) -> Result<f64, CliError> {
    let renderer = setup::renderer(lab.gpu, &scale.pipes(1.5e6)?, scale.size)?;
    let texels = |text: &str| -> Result<f64, CliError> {
        let spec: Spec = text.parse().map_err(antumbra::Error::from)?;
        let drawn = measure::draw(lab.gpu, &renderer, &spec, 0, |_| ())?;
        Ok(drawn.work.iter().find(|(name, _)| *name == "megatexels").map_or(0.0, |(_, n)| *n))
    };
    let wanted = texels(CUBIC)?;
    let (mut low, mut high) = (0.1, 16.0);
    let mut slope = 2.0;
    for _ in 0..8 {
        let found = texels(&format!("pvssm:rho=linear,slope={slope:.4}"))?;
        if (found / wanted - 1.0).abs() < TUNED {
            break;
        }
        if found < wanted {
            low = slope;
        } else {
            high = slope;
        }
        slope = f64::sqrt(low * high);
    }
    Ok(slope)
}

pub fn parts(trials: &[Trial], first: usize) -> Vec<Part> {
    let texts = [
        (
            "Figure 8: the perceptual function",
            "The cubic polynomial of the kernel's size, a line that asks for as many texels, and a single map. The \
             paper: 4.8, 4.7 and 11 frames a second, the line and the map being much worse to look at.",
        ),
        (
            "Figure 10: hard and soft",
            "A texel a pixel for hard shadows, fewer for soft ones. The paper: 15 and 27 frames a second.",
        ),
    ];
    let part = |(i, (trial, (title, text))): (usize, (&Trial, (&str, &str)))| Part {
        title: title.into(),
        text: text.into(),
        shown: vec![Shown::Runs(first + i), cost_table(trial)],
    };
    trials.iter().zip(texts).enumerate().map(part).collect()
}

pub fn ratios(trials: &[Trial]) -> Vec<Ratio> {
    let of = |trial: &Trial, what: &'static str, run: usize, base: usize, paper: f64| {
        let (run, base) = (&trial.runs[run], &trial.runs[base]);
        let ours = run.speed_over(base);
        Ratio {
            what,
            trial: trial.name.clone(),
            spec: run.spec.clone(),
            base: base.spec.clone(),
            paper: Some(paper),
            ours,
        }
    };
    let mut found = Vec::new();
    if let Some(trial) = trials.first() {
        found.push(of(trial, "speed of the cubic over the line", 0, 1, 4.8 / 4.7));
        found.push(of(trial, "speed of the cubic over a single map", 0, 2, 4.8 / 11.0));
    }
    found.extend(trials.get(1).map(|trial| of(trial, "speed of soft over hard", 1, 0, 27.0 / 15.0)));
    found
}
