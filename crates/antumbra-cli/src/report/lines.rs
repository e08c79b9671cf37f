//! Curves over logarithmic axes: what a setting does to a figure.

use maud::{Markup, html};

use super::axes::{Axis, HEIGHT, RIGHT, Titles, WIDTH, grid};

/// Room around the curves.
const ROOM: f64 = 0.05;
/// Width of a label's letter.
const LETTER: f64 = 7.8;
/// As many colours as the style sheet has.
pub const COLORS: usize = 8;

/// A plot of curves.
pub struct Lines {
    /// Below the plot: what goes to the right.
    pub x: String,
    /// Beside the plot: what goes up.
    pub y: String,
    /// Whether the lower left is the best place to be.
    pub less_is_better: bool,
    /// What is drawn, in the order of the legend.
    pub curves: Vec<Curve>,
    /// Straight lines to compare slopes with.
    pub guides: Vec<Guide>,
}

/// Points that belong together, joined in their order.
pub struct Curve {
    /// Name in the legend.
    pub label: String,
    /// Which of the style sheet's colours, below [`COLORS`].
    pub color: usize,
    /// Whether the line is broken, to set a group of curves apart.
    pub dashed: bool,
    /// The points.
    pub points: Vec<Spot>,
}

/// A point of a curve.
pub struct Spot {
    /// Where, to the right.
    pub x: f64,
    /// Where, upwards.
    pub y: f64,
    /// What is told when the pointer rests on it.
    pub note: String,
}

/// The line of a power, y ~ x^exponent.
pub struct Guide {
    /// Its name.
    pub label: String,
    /// The power.
    pub exponent: f64,
}

impl Lines {
    fn spots(&self) -> impl Iterator<Item = &Spot> {
        self.curves.iter().flat_map(|c| &c.points)
    }

    /// Where guides begin: at the first column of points, at the highest of them.
    fn corner(&self) -> Option<(f64, f64)> {
        let x = self.spots().map(|s| s.x).min_by(f64::total_cmp)?;
        let y = self.spots().filter(|s| s.x <= x).map(|s| s.y).max_by(f64::total_cmp)?;
        (x > 0.0 && y > 0.0).then_some((x, y))
    }
}

/// The plot with its legend.
pub fn plot(lines: &Lines) -> Markup {
    let x = Axis::across(lines.spots().map(|s| s.x), ROOM);
    let y = Axis::upwards(lines.spots().map(|s| s.y), ROOM);
    let titles = Titles { x: &lines.x, y: &lines.y, less_is_better: lines.less_is_better };
    html! {
        (legend(&lines.curves))
        div.scroll {
            svg.plot viewBox=(format!("0 0 {WIDTH} {HEIGHT}")) role="img"
                aria-label=(format!("{} against {}, both logarithmic", lines.y, lines.x)) {
                (grid(&x, &y, &titles))
                @if let Some(corner) = lines.corner() {
                    @for guide in &lines.guides { (drawn_guide(guide, corner, &x, &y)) }
                }
                @for curve in &lines.curves { (drawn(curve, &x, &y)) }
            }
        }
    }
}

fn class(curve: &Curve) -> String {
    let dashed = if curve.dashed { " dashed" } else { "" };
    format!("curve c{}{dashed}", curve.color % COLORS)
}

fn legend(curves: &[Curve]) -> Markup {
    html! {
        ul.legend {
            @for curve in curves {
                li {
                    svg.plot.key viewBox="0 0 34 12" aria-hidden="true" {
                        polyline class=(class(curve)) points="1,6 33,6" {}
                        circle class=(class(curve)) cx="17" cy="6" r="3.5" {}
                    }
                    (curve.label)
                }
            }
        }
    }
}

fn drawn(curve: &Curve, x: &Axis, y: &Axis) -> Markup {
    let place = |s: &Spot| (x.place(s.x), y.place(s.y));
    let path: Vec<String> = curve.points.iter().map(place).map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
    html! {
        polyline class=(class(curve)) points=(path.join(" ")) {}
        @for spot in &curve.points {
            @let (cx, cy) = place(spot);
            circle class=(class(curve)) cx=(format!("{cx:.1}")) cy=(format!("{cy:.1}")) r="3.5" {
                title { (spot.note) }
            }
        }
    }
}

