//! What the presets are meant to reach, beside what they do.

use super::super::kit::{Group, Part, Shown, Table, Trial};
use super::specs::{BALANCED, BEST_OF_FOUR, FAST, FIXED, Mean, PCSS, fixed, run_of};
use crate::report::text;

/// In the name of the scene that does not come with the program.
pub const BUNNY: &str = "bunny";
const ALL: &[&str] = &["fence", "layers", "plant", BUNNY];

/// One thing to reach.
struct Target {
    spec: &'static str,
    what: What,
    scenes: &'static [&'static str],
    limit: Limit,
}

#[derive(Clone, Copy)]
enum What {
    /// Average error, the mean over the scenes.
    Error,
    /// Milliseconds over those of PCSS at its defaults, all scenes together.
    OverPcss,
    /// Milliseconds of as many fixed samples as have the same error, over these.
    UnderFixed,
}

#[derive(Clone, Copy)]
enum Limit {
    AtMost(f64),
    AtLeast(f64),
}

/// A number, or on which side of one it is.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Measured {
    Exactly(f64),
    /// Even the most fixed samples err more.
    AtLeast(f64),
    /// Even the fewest fixed samples err less.
    AtMost(f64),
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Verdict {
    Met,
    Missed,
    /// The measured bound does not tell.
    Open,
    /// Not one of its scenes was there.
    Unmeasured,
}

const TARGETS: [Target; 9] = {
    use Limit::{AtLeast, AtMost};
    use What::{Error, OverPcss, UnderFixed};
    const fn target(spec: &'static str, what: What, scenes: &'static [&'static str], limit: Limit) -> Target {
        Target { spec, what, scenes, limit }
    }
    [
        target(FAST, OverPcss, ALL, AtMost(1.0)),
        target(FAST, Error, ALL, AtMost(0.025)),
        target(BALANCED, OverPcss, ALL, AtMost(3.0)),
        target(BALANCED, Error, ALL, AtMost(0.018)),
        target(BALANCED, UnderFixed, ALL, AtLeast(10.0)),
        target(BEST_OF_FOUR, Error, &["fence"], AtMost(0.010)),
        target(BEST_OF_FOUR, Error, &["layers"], AtMost(0.010)),
        target(BEST_OF_FOUR, Error, &[BUNNY], AtMost(0.010)),
        target(BEST_OF_FOUR, Error, &["plant"], AtMost(0.025)),
    ]
};

const HEADS: [(&str, &str); 6] = [
    ("technique", "Name and settings"),
    ("what", "What is measured"),
    ("scenes", "Which scene, or how many of the four were there"),
    ("measured", "Over all of them; in brackets the least and the most of a scene"),
    ("target", "What it is meant to be"),
    ("met", "Whether it is; open where fixed sampling was not measured with as many or as few maps"),
];

/// The table of targets, and what it comes to in a sentence.
pub fn part(scenes: &[Trial]) -> (Part, String) {
    let rows: Vec<(Vec<String>, Verdict)> = TARGETS.iter().map(|target| target.row(scenes)).collect();
    let of = |wanted| rows.iter().filter(move |(_, verdict)| *verdict == wanted);
    let met = format!("{} of {} targets are met", of(Verdict::Met).count(), TARGETS.len());
    let list = |wanted, what: &str| {
        let of: Vec<String> =
            of(wanted).map(|(row, _)| format!("{} {} ({})", preset(&row[0]), row[1], row[2])).collect();
        if of.is_empty() { String::new() } else { format!("; {what}: {}", of.join(", ")) }
    };
    let lead = [
        met,
        list(Verdict::Missed, "missed"),
        list(Verdict::Open, "open"),
        list(Verdict::Unmeasured, "without their scene"),
        format!(".{}", without_bunny(scenes)),
    ];
    let groups = vec![Group { title: String::new(), rows: rows.iter().map(|(row, _)| row.clone()).collect() }];
    let text = "Over four scenes, fence, layers, plant and the bunny, or each by itself. Milliseconds are divided by those of PCSS at its defaults in the same scenes and the same run. Fixed \
                sampling is taken at the same error, interpolated between the numbers of maps that were measured, both mean \
                error and mean milliseconds logarithmic.";
    let shown = vec![Shown::Table(Table { heads: HEADS.to_vec(), groups })];
    (Part { title: "Targets".into(), text: text.into(), shown }, lead.concat())
}

/// What follows `quality=`.
fn preset(spec: &str) -> &str {
    spec.split_once('=').map_or(spec, |(_, preset)| preset)
}

fn without_bunny(scenes: &[Trial]) -> &'static str {
    match scenes.iter().any(|trial| is(trial, BUNNY)) {
        true => "",
        false => {
            " The Stanford bunny was not given and no figure here knows of it: --scene takes it, as a model with \
             \"bunny\" in its file's name."
        }
    }
}

