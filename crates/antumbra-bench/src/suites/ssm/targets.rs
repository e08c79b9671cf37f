//! The project's targets beside the measurements.

use super::cost::Costs;
use super::error::AtPaper;
use crate::kit::Section;
use crate::page::text;
use crate::table::{Table, column};

struct Target {
    what: String,
    measured: f64,
    limit: f64,
}

impl Target {
    fn is_met(&self) -> bool {
        self.measured <= self.limit
    }
}

/// The table, and its result in a sentence.
pub fn section(errors: &[AtPaper], costs: &Costs) -> (Section, String) {
    let mut targets = Vec::new();
    let mut at_most = |what: String, measured, limit| targets.push(Target { what, measured, limit });
    for AtPaper { name, is_square, one, two } in errors {
        if *is_square {
            at_most(format!("{name}: two passes' error less one's"), (two - one).abs(), 1e-6);
        } else {
            at_most(format!("{name}: error, one pass, 128 x 128, light 0.1"), *one, 0.04);
            at_most(format!("{name}: error, two passes"), *two, 0.03);
            at_most(format!("{name}: two passes' error over one's"), two / one, 1.0);
        }
    }
    at_most("milliseconds, 512 x 512 over 128 x 128".into(), costs.large_over_small, 16.0);
    at_most("milliseconds, two passes over one, 128 x 128".into(), costs.second_pass, 1.3);
    at_most("milliseconds, ours over the CPU's way, 512 x 512".into(), costs.over_cpu, 0.2);
    let missed: Vec<&str> = targets.iter().filter(|t| !t.is_met()).map(|t| t.what.as_str()).collect();
    let (count, met) = (targets.len(), targets.len() - missed.len());
    let missed = if missed.is_empty() { String::new() } else { format!("; missed: {}", missed.join(", ")) };
    let lead = format!(
        "{met} of {count} targets are met{missed}. With 512 x 512 texels levels take 1/{:.0} of the flat map's time, and \
         their error is {:+.4} off its.",
        costs.levels_speed, costs.levels_error
    );
    let columns = [
        column("what", "The measured quantity", "", |t: &Target| t.what.clone()),
        column("measured", "Here", "", |t: &Target| text::metric(t.measured)),
        column("target", "The limit", "", |t: &Target| format!("at most {}", t.limit)),
        column("met", "Whether it is met", "", |t: &Target| if t.is_met() { "yes" } else { "no" }.to_owned()),
    ];
    let text = "Errors are the paper's: the mean absolute difference to rays in the soft shadow map itself, over shadow \
                and penumbra [Atty 2006, section 5.2.1].";
    (Section::new("Targets", text, vec![Table::new(&columns, "", targets).into()]), lead)
}
