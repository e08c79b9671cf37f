//! What is meant to be reached, beside what is.

use super::super::kit::{Group, Part, Shown, Table};
use super::cost::Costs;
use super::error::AtPaper;
use crate::report::text;

struct Row {
    what: String,
    measured: String,
    target: String,
    met: bool,
}

fn at_most(what: &str, measured: f64, limit: f64) -> Row {
    let (said, target) = (text::figure(measured), format!("at most {limit}"));
    Row { what: what.to_owned(), measured: said, target, met: measured <= limit }
}

/// The table, and what it comes to in a sentence.
pub fn part(errors: &[AtPaper], costs: &Costs) -> (Part, String) {
    let mut rows = Vec::new();
    for e in errors {
        let name = &e.name;
        if e.is_square {
            rows.push(at_most(&format!("{name}: two passes' error less one's"), (e.two - e.one).abs(), 1e-6));
        } else {
            rows.push(at_most(&format!("{name}: error, one pass, 128 x 128, light 0.1"), e.one, 0.04));
            rows.push(at_most(&format!("{name}: error, two passes"), e.two, 0.03));
            rows.push(at_most(&format!("{name}: two passes' error over one's"), e.two / e.one, 1.0));
        }
    }
    rows.push(at_most("milliseconds, 512 x 512 over 128 x 128", costs.large_over_small, 16.0));
    rows.push(at_most("milliseconds, two passes over one, 128 x 128", costs.second_pass, 1.3));
    rows.push(at_most("milliseconds, ours over the CPU's way, 512 x 512", costs.over_cpu, 0.2));
    let met = rows.iter().filter(|r| r.met).count();
    let missed: Vec<&str> = rows.iter().filter(|r| !r.met).map(|r| r.what.as_str()).collect();
    let missed = if missed.is_empty() { String::new() } else { format!("; missed: {}", missed.join(", ")) };
    let lead = format!(
        "{met} of {} targets are met{missed}. With 512 x 512 texels levels take 1/{:.0} of the flat map's time, and \
         their error is {:+.4} off its.",
        rows.len(),
        costs.levels_speed,
        costs.levels_error
    );
    let cells = |r: Row| vec![r.what, r.measured, r.target, if r.met { "yes" } else { "no" }.to_owned()];
    let heads = vec![
        ("what", "What is measured"),
        ("measured", "Here"),
        ("target", "What it is meant to be"),
        ("met", "Whether it is"),
    ];
    let groups = vec![Group { title: String::new(), rows: rows.into_iter().map(cells).collect() }];
    let text =
        "Errors are the paper's: the mean absolute difference to rays in the soft shadow map itself, over shadow and \
                penumbra [Atty 2006, section 5.2.1]."
            .to_owned();
    (Part { title: "Targets".into(), text, shown: vec![Shown::Table(Table { heads, groups })] }, lead)
}