fn is(trial: &Trial, scene: &str) -> bool {
    trial.name == scene || scene == BUNNY && trial.name.to_lowercase().contains(BUNNY)
}

impl Target {
    fn row(&self, scenes: &[Trial]) -> (Vec<String>, Verdict) {
        let there = |scene: &&str| scenes.iter().find(|trial| is(trial, scene));
        let trials: Vec<&Trial> = self.scenes.iter().filter_map(there).collect();
        let measured = self.what.of(self.spec, &trials);
        let verdict = measured.map_or(Verdict::Unmeasured, |measured| self.limit.verdict(measured));
        let number = |value| self.what.text(value);
        let measured = match measured {
            None => "–".to_owned(),
            Some(Measured::Exactly(value)) => number(value) + &self.spread(&trials),
            Some(Measured::AtLeast(value)) => format!("≥ {}", number(value)),
            Some(Measured::AtMost(value)) => format!("≤ {}", number(value)),
        };
        let scenes = match self.scenes {
            [scene] if trials.is_empty() => format!("no {scene}"),
            [scene] => (*scene).to_owned(),
            several => format!("{} of {}", trials.len(), several.len()),
        };
        let target = match self.limit {
            Limit::AtMost(value) => format!("≤ {}", self.what.target(value)),
            Limit::AtLeast(value) => format!("≥ {}", self.what.target(value)),
        };
        let cells = [self.what.name(), &scenes, &measured, &target, verdict.word()];
        let row = std::iter::once(self.spec).chain(cells).map(str::to_owned).collect();
        (row, verdict)
    }

    /// The least and the most of a scene, where there are several.
    fn spread(&self, trials: &[&Trial]) -> String {
        let of_one = |trial: &&Trial| match self.what.of(self.spec, &[trial])? {
            Measured::Exactly(value) => Some(value),
            _ => None,
        };
        let Some(values) = trials.iter().map(of_one).collect::<Option<Vec<f64>>>() else { return String::new() };
        let (low, high) = values.iter().fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(*v), high.max(*v)));
        match values.len() {
            0 | 1 => String::new(),
            _ => format!(" ({}–{})", self.what.text(low), self.what.text(high)),
        }
    }
}

impl What {
    fn name(self) -> &'static str {
        match self {
            What::Error => "average error",
            What::OverPcss => "ms ÷ pcss",
            What::UnderFixed => "ms of fixed ÷ own",
        }
    }

    fn text(self, value: f64) -> String {
        match self {
            What::Error => text::figure(value),
            What::OverPcss | What::UnderFixed => text::ratio(value),
        }
    }

    fn target(self, value: f64) -> String {
        match self {
            What::Error => format!("{value:.3}"),
            What::OverPcss | What::UnderFixed => value.to_string(),
        }
    }

    fn of(self, spec: &str, trials: &[&Trial]) -> Option<Measured> {
        let own = Mean::of(trials, spec)?;
        match self {
            What::Error => Some(Measured::Exactly(own.error)),
            What::OverPcss => Some(Measured::Exactly(own.ms / Mean::of(trials, PCSS)?.ms)),
            What::UnderFixed => {
                let means: Vec<Mean> = FIXED.iter().map(|n| Mean::of(trials, &fixed(*n))).collect::<Option<_>>()?;
                Some(fixed_ms_at(own.error, &means)?.map(|ms| ms / own.ms))
            }
        }
    }
}

impl Measured {
    fn map(self, change: impl Fn(f64) -> f64) -> Measured {
        match self {
            Measured::Exactly(value) => Measured::Exactly(change(value)),
            Measured::AtLeast(value) => Measured::AtLeast(change(value)),
            Measured::AtMost(value) => Measured::AtMost(change(value)),
        }
    }
}

/// Milliseconds of fixed sampling with this error, between the measured numbers of maps; few maps come first.
fn fixed_ms_at(error: f64, fixed: &[Mean]) -> Option<Measured> {
    let (first, last) = (fixed.first()?, fixed.last()?);
    if error >= first.error {
        return Some(Measured::AtMost(first.ms));
    }
    let between = |pair: &&[Mean]| pair[0].error > error && error >= pair[1].error;
    let Some([few, many]) = fixed.windows(2).find(between) else { return Some(Measured::AtLeast(last.ms)) };
    let part = (few.error / error).ln() / (few.error / many.error).ln();
    Some(Measured::Exactly(few.ms * (many.ms / few.ms).powf(part)))
}

