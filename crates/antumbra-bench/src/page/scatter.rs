//! Error against milliseconds, one point per technique; points may be links and belong to groups.

use super::axes::{self, Axis, BOTTOM, LEFT, TOP, Titles, WIDTH};
use super::{lines::COLORS, text};
use maud::{Markup, html};

/// Width of a label's letter and height of its line, in the units above.
const LETTER: (f64, f64) = (7.8, 16.0);
/// Room beside the points for their labels.
const ROOM: f64 = 0.12;

/// One technique in the plot.
pub struct Point {
    /// Label.
    pub label: String,
    /// Full name for the tooltip.
    pub name: String,
    /// Whether the label is shown even if another point is better in both.
    pub labelled: bool,
    /// Link target.
    pub link: Option<String>,
    /// Index of the group; points without a group have the page's accent colour.
    pub group: Option<usize>,
    /// GPU milliseconds.
    pub ms: f64,
    /// Average error in [0, 1].
    pub error: f64,
}

/// An occupied rectangle: left, top, right, bottom.
#[derive(Clone, Copy)]
struct Area(f64, f64, f64, f64);

impl Area {
    fn overlap(&self, other: &Area) -> f64 {
        let width = self.2.min(other.2) - self.0.max(other.0);
        let height = self.3.min(other.3) - self.1.max(other.1);
        width.max(0.0) * height.max(0.0)
    }

    fn outside(&self) -> f64 {
        let beyond = |v: f64| v.max(0.0);
        beyond(LEFT - self.0) + beyond(self.2 - WIDTH + 8.0) + beyond(TOP - self.1) + beyond(self.3 - BOTTOM)
    }

    /// The nearest point of the rectangle.
    fn nearest(&self, (x, y): (f64, f64)) -> (f64, f64) {
        (x.clamp(self.0, self.2), y.clamp(self.1, self.3))
    }

    fn contains(&self, (x, y): (f64, f64)) -> bool {
        (self.0..self.2).contains(&x) && (self.1..self.3).contains(&y)
    }
}

/// Positions of a label with their costs: to the right of its dot, in other directions, farther away.
fn candidates((x, y): (f64, f64), label: &str) -> impl Iterator<Item = (f64, Area)> {
    let half = (label.chars().count() as f64 * LETTER.0 / 2.0, LETTER.1 / 2.0);
    [11.0, 22.0, 36.0, 54.0, 76.0].into_iter().flat_map(move |distance| {
        (0..16).map(move |i| {
            // Right, left, above, below, then diagonals: the order in which readers look for a label.
            let turn = f64::from([0, 8, 12, 4, 14, 2, 10, 6, 15, 1, 9, 7, 13, 3, 11, 5][i as usize]) / 16.0;
            let (sin, cos) = (turn * std::f64::consts::TAU).sin_cos();
            let cx = x + cos * (distance + cos.abs() * half.0 + sin.abs() * half.1);
            let cy = y + sin * (distance + cos.abs() * half.0.min(12.0) + sin.abs() * half.1);
            let area = Area(cx - half.0, cy - half.1, cx + half.0, cy + half.1);
            (distance + 0.3 * f64::from(i), area)
        })
    })
}

/// Positions of the labels that minimise the overlap of each label and its leader with all others. Several rounds,
/// because the first labels are placed before the last.
fn place_labels(dots: &[(f64, f64)], labels: &[&str]) -> Vec<Area> {
    const ROUNDS: usize = 4;
    let mut taken: Vec<Area> = dots.iter().map(|(x, y)| Area(x - 7.0, y - 7.0, x + 7.0, y + 7.0)).collect();
    let nowhere = Area(f64::MIN, f64::MIN, f64::MIN, f64::MIN);
    taken.resize(2 * dots.len(), nowhere);
    for (i, label) in (0..ROUNDS).flat_map(|_| labels.iter().enumerate()) {
        let own = dots.len() + i;
        let cost = |(distance, area): &(f64, Area)| {
            let (dot, end) = (dots[i], area.nearest(dots[i]));
            let line =
                (1..8).map(|k| f64::from(k) / 8.0).map(|t| (dot.0 + (end.0 - dot.0) * t, dot.1 + (end.1 - dot.1) * t));
            let line: Vec<_> = line.collect();
            let others = taken.iter().enumerate().filter(|(other, _)| *other != own && *other != i);
            let covered = others.map(|(_, other)| {
                5.0 * area.overlap(other) + 60.0 * line.iter().filter(|p| other.contains(**p)).count() as f64
            });
            covered.sum::<f64>() + 5.0 * area.overlap(&taken[i]) + area.outside() * 100.0 + distance
        };
        if let Some((_, area)) = candidates(dots[i], label).min_by(|a, b| cost(a).total_cmp(&cost(b))) {
            taken[own] = area;
        }
    }
    taken.split_off(dots.len())
}

/// Whether no other point is both faster and more accurate.
fn is_best(point: &Point, points: &[Point]) -> bool {
    let beats = |other: &Point| {
        other.ms <= point.ms && other.error <= point.error && (other.ms < point.ms || other.error < point.error)
    };
    !points.iter().any(beats)
}

