//! Logarithmic axes, drawn by hand so that their colours follow the page's scheme; a plotting library's SVG does not.

use maud::{Markup, html};

/// Size of a plot, in the units of its view box.
pub const WIDTH: f64 = 960.0;
pub const HEIGHT: f64 = 460.0;
/// The area between the axes.
pub const LEFT: f64 = 72.0;
pub const RIGHT: f64 = WIDTH - 28.0;
pub const TOP: f64 = 20.0;
pub const BOTTOM: f64 = HEIGHT - 56.0;
/// Logarithmic position of zero.
const FLOOR: f64 = 1e-5;

/// A logarithmic axis from `low` to `high`, drawn from `start` to `end`.
pub struct Axis {
    low: f64,
    high: f64,
    start: f64,
    end: f64,
}

impl Axis {
    /// A horizontal axis that shows all values and leaves `room`, a fraction of their span, free on each side.
    pub fn across(values: impl Iterator<Item = f64>, room: f64) -> Self {
        Self::around(values, room, LEFT, RIGHT)
    }

    /// The same, vertical.
    pub fn upwards(values: impl Iterator<Item = f64>, room: f64) -> Self {
        Self::around(values, room, BOTTOM, TOP)
    }

    fn around(values: impl Iterator<Item = f64>, room: f64, start: f64, end: f64) -> Self {
        let raised = values.filter(|v| v.is_finite()).map(|v| v.max(FLOOR));
        let (low, high) = raised.fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(v), high.max(v)));
        let (low, high) = if low <= high { (low, high) } else { (FLOOR, 1.0) };
        // At least half a decade in all, or a single value would have no scale.
        let half_a_decade = (10f64.sqrt() * low / high).sqrt();
        let margin = (high / low).max(100.0).powf(room).max(half_a_decade);
        Self { low: low / margin, high: high * margin, start, end }
    }

    /// Position of a value; zero is drawn at the floor.
    pub fn position(&self, value: f64) -> f64 {
        self.at(value.max(FLOOR))
    }

    fn at(&self, value: f64) -> f64 {
        self.start + (value / self.low).ln() / (self.high / self.low).ln() * (self.end - self.start)
    }

    /// Whether a value lies on the axis.
    pub fn contains(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }

    /// Round values: as many mantissas per decade as stay readable.
    fn ticks(&self) -> Vec<f64> {
        let decades = self.low.log10().floor() as i32..=self.high.log10().ceil() as i32;
        let with = |mantissas: &[f64]| -> Vec<f64> {
            let all = decades.clone().flat_map(|d| mantissas.iter().map(move |m| m * 10f64.powi(d)));
            all.filter(|v| self.contains(*v)).collect()
        };
        let choices: [&[f64]; 3] = [&[1.0], &[1.0, 2.0, 5.0], &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0]];
        choices.iter().map(|m| with(m)).find(|ticks| ticks.len() >= 4).unwrap_or_else(|| with(choices[2]))
    }
}

/// Texts at the axes.
pub struct Titles<'a> {
    /// Below.
    pub x: &'a str,
    /// On the left.
    pub y: &'a str,
    /// Whether lower left is better.
    pub less_is_better: bool,
}

/// A whole plot: legend of keys and names, grid, and the curves or points. `label` is its text for screen readers.
pub fn plot(axes: [&Axis; 2], titles: &Titles, label: &str, legend: &[(Markup, &str)], content: Markup) -> Markup {
    html! {
        @if !legend.is_empty() {
            ul.legend {
                @for (key, name) in legend {
                    li { svg.plot.key viewBox="0 0 34 12" aria-hidden="true" { (key) } (name) }
                }
            }
        }
        div.scroll {
            svg.plot viewBox=(format!("0 0 {WIDTH} {HEIGHT}")) role="img" aria-label=(label) {
                (grid(axes, titles))
                (content)
            }
        }
    }
}

/// Lines, numbers and titles.
fn grid([x, y]: [&Axis; 2], titles: &Titles) -> Markup {
    let label = |v: f64| format!("{}", (v * 1e9).round() / 1e9);
    html! {
        @for tick in x.ticks() {
            @let at = format!("{:.1}", x.at(tick));
            line.grid x1=(at) x2=(at) y1=(TOP) y2=(BOTTOM) {}
            text.tick x=(at) y=(BOTTOM + 20.0) text-anchor="middle" { (label(tick)) }
        }
        @for tick in y.ticks() {
            @let at = y.at(tick);
            line.grid x1=(LEFT) x2=(RIGHT) y1=(format!("{at:.1}")) y2=(format!("{at:.1}")) {}
            text.tick x=(LEFT - 10.0) y=(format!("{:.1}", at + 4.0)) text-anchor="end" { (label(tick)) }
        }
        text.axis x=(RIGHT) y=(BOTTOM + 42.0) text-anchor="end" { (titles.x) ", logarithmic →" }
        @if titles.less_is_better { text.axis x=(LEFT) y=(BOTTOM + 42.0) { "↙ better" } }
        text.axis transform=(format!("translate(16 {TOP}) rotate(-90)")) text-anchor="end" {
            (titles.y) ", logarithmic →"
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_few() {
        for (low, high) in [(0.1, 0.13), (0.01, 0.2), (0.3, 900.0), (1e-5, 1.0), (4.0, 4.0), (4.0, 1024.0)] {
            for room in [0.05, 0.12] {
                let axis = Axis::around([low, high].into_iter(), room, 0.0, 1.0);
                let ticks = axis.ticks();
                assert!((2..=12).contains(&ticks.len()), "{low}..{high}: {ticks:?}");
                assert!(ticks.iter().all(|t| (0.0..=1.0).contains(&axis.position(*t))));
            }
        }
    }

    #[test]
    fn nothing_and_zero_have_an_axis() {
        for values in [vec![], vec![0.0], vec![f64::NAN, 2.0], vec![f64::INFINITY]] {
            let axis = Axis::across(values.into_iter(), 0.1);
            assert!(axis.position(1.0).is_finite() && axis.ticks().len() >= 2);
        }
    }
}
