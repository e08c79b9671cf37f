//! `techniques/backprojection/mask.wesl`: the light as a mask of Hammersley's points.

use crate::techniques::backprojection::Bits;
use crate::testing::{Random, Worst, evaluate_variant};
use glam::{DVec2, Vec2};
use proptest::prelude::*;

const ALL_BITS: [(Bits, u32); 5] =
    [(Bits::B64, 64), (Bits::B128, 128), (Bits::B256, 256), (Bits::B512, 512), (Bits::B1024, 1024)];

/// A rectangle; on the light if it lies in [0, 1].
#[derive(Clone, Copy, Debug)]
struct Rect {
    low: Vec2,
    high: Vec2,
}

const LIGHT: Rect = Rect { low: Vec2::ZERO, high: Vec2::ONE };

impl Rect {
    fn new(low: [f32; 2], high: [f32; 2]) -> Rect {
        Rect { low: low.into(), high: high.into() }
    }

    /// From lower to upper corner, whatever the order of the two.
    fn between(a: Vec2, b: Vec2) -> Rect {
        Rect { low: a.min(b), high: a.max(b) }
    }

    fn contains(&self, p: DVec2) -> bool {
        p.cmpge(self.low.as_dvec2()).all() && p.cmplt(self.high.as_dvec2()).all()
    }

    fn on_light(&self) -> Rect {
        Rect { low: self.low.clamp(Vec2::ZERO, Vec2::ONE), high: self.high.clamp(Vec2::ZERO, Vec2::ONE) }
    }

    fn area(&self) -> f64 {
        (self.high.as_dvec2() - self.low.as_dvec2()).max(DVec2::ZERO).element_product()
    }

    /// The two parts of a cut across the x or the y axis, at a share of the edge.
    fn cut(&self, along_y: bool, share: f32) -> [Rect; 2] {
        let at = self.low + (self.high - self.low) * share;
        let (mut first, mut second) = (*self, *self);
        if along_y {
            (first.high.y, second.low.y) = (at.y, at.y);
        } else {
            (first.high.x, second.low.x) = (at.x, at.x);
        }
        [first, second]
    }
}

/// For each column of Hammersley's set of `n` points the row of its point. Column and row i lie at (i + 1/2) / n.
fn rows_of_points(n: u32) -> Vec<u32> {
    (0..n).map(|i| i.reverse_bits() >> (32 - n.trailing_zeros())).collect()
}

/// Hammersley's points by their definition.
fn points(n: u32) -> Vec<DVec2> {
    let place = |i: u32| (f64::from(i) + 0.5) / f64::from(n);
    rows_of_points(n).iter().zip(0..).map(|(y, x)| DVec2::new(place(x), place(*y))).collect()
}

fn covered(points: &[DVec2], rects: &[Rect]) -> u32 {
    points.iter().filter(|p| rects.iter().any(|r| r.contains(**p))).count() as u32
}

/// Area of the union of rectangles on the light: the sum of the cells between all their edges that any of them covers.
fn union_area(rects: &[Rect]) -> f64 {
    let rects: Vec<Rect> = rects.iter().map(Rect::on_light).collect();
    let edges = |axis: usize| {
        let mut all: Vec<f64> = rects.iter().flat_map(|r| [f64::from(r.low[axis]), f64::from(r.high[axis])]).collect();
        all.sort_by(f64::total_cmp);
        all
    };
    let (xs, ys) = (edges(0), edges(1));
    let cell = |x: &[f64], y: &[f64]| {
        let middle = DVec2::new(x[0] + x[1], y[0] + y[1]) / 2.0;
        if rects.iter().any(|r| r.contains(middle)) { (x[1] - x[0]) * (y[1] - y[0]) } else { 0.0 }
    };
    xs.windows(2).map(|x| ys.windows(2).map(|y| cell(x, y)).sum::<f64>()).sum()
}