/// The plot. Points that no other beats in both are filled and joined.
pub fn plot(points: &[Point], groups: &[&str]) -> Markup {
    let x = Axis::across(points.iter().map(|p| p.ms), ROOM);
    let y = Axis::upwards(points.iter().map(|p| p.error), ROOM);
    let dots: Vec<_> = points.iter().map(|p| (x.position(p.ms), y.position(p.error))).collect();
    let best: Vec<bool> = points.iter().map(|p| is_best(p, points)).collect();
    let shown: Vec<bool> = points.iter().zip(&best).map(|(point, best)| point.labelled || *best).collect();
    // Hidden labels take no space.
    let labels: Vec<_> =
        points.iter().zip(&shown).map(|(p, shown)| if *shown { p.label.as_str() } else { "" }).collect();
    let areas = place_labels(&dots, &labels);
    let titles = Titles { x: "GPU milliseconds per frame", y: "average error", less_is_better: true };
    let drawn = |i: usize| {
        let label = shown[i].then(|| label(&points[i], &areas[i]));
        let drawn = html! { (dot(&points[i], dots[i], best[i])) @if let Some(label) = label { (label) } };
        match &points[i].link {
            Some(link) => html! { a href=(link) { (drawn) } },
            None => html! { g { (drawn) } },
        }
    };
    let key = |i: usize| html! { circle class=(format!("dot best {}", color(i))) cx="17" cy="6" r="4" {} };
    let legend: Vec<_> = groups.iter().enumerate().map(|(i, group)| (key(i), *group)).collect();
    let content = html! {
        polyline.front points=(front(&dots, &best)) {}
        @for i in (0..points.len()).filter(|i| shown[*i]) { (leader(dots[i], &areas[i])) }
        @for i in 0..points.len() { (drawn(i)) }
    };
    let label = "Average error against GPU milliseconds, both logarithmic; lower left is better";
    axes::plot([&x, &y], &titles, label, &legend, content)
}

fn color(group: usize) -> String {
    format!("own c{}", group % COLORS)
}

/// The staircase from the fastest to the most accurate point.
fn front(dots: &[(f64, f64)], best: &[bool]) -> String {
    let mut steps: Vec<_> = dots.iter().zip(best).filter(|(_, best)| **best).map(|(dot, _)| *dot).collect();
    steps.sort_by(|a, b| a.0.total_cmp(&b.0).then(b.1.total_cmp(&a.1)));
    let mut path = String::new();
    let mut last: Option<f64> = None;
    for (x, y) in steps {
        if let Some(y) = last {
            path += &format!("{x:.1},{y:.1} ");
        }
        path += &format!("{x:.1},{y:.1} ");
        last = Some(y);
    }
    path
}

/// A line to a distant label.
fn leader((x, y): (f64, f64), area: &Area) -> Markup {
    let (tx, ty) = area.nearest((x, y));
    html! {
        @if (tx - x).hypot(ty - y) > 16.0 {
            line.leader x1=(format!("{x:.1}")) y1=(format!("{y:.1}")) x2=(format!("{tx:.1}")) y2=(format!("{ty:.1}")) {}
        }
    }
}

fn dot(point: &Point, (x, y): (f64, f64), best: bool) -> Markup {
    let best = if best { " best" } else { "" };
    let class = format!("dot{best} {}", point.group.map_or(String::new(), color));
    html! {
        title { (point.name) ": error " (text::metric(point.error)) ", " (text::ms(point.ms)) " ms" }
        circle class=(class.trim_end()) cx=(format!("{x:.1}")) cy=(format!("{y:.1}")) r="6" {}
    }
}

fn label(point: &Point, area: &Area) -> Markup {
    let (cx, cy) = ((area.0 + area.2) / 2.0, (area.1 + area.3) / 2.0);
    html! {
        text.label x=(format!("{cx:.1}")) y=(format!("{:.1}", cy + 4.5)) text-anchor="middle" { (point.label) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(ms: f64, error: f64) -> Point {
        let name = "adaptive-sampling:map=512".into();
        let label = "adaptive-sampling".into();
        Point { label, name, labelled: true, link: Some("#".into()), group: None, ms, error }
    }

    #[test]
    fn labels_of_a_crowd_do_not_cover_each_other() {
        let dots: Vec<_> =
            (0..20).map(|i| (400.0 + f64::from(i % 5) * 40.0, 160.0 + f64::from(i / 5) * 40.0)).collect();
        let areas = place_labels(&dots, &["smooth-pcss"; 20]);
        let covered: f64 =
            (0..20).flat_map(|i| (0..i).map(move |j| (i, j))).map(|(i, j)| areas[i].overlap(&areas[j])).sum();
        assert!(covered < 100.0, "{covered}"); // of 27 456 square units of labels
    }

    #[test]
    fn what_is_beaten_in_both_is_not_the_best() {
        let points = [point(1.0, 0.1), point(2.0, 0.05), point(3.0, 0.07), point(1.0, 0.2)];
        let best: Vec<_> = points.iter().map(|p| is_best(p, &points)).collect();
        assert_eq!(best, [true, true, false, false]);
    }

    #[test]
    fn zero_and_one_point_have_a_place() {
        let svg = plot(&[point(0.0, 0.0)], &[]).into_string();
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }

    #[test]
    fn what_is_beaten_keeps_its_name_for_the_pointer() {
        let mut points = [point(1.0, 0.1), point(2.0, 0.2)];
        for (group, point) in points.iter_mut().enumerate() {
            (point.labelled, point.link, point.group) = (false, None, Some(group));
        }
        let svg = plot(&points, &["ours", "theirs"]).into_string();
        assert_eq!((svg.matches("<title>").count(), svg.matches("class=\"label\"").count()), (2, 1), "{svg}");
        assert!(svg.contains("theirs") && svg.contains("dot own c1") && !svg.contains("href"));
    }
}