impl Limit {
    fn verdict(self, measured: Measured) -> Verdict {
        let judged = |kept, sure| match (kept, sure) {
            (_, false) => Verdict::Open,
            (true, true) => Verdict::Met,
            (false, true) => Verdict::Missed,
        };
        match (self, measured) {
            (Limit::AtMost(limit), Measured::Exactly(value)) => judged(value <= limit, true),
            (Limit::AtMost(limit), Measured::AtLeast(value)) => judged(false, value > limit),
            (Limit::AtMost(limit), Measured::AtMost(value)) => judged(true, value <= limit),
            (Limit::AtLeast(limit), Measured::Exactly(value)) => judged(value >= limit, true),
            (Limit::AtLeast(limit), Measured::AtLeast(value)) => judged(true, value >= limit),
            (Limit::AtLeast(limit), Measured::AtMost(value)) => judged(false, value < limit),
        }
    }
}

impl Verdict {
    fn word(self) -> &'static str {
        match self {
            Verdict::Met => "yes",
            Verdict::Missed => "no",
            Verdict::Open => "open",
            Verdict::Unmeasured => "–",
        }
    }
}

/// Milliseconds of PCSS over those of a preset, for the files.
pub fn speed_over_pcss(trial: &Trial, spec: &str) -> Option<f64> {
    Some(run_of(trial, spec)?.speed_over(run_of(trial, PCSS)?))
}

#[cfg(test)]
mod tests {
    use super::super::super::kit::tests::{run, trial};
    use super::*;

    fn means(of: &[(f64, f64)]) -> Vec<Mean> {
        of.iter().map(|(error, ms)| Mean { error: *error, ms: *ms }).collect()
    }

    #[test]
    fn fixed_sampling_of_the_same_error_lies_between_the_measured_ones() {
        let fixed = means(&[(0.04, 10.0), (0.02, 40.0), (0.01, 160.0)]);
        assert_eq!(fixed_ms_at(0.05, &fixed), Some(Measured::AtMost(10.0)));
        assert_eq!(fixed_ms_at(0.005, &fixed), Some(Measured::AtLeast(160.0)));
        let Some(Measured::Exactly(ms)) = fixed_ms_at(0.02 / 2f64.sqrt(), &fixed) else { panic!("between") };
        assert!((ms - 80.0).abs() < 1e-6, "{ms}");
        assert_eq!(fixed_ms_at(0.1, &[]), None);
    }

    #[test]
    fn a_bound_decides_only_where_it_can() {
        use Verdict::{Met, Missed, Open};
        let most = [Measured::Exactly(3.0), Measured::AtLeast(2.0), Measured::AtLeast(4.0), Measured::AtMost(2.0)];
        assert_eq!(most.map(|m| Limit::AtMost(3.0).verdict(m)), [Met, Open, Missed, Met]);
        let least = [Measured::Exactly(9.0), Measured::AtLeast(9.0), Measured::AtLeast(10.0), Measured::AtMost(2.0)];
        assert_eq!(least.map(|m| Limit::AtLeast(10.0).verdict(m)), [Missed, Open, Met, Missed]);
    }

    #[test]
    fn targets_stand_beside_what_was_measured() {
        let runs = |ms| vec![run(FAST, ms, &[]), run(PCSS, 10.0, &[])];
        let scenes = [trial("fence", runs(8.0)), trial("plant", runs(14.0))];
        let (cells, verdict) = TARGETS[0].row(&scenes);
        assert_eq!(verdict, Verdict::Missed);
        assert_eq!(cells[1..], ["ms ÷ pcss", "2 of 4", "1.1 (0.80–1.4)", "≤ 1", "no"]);
        let (part, lead) = part(&scenes);
        let [Shown::Table(table)] = &part.shown[..] else { panic!("a table") };
        assert!(table.groups[0].rows.iter().all(|row| row.len() == HEADS.len()));
        assert!(lead.contains("bunny was not given") && lead.contains("missed: fast ms ÷ pcss (2 of 4)"), "{lead}");
        let (_, lead) = super::part(&[trial("stanford-Bunny", runs(8.0))]);
        assert!(!lead.contains("not given"), "{lead}");
    }
}