/// The most by which the share of points in a rectangle differs from its area, over all rectangles of the light: for
/// each pair of columns the row sums with the largest excess, and with the largest lack.
fn worst_rectangle(n: u32) -> f64 {
    let rows = rows_of_points(n);
    let mut worst = 0.0f64;
    for first in 0..rows.len() {
        let mut filled = vec![false; rows.len()];
        for last in first..rows.len() {
            filled[rows[last] as usize] = true;
            // Excess: the rectangle ends at its outermost points.
            let width = (last - first) as f64 / f64::from(n);
            let mut run = 0.0f64;
            for row in &filled {
                // Each row after the first adds 1/n to the height.
                run = (run - width).max(0.0) + f64::from(u8::from(*row));
                worst = worst.max(run);
            }
            // Lack: the rectangle extends to the next points outside of it, or to the light's border, half a step away.
            let step = |inside: bool| if inside { 1.0 } else { 0.5 };
            let width = (width * f64::from(n) + step(first > 0) + step(last + 1 < rows.len())) / f64::from(n);
            let mut run = 0.0f64;
            for (row, is_filled) in filled.iter().enumerate() {
                let before = if row == 0 { 0.5 } else { 1.0 };
                let last = if row + 1 == filled.len() { 0.5 } else { 1.0 };
                run = run.max(width * before) - f64::from(u8::from(*is_filled)) + width * last;
                worst = worst.max(run);
            }
        }
    }
    worst / f64::from(n)
}

/// Bound by theory: four corners, each a box from the origin whose count is off by m/3 + 13/9 points at most [Halton,
/// Zaremba 1969], and by one more for the shift by half a step.
fn granted(n: u32) -> f64 {
    4.0 * (f64::from(n.trailing_zeros()) / 3.0 + 13.0 / 9.0 + 1.0) / f64::from(n)
}

const BOXES: usize = 6;

/// Counts of points that the shader finds under up to [`BOXES`] rectangles each: of each alone, then of all together.
fn counts_on_gpu(bits: Bits, inputs: &[Vec<Rect>]) -> Vec<Vec<f32>> {
    let kernel = format!(
        "import package::techniques::backprojection::mask::{{Mask, cover, covered_points}};
        fn evaluate(at: u32, to: u32) {{
            var all: Mask;
            for (var k = 0u; k < {BOXES}u; k++) {{
                let i = at + 4u * k;
                var one: Mask;
                cover(&one, vec2(input[i], input[i + 1u]), vec2(input[i + 2u], input[i + 3u]));
                cover(&all, vec2(input[i], input[i + 1u]), vec2(input[i + 2u], input[i + 3u]));
                output[to + k] = f32(covered_points(&one));
            }}
            output[to + {BOXES}u] = f32(covered_points(&all));
        }}"
    );
    let numbers = |rects: &Vec<Rect>| {
        let nothing = Rect { low: Vec2::ZERO, high: Vec2::ZERO };
        let padded: Vec<Rect> = rects.iter().copied().chain([nothing; BOXES]).take(BOXES).collect();
        padded.iter().flat_map(|r| [r.low.x, r.low.y, r.high.x, r.high.y]).collect::<Vec<f32>>()
    };
    let input: Vec<f32> = inputs.iter().flat_map(numbers).collect();
    evaluate_variant(&kernel, &[bits.feature()], &input, 4 * BOXES, BOXES + 1)
}

fn random_rect(random: &mut Random, low: f32, high: f32) -> Rect {
    let mut place = || Vec2::new(random.within(low, high), random.within(low, high));
    Rect::between(place(), place())
}

/// Occluding rectangles at two inverse distances, projected from a receiver to the light: some in part beyond it.
fn two_depths(random: &mut Random) -> Vec<Rect> {
    let receiver = Vec2::new(random.within(-0.5, 0.5), random.within(-0.5, 0.5));
    let above = [random.within(0.2, 0.5), random.within(0.6, 1.5)];
    let on_light = |k: usize, random: &mut Random| {
        let r = random_rect(random, -1.0, 1.0);
        let place = |t: Vec2| 0.5 + (t - receiver) / above[k % 2] * 0.5;
        Rect { low: place(r.low), high: place(r.high) }
    };
    (0..BOXES).map(|k| on_light(k, random)).collect()
}