/// A straight line from the corner until it leaves the plot, with its name at its end.
fn drawn_guide(guide: &Guide, (x0, y0): (f64, f64), x: &Axis, y: &Axis) -> Markup {
    const STEPS: i32 = 200;
    let at = |i: i32| 10f64.powf(f64::from(i) / 40.0);
    let line = (0..STEPS).map(|i| (x0 * at(i), y0 * at(i).powf(guide.exponent)));
    let seen: Vec<_> = line.take_while(|(px, py)| x.holds(*px) && y.holds(*py)).collect();
    let end = seen.last().copied().unwrap_or((x0, y0));
    let ((sx, sy), (ex, ey)) = ((x.place(x0), y.place(y0)), (x.place(end.0), y.place(end.1)));
    // The name ends where the line does, so high that the line passes below its first letter.
    let slope = (ey - sy) / (ex - sx).max(1.0);
    let above = 4.0 + slope.max(0.0) * guide.label.chars().count() as f64 * LETTER;
    html! {
        line.guide x1=(format!("{sx:.1}")) y1=(format!("{sy:.1}")) x2=(format!("{ex:.1}")) y2=(format!("{ey:.1}")) {}
        text.label x=(format!("{:.1}", ex.min(RIGHT))) y=(format!("{:.1}", ey - above)) text-anchor="end" { (guide.label) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(label: &str, points: &[(f64, f64)]) -> Curve {
        let points = points.iter().map(|(x, y)| Spot { x: *x, y: *y, note: format!("{x} < {y}") }).collect();
        Curve { label: label.into(), color: 9, dashed: true, points }
    }

    fn lines(curves: Vec<Curve>) -> Lines {
        let guides = vec![Guide { label: "n^-1/2".into(), exponent: -0.5 }];
        Lines { x: "samples".into(), y: "RMSE".into(), less_is_better: false, curves, guides }
    }

    /// Numbers of every attribute of this name.
    fn numbers(svg: &str, name: &str) -> Vec<f64> {
        let start = format!(" {name}=\"");
        svg.split(&start).skip(1).filter_map(|rest| rest.split('"').next()?.parse().ok()).collect()
    }

    #[test]
    fn points_stand_in_the_plot_and_tell_what_they_are() {
        let page = plot(&lines(vec![curve("a", &[(4.0, 0.1), (16.0, 0.05), (64.0, 0.02)]), curve("b", &[(4.0, 0.2)])]));
        let page = page.into_string();
        assert_eq!(page.matches("<title>").count(), 4);
        assert!(page.contains("4 &lt; 0.1") && page.contains("curve c1 dashed"));
        assert!(numbers(&page, "cx").iter().all(|x| (0.0..=RIGHT).contains(x)));
        assert!(numbers(&page, "cy").iter().all(|y| (0.0..HEIGHT).contains(y)));
    }

    #[test]
    fn a_guide_has_the_slope_of_its_power() {
        let page = plot(&lines(vec![curve("a", &[(1.0, 1.0), (100.0, 0.1)])])).into_string();
        let guide = &page[page.find("class=\"guide\"").unwrap()..];
        let [x1, y1, x2, y2] = ["x1", "y1", "x2", "y2"].map(|name| numbers(guide, name)[0]);
        let (first, last) = (numbers(&page, "cx"), numbers(&page, "cy"));
        let curve_slope = (last[2] - last[1]) / (first[2] - first[1]); // the legend's circle comes first
        assert!(((y2 - y1) / (x2 - x1) - curve_slope).abs() < 0.01, "{page}");
    }

    #[test]
    fn zeros_and_nothing_are_drawn_without_harm() {
        for curves in [vec![], vec![curve("a", &[])], vec![curve("a", &[(0.0, 0.0), (4.0, 0.0)])]] {
            let page = plot(&lines(curves)).into_string();
            assert!(!page.contains("NaN") && !page.contains("inf"), "{page}");
        }
    }
}
