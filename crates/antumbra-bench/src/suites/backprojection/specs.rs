//! Measured techniques: presets, one setting changed at a time, and competitors.

use crate::Error;
use crate::kit::{Run, Trial};
use antumbra::Spec;
use serde_json::Value;
use std::borrow::Borrow;

pub const FAST: &str = "backprojection:quality=fast";
pub const BALANCED: &str = "backprojection:quality=balanced";
pub const BEST: &str = "backprojection:quality=best";
/// `best` as its targets name it.
pub const BEST_OF_FOUR: &str = "backprojection:quality=best,layers=4";
/// The divisor of times.
pub const PCSS: &str = "pcss";
/// The presets and their competitor, for plots of few curves.
pub const COMPARED: [(&str, &str); 4] = [("fast", FAST), ("balanced", BALANCED), ("best", BEST), ("pcss", PCSS)];
/// Shadow maps of fixed sampling, from few to many.
pub const FIXED: [u32; 3] = [16, 64, 256];
/// Settings that vary around [`BALANCED`], with their values in order.
pub const SWEEPS: [(&str, &[&str]); 6] = [
    ("layers", &["1", "2", "4"]),
    ("window", &["2", "4", "8", "16"]),
    ("bits", &["64", "256", "1024"]),
    ("map", &["512", "1024", "2048"]),
    ("join", &["union", "sum"]),
    ("gaps_filled", &["true", "false"]),
];
/// Groups of [`Configuration`], in the order of their colours.
pub const GROUPS: [&str; 4] = ["presets", "balanced with one setting changed", "one map", "fixed sampling"];

/// A measured configuration.
pub struct Configuration {
    /// Index in [`GROUPS`].
    pub group: usize,
    /// Name in a plot.
    pub label: String,
    pub spec: Spec,
}

/// All configurations, each once: values of a sweep that equal a preset are left out.
pub fn all() -> Result<Vec<Configuration>, Error> {
    let preset = |(name, spec): &(&str, &str)| (0, (*name).to_owned(), (*spec).to_owned());
    let changed = |(key, value)| (1, format!("{key}={value}"), swept(key, value));
    let sweeps = SWEEPS.iter().flat_map(|(key, values)| values.iter().map(move |value| (*key, *value))).map(changed);
    let one_map = ["hard", "pcf", PCSS].map(|name| (2, name.to_owned(), name.to_owned()));
    let fixed = FIXED.map(|n| (3, format!("{n} maps"), fixed(n)));
    let texts = COMPARED[..3].iter().map(preset).chain([(0, "best, layers=4".to_owned(), BEST_OF_FOUR.to_owned())]);
    let mut found: Vec<Configuration> = Vec::new();
    for (group, label, text) in texts.chain(sweeps).chain(one_map).chain(fixed) {
        let spec: Spec = text.parse()?;
        if !found.iter().any(|other| does_the_same(&other.spec, spec.technique.name, &spec.settings)) {
            found.push(Configuration { group, label, spec });
        }
    }
    Ok(found)
}

/// `balanced` with another value of a setting.
pub fn swept(key: &str, value: &str) -> String {
    format!("{BALANCED},{key}={value}")
}

/// Fixed sampling with this many maps.
pub fn fixed(samples: u32) -> String {
    format!("uniform-sampling:samples={samples}")
}

/// The run of a SPEC, regardless of its spelling.
pub fn run_of<'a>(trial: &'a Trial, text: &str) -> Option<&'a Run> {
    let spec: Spec = text.parse().ok()?;
    let same = |run: &&Run| does_the_same(&spec, run.technique, &run.settings);
    trial.run(text).or_else(|| trial.runs.iter().find(same))
}

fn does_the_same(spec: &Spec, technique: &str, settings: &Value) -> bool {
    spec.technique.name == technique && without_quality(&spec.settings) == without_quality(settings)
}

/// Settings without the preset's name.
fn without_quality(settings: &Value) -> Value {
    let mut settings = settings.clone();
    if let Some(settings) = settings.as_object_mut() {
        settings.remove("quality");
    }
    settings
}

/// Mean of a configuration over several scenes.
pub struct Mean {
    /// Average error; every scene has the same weight.
    pub error: f64,
    /// Milliseconds.
    pub ms: f64,
}

impl Mean {
    /// None unless every scene has the run.
    pub fn of(trials: &[impl Borrow<Trial>], spec: &str) -> Option<Mean> {
        let runs: Vec<&Run> = trials.iter().map(|trial| run_of(trial.borrow(), spec)).collect::<Option<_>>()?;
        let mean = |value: fn(&Run) -> f64| runs.iter().map(|run| value(run)).sum::<f64>() / runs.len() as f64;
        let of = || Mean { error: mean(|run| run.metrics.average_error), ms: mean(|run| run.cost.total_ms) };
        (!runs.is_empty()).then(of)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_configuration_is_measured_once_and_found_by_any_spelling() {
        let all = all().unwrap();
        let same =
            |a: &Configuration, b: &Configuration| does_the_same(&a.spec, b.spec.technique.name, &b.spec.settings);
        assert!((0..all.len()).all(|i| (0..i).all(|j| !same(&all[i], &all[j]))));
        let found = |text: &str| {
            let spec: Spec = text.parse().unwrap();
            all.iter().any(|c| does_the_same(&c.spec, spec.technique.name, &spec.settings))
        };
        let sweeps = SWEEPS.iter().flat_map(|(key, values)| values.iter().map(|value| swept(key, value)));
        assert!(sweeps.chain([BEST_OF_FOUR.into(), PCSS.into()]).chain(FIXED.map(fixed)).all(|text| found(&text)));
        assert!(all.iter().all(|c| c.group < GROUPS.len()));
    }
}