/// Random rectangles, rectangles that touch, that lie on the points' own coordinates, that are nothing or everything.
fn inputs(count: usize, n: u32) -> Vec<Vec<Rect>> {
    let mut random = Random(23);
    let mut input = |i: usize| match i % 4 {
        0 => two_depths(&mut random),
        1 => (0..BOXES).map(|_| random_rect(&mut random, 0.0, 1.0)).collect(),
        2 => {
            let mut parts = vec![LIGHT];
            while parts.len() < BOXES {
                let k = (random.unit() * parts.len() as f32) as usize;
                let part = parts.swap_remove(k);
                parts.extend(part.cut(random.unit() < 0.5, random.unit()));
            }
            parts
        }
        _ => {
            let mut at = || (random.unit() * (2 * n) as f32).floor() / (2 * n) as f32;
            let line = Rect::new([at(), 0.0], [at(), 1.0]);
            let touching = Rect::between(Vec2::new(at(), at()), Vec2::new(at(), at()));
            vec![line, touching, LIGHT, Rect::new([0.5, 0.5], [0.5, 0.9]), Rect::new([-3.0, -2.0], [9.0, 0.0])]
        }
    };
    (0..count).map(&mut input).collect()
}

#[test]
fn the_gpu_covers_the_points_that_lie_in_the_boxes() {
    for (bits, n) in ALL_BITS {
        let (points, inputs) = (points(n), inputs(256, n));
        for (got, rects) in counts_on_gpu(bits, &inputs).iter().zip(&inputs) {
            for (rect, got) in rects.iter().zip(got) {
                assert_eq!(*got as u32, covered(&points, &[*rect]), "{n} points, {rect:?}");
            }
            assert_eq!(got[BOXES] as u32, covered(&points, rects), "{n} points, {rects:?}");
        }
    }
}

#[test]
fn points_of_another_order_are_caught() {
    let (n, inputs) = (256, inputs(256, 256));
    let swapped: Vec<DVec2> = points(n).iter().map(|p| DVec2::new(p.x, 1.0 - p.y)).collect();
    let got = counts_on_gpu(Bits::B256, &inputs);
    let counts = |rects: &[Rect]| rects.iter().map(|r| covered(&swapped, &[*r])).collect::<Vec<u32>>();
    let differs = |got: &[f32], rects: &[Rect]| counts(rects).iter().zip(got).any(|(a, b)| *a != *b as u32);
    let wrong = got.iter().zip(&inputs).filter(|(got, rects)| differs(got, rects)).count();
    assert!(wrong > 100, "{wrong} of 256 inputs differ from points that are mirrored");
}

#[test]
fn no_rectangle_is_off_by_more_than_the_points_allow() {
    for (bits, n) in ALL_BITS {
        let bound = worst_rectangle(n);
        assert!(bound <= granted(n), "{n} points: {bound} is more than the {} that theory grants", granted(n));
        let mut random = Random(5);
        let rects: Vec<Vec<Rect>> = (0..2048).map(|_| vec![random_rect(&mut random, 0.0, 1.0)]).collect();
        let mut worst = Worst::default();
        let mut sum = 0.0;
        for (got, rect) in counts_on_gpu(bits, &rects).iter().zip(&rects) {
            let error = (f64::from(got[0]) / f64::from(n) - rect[0].area()).abs();
            sum += error / rects.len() as f64;
            worst.see(error, || format!("{rect:?}: {} points", got[0]));
        }
        let unit = f64::from(n);
        println!(
            "{n} points: in points, mean error {:.3}, worst {:.2}, bound {:.2}, granted {:.2}, random points {:.2}",
            sum * unit,
            worst.error * unit,
            bound * unit,
            granted(n) * unit,
            unit.sqrt() * 0.4
        );
        assert!(worst.error <= bound, "{n} points: bound {bound}, {worst:?}");
        assert!(sum < 0.1 / unit.sqrt(), "{n} points: mean error {sum}");
    }
}

#[test]
fn areas_are_added_up_where_all_is_summed() {
    let kernel = format!(
        "import package::techniques::backprojection::mask::{{Mask, cover}};
        fn evaluate(at: u32, to: u32) {{
            var mask: Mask;
            for (var k = at; k < at + {}u; k += 4u) {{
                cover(&mask, vec2(input[k], input[k + 1u]), vec2(input[k + 2u], input[k + 3u]));
            }}
            output[to] = f32(mask.area) / 16777216.0;
        }}",
        4 * BOXES
    );
    let mut random = Random(8);
    let rects: Vec<[Rect; BOXES]> =
        (0..512).map(|_| std::array::from_fn(|_| random_rect(&mut random, 0.0, 1.0))).collect();
    let input: Vec<f32> = rects.iter().flatten().flat_map(|r| [r.low.x, r.low.y, r.high.x, r.high.y]).collect();
    for (got, rects) in evaluate_variant(&kernel, &["sum", "bits64"], &input, 4 * BOXES, 1).iter().zip(&rects) {
        let exact: f64 = rects.iter().map(Rect::area).sum();
        assert!((f64::from(got[0]) - exact).abs() < 2e-6, "{} instead of {exact}: {rects:?}", got[0]);
    }
}

