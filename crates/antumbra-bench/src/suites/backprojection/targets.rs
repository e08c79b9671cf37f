//! The presets' targets beside the measurements.

use super::specs::{BALANCED, BEST_OF_FOUR, FAST, FIXED, Mean, PCSS, fixed};
use crate::kit::{Section, Trial};
use crate::page::text;
use crate::table::{Table, column};

/// Part of the name of the scene that does not come with the program.
const BUNNY: &str = "bunny";
const ALL: &[&str] = &["fence", "layers", "plant", BUNNY];

/// One target.
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
    /// Milliseconds of fixed sampling at the same error, over these.
    UnderFixed,
}

#[derive(Clone, Copy)]
enum Limit {
    AtMost(f64),
    AtLeast(f64),
}

/// The range of a measured value: a number, or a bound where fixed sampling was not measured with enough or few maps.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Measured {
    low: f64,
    high: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Verdict {
    Met,
    Missed,
    /// The measured bound does not decide.
    Open,
    /// None of its scenes was measured.
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

/// A target with its measurement.
struct Row {
    target: &'static Target,
    scenes: String,
    measured: String,
    verdict: Verdict,
}

/// The table of targets, and its result in a sentence.
pub fn section(scenes: &[Trial]) -> (Section, String) {
    let rows: Vec<Row> = TARGETS.iter().map(|target| target.row(scenes)).collect();
    let list = |wanted, what: &str| {
        let of = rows.iter().filter(|row| row.verdict == wanted).map(Row::short);
        let of = of.collect::<Vec<_>>().join(", ");
        if of.is_empty() { of } else { format!("; {what}: {of}") }
    };
    let met = rows.iter().filter(|row| row.verdict == Verdict::Met).count();
    let lead = [
        format!("{met} of {} targets are met", TARGETS.len()),
        list(Verdict::Missed, "missed"),
        list(Verdict::Open, "open"),
        list(Verdict::Unmeasured, "without their scene"),
        format!(".{}", without_bunny(scenes)),
    ];
    let columns = [
        column("technique", "Name and settings", "", |row: &Row| row.target.spec.to_owned()),
        column("what", "The measured quantity", "", |row: &Row| row.target.what.name().to_owned()),
        column("scenes", "Which scene, or how many of the four were measured", "", |row: &Row| row.scenes.clone()),
        column("measured", "Over all of them; in brackets the extremes of single scenes", "", |row: &Row| {
            row.measured.clone()
        }),
        column("target", "The limit", "", |row: &Row| row.target.limit.text(row.target.what)),
        column(
            "met",
            "Whether it is met; open where fixed sampling was not measured with as many or as few maps",
            "",
            |row: &Row| row.verdict.word().to_owned(),
        ),
    ];
    let text = "Over four scenes, fence, layers, plant and the bunny, or each by itself. Milliseconds are divided by those \
                of PCSS at its defaults in the same scenes and the same run. Fixed sampling is taken at the same error, \
                interpolated between the measured numbers of maps, both mean error and mean milliseconds logarithmic.";
    (Section::new("Targets", text, vec![Table::new(&columns, "", rows).into()]), lead.concat())
}

fn without_bunny(scenes: &[Trial]) -> &'static str {
    match scenes.iter().any(|trial| is(trial, BUNNY)) {
        true => "",
        false => {
            " The Stanford bunny was not given and no number here includes it: --scene takes it, as a model with \
             \"bunny\" in its file's name."
        }
    }
}

fn is(trial: &Trial, scene: &str) -> bool {
    trial.name == scene || scene == BUNNY && trial.name.to_lowercase().contains(BUNNY)
}

impl Row {
    /// For the sentence: the preset, the quantity, the scenes.
    fn short(&self) -> String {
        let Target { spec, what, .. } = self.target;
        let preset = spec.split_once('=').map_or(*spec, |(_, preset)| preset);
        format!("{preset} {} ({})", what.name(), self.scenes)
    }
}

impl Target {
    fn row(&'static self, scenes: &[Trial]) -> Row {
        let there = |scene: &&str| scenes.iter().find(|trial| is(trial, scene));
        let trials: Vec<&Trial> = self.scenes.iter().filter_map(there).collect();
        let found = self.what.of(self.spec, &trials);
        let verdict = found.map_or(Verdict::Unmeasured, |measured| self.limit.verdict(measured));
        let number = |value| self.what.text(value);
        let measured = match found {
            None => text::DASH.to_owned(),
            Some(Measured { low, high }) if low == high => number(low) + &self.spread(&trials),
            Some(Measured { low, high: f64::INFINITY }) => format!("≥ {}", number(low)),
            Some(Measured { high, .. }) => format!("≤ {}", number(high)),
        };
        let scenes = match self.scenes {
            [scene] if trials.is_empty() => format!("no {scene}"),
            [scene] => (*scene).to_owned(),
            several => format!("{} of {}", trials.len(), several.len()),
        };
        Row { target: self, scenes, measured, verdict }
    }

