//! Curves over logarithmic axes.

use super::axes::{self, Axis, RIGHT, Titles};
use maud::{Markup, html};

/// Room around the curves.
const ROOM: f64 = 0.05;
/// Width of a label's letter.
const LETTER: f64 = 7.8;
/// Number of colours in the style sheet.
pub const COLORS: usize = 8;

/// A plot of curves.
pub struct Lines {
    /// Title of the horizontal axis.
    pub x: String,
    /// Title of the vertical axis.
    pub y: String,
    /// Whether lower left is better.
    pub less_is_better: bool,
    /// Curves in the order of the legend.
    pub curves: Vec<Curve>,
    /// Straight lines to compare slopes with: label and exponent of y ~ x^exponent.
    pub guides: Vec<(&'static str, f64)>,
}

/// Points joined in their order.
pub struct Curve {
    /// Name in the legend.
    pub label: String,
    /// Index of a colour of the style sheet, modulo [`COLORS`].
    pub color: usize,
    /// Whether the line is dashed, to distinguish a group of curves.
    pub dashed: bool,
    /// The points.
    pub points: Vec<Point>,
}

/// A point of a curve.
pub struct Point {
    /// Horizontal value.
    pub x: f64,
    /// Vertical value.
    pub y: f64,
    /// Tooltip.
    pub note: String,
}

impl Point {
    /// A point with its tooltip.
    pub fn new(x: f64, y: f64, note: String) -> Point {
        Point { x, y, note }
    }
}

impl Curve {
    /// A solid curve.
    pub fn new(label: impl Into<String>, color: usize, points: impl IntoIterator<Item = Point>) -> Curve {
        Curve { label: label.into(), color, dashed: false, points: points.into_iter().collect() }
    }

    /// The same curve, dashed if `dashed`.
    pub fn dashed(self, dashed: bool) -> Curve {
        Curve { dashed, ..self }
    }
}

impl Lines {
    /// A plot without guides.
    pub fn new(x: impl Into<String>, y: impl Into<String>, curves: impl IntoIterator<Item = Curve>) -> Lines {
        let curves = curves.into_iter().collect();
        Lines { x: x.into(), y: y.into(), less_is_better: false, curves, guides: Vec::new() }
    }

    /// Adds guides.
    pub fn guides(self, guides: &[(&'static str, f64)]) -> Lines {
        Lines { guides: guides.to_vec(), ..self }
    }

    /// Marks the lower left as better.
    pub fn less_is_better(self) -> Lines {
        Lines { less_is_better: true, ..self }
    }

    fn points(&self) -> impl Iterator<Item = &Point> {
        self.curves.iter().flat_map(|c| &c.points)
    }

    /// Origin of the guides: the smallest x and the largest y there.
    fn corner(&self) -> Option<(f64, f64)> {
        let x = self.points().map(|p| p.x).min_by(f64::total_cmp)?;
        let y = self.points().filter(|p| p.x <= x).map(|p| p.y).max_by(f64::total_cmp)?;
        (x > 0.0 && y > 0.0).then_some((x, y))
    }
}

/// The plot with its legend.
pub fn plot(lines: &Lines) -> Markup {
    let x = Axis::across(lines.points().map(|p| p.x), ROOM);
    let y = Axis::upwards(lines.points().map(|p| p.y), ROOM);
    let titles = Titles { x: &lines.x, y: &lines.y, less_is_better: lines.less_is_better };
    let key = |curve: &Curve| {
        html! {
            polyline class=(class(curve)) points="1,6 33,6" {}
            circle class=(class(curve)) cx="17" cy="6" r="3.5" {}
        }
    };
    let legend: Vec<_> = lines.curves.iter().map(|curve| (key(curve), curve.label.as_str())).collect();
    let content = html! {
        @if let Some(corner) = lines.corner() {
            @for guide in &lines.guides { (guide_line(*guide, corner, &x, &y)) }
        }
        @for curve in &lines.curves { (curve_line(curve, &x, &y)) }
    };
    let label = format!("{} against {}, both logarithmic", lines.y, lines.x);
    axes::plot([&x, &y], &titles, &label, &legend, content)
}

fn class(curve: &Curve) -> String {
    let dashed = if curve.dashed { " dashed" } else { "" };
    format!("curve c{}{dashed}", curve.color % COLORS)
}

fn curve_line(curve: &Curve, x: &Axis, y: &Axis) -> Markup {
    let position = |p: &Point| (x.position(p.x), y.position(p.y));
    let path: Vec<String> = curve.points.iter().map(position).map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
    html! {
        polyline class=(class(curve)) points=(path.join(" ")) {}
        @for point in &curve.points {
            @let (cx, cy) = position(point);
            circle class=(class(curve)) cx=(format!("{cx:.1}")) cy=(format!("{cy:.1}")) r="3.5" {
                title { (point.note) }
            }
        }
    }
}

/// A straight line from the corner to the plot's border, with its label at its end.
fn guide_line((label, exponent): (&str, f64), (x0, y0): (f64, f64), x: &Axis, y: &Axis) -> Markup {
    const STEPS: i32 = 200;
    let at = |i: i32| 10f64.powf(f64::from(i) / 40.0);
    let line = (0..STEPS).map(|i| (x0 * at(i), y0 * at(i).powf(exponent)));
    let seen: Vec<_> = line.take_while(|(px, py)| x.contains(*px) && y.contains(*py)).collect();
    let end = seen.last().copied().unwrap_or((x0, y0));
    let ((sx, sy), (ex, ey)) = ((x.position(x0), y.position(y0)), (x.position(end.0), y.position(end.1)));
    // The label ends where the line does, high enough for the line to pass below its first letter.
    let slope = (ey - sy) / (ex - sx).max(1.0);
    let above = 4.0 + slope.max(0.0) * label.chars().count() as f64 * LETTER;
    html! {
        line.guide x1=(format!("{sx:.1}")) y1=(format!("{sy:.1}")) x2=(format!("{ex:.1}")) y2=(format!("{ey:.1}")) {}
        text.label x=(format!("{:.1}", ex.min(RIGHT))) y=(format!("{:.1}", ey - above)) text-anchor="end" { (label) }
    }
}

#[cfg(test)]
mod tests {
    use super::super::axes::HEIGHT;
    use super::*;

    fn curve(label: &str, points: &[(f64, f64)]) -> Curve {
        Curve::new(label, 9, points.iter().map(|(x, y)| Point::new(*x, *y, format!("{x} < {y}")))).dashed(true)
    }

    fn lines(curves: Vec<Curve>) -> Lines {
        Lines::new("samples", "RMSE", curves).guides(&[("n^-1/2", -0.5)])
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