fn any_rect() -> impl Strategy<Value = Rect> {
    prop::array::uniform4(0.0f32..=1.0).prop_map(|[a, b, c, d]| Rect::between(Vec2::new(a, b), Vec2::new(c, d)))
}

fn any_count() -> impl Strategy<Value = u32> {
    prop::sample::select(vec![64u32, 128, 256, 512, 1024])
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(1024) })]

    #[test]
    fn one_edge_is_met_to_half_a_point_and_a_strip_to_one(
        n in any_count(), a in 0.0f32..=1.0, b in 0.0f32..=1.0, along_y: bool,
    ) {
        let [below, above] = LIGHT.cut(along_y, a);
        let strip = if a < b { above.cut(along_y, (b - a) / (1.0 - a))[0] } else { below.cut(along_y, b / a.max(1e-6))[1] };
        let points = points(n);
        let off = |r: Rect| (f64::from(covered(&points, &[r])) - r.area() * f64::from(n)).abs();
        prop_assert!(off(below) <= 0.5 + 1e-9 && off(above) <= 0.5 + 1e-9, "{below:?} {}, {above:?} {}", off(below), off(above));
        prop_assert!(off(strip) <= 1.0 + 1e-4, "{strip:?}: {}", off(strip));
    }

    #[test]
    fn a_light_in_parts_has_all_points_once(
        n in any_count(), cuts in prop::collection::vec((any::<prop::sample::Index>(), any::<bool>(), 0.0f32..=1.0), 0..40),
    ) {
        let mut parts = vec![LIGHT];
        for (which, along_y, share) in cuts {
            let part = parts.swap_remove(which.index(parts.len()));
            parts.extend(part.cut(along_y, share));
        }
        let points = points(n);
        let sum: u32 = parts.iter().map(|p| covered(&points, &[*p])).sum();
        prop_assert_eq!((sum, covered(&points, &parts)), (n, n));
    }

    #[test]
    fn the_union_of_boxes_is_their_area(n in any_count(), rects in prop::collection::vec(any_rect(), 1..=BOXES)) {
        let off = (f64::from(covered(&points(n), &rects)) / f64::from(n) - union_area(&rects)).abs();
        // Each box adds a rectangle minus the present ones: two rectangles at most for each of its corners.
        let bound = granted(n) / 4.0 * rects.len() as f64;
        prop_assert!(off <= bound, "off by {} points of {}, bound {}", off * f64::from(n), n, bound * f64::from(n));
    }
}

#[test]
fn unions_at_two_depths_are_right_to_a_fraction_of_what_random_points_give() {
    for (bits, n) in ALL_BITS {
        let mut random = Random(31);
        let inputs: Vec<Vec<Rect>> = (0..1024).map(|_| two_depths(&mut random)).collect();
        let mut worst = Worst::default();
        let (mut sum, mut random_error, mut overlap) = (0.0, 0.0, 0.0);
        for (got, rects) in counts_on_gpu(bits, &inputs).iter().zip(&inputs) {
            let area = union_area(rects);
            let error = (f64::from(got[BOXES]) / f64::from(n) - area).abs();
            worst.see(error, || format!("{rects:?}"));
            sum += error / inputs.len() as f64;
            // Mean of the error's magnitude, if it is normal.
            random_error += 0.8 * (area * (1.0 - area) / f64::from(n)).sqrt() / inputs.len() as f64;
            overlap += (rects.iter().map(|r| r.on_light().area()).sum::<f64>() - area) / inputs.len() as f64;
        }
        let unit = f64::from(n);
        println!(
            "{n} points: in points, mean error {:.3}, worst {:.2}; random points {:.3}; overlap {overlap:.2}",
            sum * unit,
            worst.error * unit,
            random_error * unit
        );
        assert!(overlap > 0.2, "boxes that do not overlap show nothing: {overlap}");
        assert!(sum < 0.4 * random_error && worst.error < granted(n), "{n} points: mean error {sum}, {worst:?}");
    }
}