    /// The extremes of single scenes, where there are several.
    fn spread(&self, trials: &[&Trial]) -> String {
        let of_one = |trial: &&Trial| {
            let Measured { low, high } = self.what.of(self.spec, &[trial])?;
            (low == high).then_some(low)
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
            What::Error => text::metric(value),
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
            What::Error => Some(Measured::exactly(own.error)),
            What::OverPcss => Some(Measured::exactly(own.ms / Mean::of(trials, PCSS)?.ms)),
            What::UnderFixed => {
                let means: Vec<Mean> = FIXED.iter().map(|n| Mean::of(trials, &fixed(*n))).collect::<Option<_>>()?;
                Some(fixed_ms_at(own.error, &means)?.over(own.ms))
            }
        }
    }
}

impl Measured {
    fn exactly(value: f64) -> Measured {
        Measured { low: value, high: value }
    }

    /// For the positive values here.
    fn over(self, divisor: f64) -> Measured {
        Measured { low: self.low / divisor, high: self.high / divisor }
    }
}

/// Milliseconds of fixed sampling at this error, interpolated between the measured numbers of maps, fewest first.
fn fixed_ms_at(error: f64, fixed: &[Mean]) -> Option<Measured> {
    let (first, last) = (fixed.first()?, fixed.last()?);
    if error >= first.error {
        return Some(Measured { low: f64::NEG_INFINITY, high: first.ms });
    }
    let between = |pair: &&[Mean]| pair[0].error > error && error >= pair[1].error;
    let Some([few, many]) = fixed.windows(2).find(between) else {
        return Some(Measured { low: last.ms, high: f64::INFINITY });
    };
    let part = (few.error / error).ln() / (few.error / many.error).ln();
    Some(Measured::exactly(few.ms * (many.ms / few.ms).powf(part)))
}

impl Limit {
    fn text(self, of: What) -> String {
        match self {
            Limit::AtMost(value) => format!("≤ {}", of.target(value)),
            Limit::AtLeast(value) => format!("≥ {}", of.target(value)),
        }
    }

    fn verdict(self, measured: Measured) -> Verdict {
        let Measured { low, high } = measured;
        let (always, never) = match self {
            Limit::AtMost(limit) => (high <= limit, low > limit),
            Limit::AtLeast(limit) => (low >= limit, high < limit),
        };
        match (always, never) {
            (true, _) => Verdict::Met,
            (_, true) => Verdict::Missed,
            _ => Verdict::Open,
        }
    }
}

impl Verdict {
    fn word(self) -> &'static str {
        match self {
            Verdict::Met => "yes",
            Verdict::Missed => "no",
            Verdict::Open => "open",
            Verdict::Unmeasured => text::DASH,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kit::Content;
    use crate::kit::made_up::{run, trial};

    fn at_most(high: f64) -> Measured {
        Measured { low: f64::NEG_INFINITY, high }
    }

    fn at_least(low: f64) -> Measured {
        Measured { low, high: f64::INFINITY }
    }

    fn means(of: &[(f64, f64)]) -> Vec<Mean> {
        of.iter().map(|(error, ms)| Mean { error: *error, ms: *ms }).collect()
    }

    #[test]
    fn fixed_sampling_of_the_same_error_lies_between_the_measured_ones() {
        let fixed = means(&[(0.04, 10.0), (0.02, 40.0), (0.01, 160.0)]);
        assert_eq!(fixed_ms_at(0.05, &fixed), Some(at_most(10.0)));
        assert_eq!(fixed_ms_at(0.005, &fixed), Some(at_least(160.0)));
        let Some(Measured { low: ms, high }) = fixed_ms_at(0.02 / 2f64.sqrt(), &fixed) else { panic!("between") };
        assert!((ms - 80.0).abs() < 1e-6 && ms == high, "{ms}");
        assert_eq!(fixed_ms_at(0.1, &[]), None);
    }

    #[test]
    fn a_bound_decides_only_where_it_can() {
        use Verdict::{Met, Missed, Open};
        let most = [Measured::exactly(3.0), at_least(2.0), at_least(4.0), at_most(2.0)];
        assert_eq!(most.map(|m| Limit::AtMost(3.0).verdict(m)), [Met, Open, Missed, Met]);
        let least = [Measured::exactly(9.0), at_least(9.0), at_least(10.0), at_most(2.0)];
        assert_eq!(least.map(|m| Limit::AtLeast(10.0).verdict(m)), [Missed, Open, Met, Missed]);
    }

    #[test]
    fn targets_stand_beside_what_was_measured() {
        let runs = |ms| vec![run(FAST, ms, &[]), run(PCSS, 10.0, &[])];
        let scenes = [trial("fence", runs(8.0)), trial("plant", runs(14.0))];
        assert_eq!(TARGETS[0].row(&scenes).verdict, Verdict::Missed);
        let (section, lead) = section(&scenes);
        let [Content::Table(table)] = &section.contents[..] else { panic!("a table") };
        assert_eq!(table.groups[0].rows[0][1..], ["ms ÷ pcss", "2 of 4", "1.1 (0.80–1.4)", "≤ 1", "no"]);
        assert!(table.rows().all(|row| row.len() == table.headings.len()));
        assert!(lead.contains("bunny was not given") && lead.contains("missed: fast ms ÷ pcss (2 of 4)"), "{lead}");
        let (_, lead) = super::section(&[trial("stanford-Bunny", runs(8.0))]);
        assert!(!lead.contains("not given"), "{lead}");
    }
}
