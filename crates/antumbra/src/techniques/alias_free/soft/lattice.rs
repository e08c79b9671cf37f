//! Points of the light: a lattice with the square of side 1 as a period, so that any place of it puts the same number
//! of points into the square, as far from one another as can be [Korobov 1959]. It lies askew: no two points have the
//! same x or the same y. Seen along its shortest vector it is rows of points at whole numbers, so a triangle hides a
//! run of bits in each row.

use glam::{DMat2, DVec2};

/// Most points of a lattice: near the mask's capacity, and few enough to test a whole cluster within the loop rounds
/// that llvmpipe allows a thread.
pub(crate) const MOST_POINTS: u32 = 480;
/// Most rows, and most points of a row, which are the bits of a word.
pub(crate) const MOST_ROWS: usize = 32;

/// A lattice of `points` points in the square.
#[derive(Clone, Debug)]
pub(crate) struct Lattice {
    /// From one point of a row to the next, and from a row to the next.
    pub basis: DMat2,
}

/// A lattice that is moved: point (i, j) lies at `origin + basis * (i, j)`, and is in the square if bit i of row j is
/// set.
#[derive(Clone, Debug)]
pub(crate) struct Placed {
    pub origin: DVec2,
    pub rows: Vec<u32>,
}

impl Placed {
    /// The points in the square.
    pub fn points(&self, lattice: &Lattice) -> Vec<DVec2> {
        let rows = self.rows.iter().enumerate();
        let set = rows.flat_map(|(j, row)| (0..32).filter(move |i| row >> i & 1 != 0).map(move |i| (i, j)));
        set.map(|(i, j)| self.origin + lattice.basis * DVec2::new(f64::from(i), j as f64)).collect()
    }
}

impl Lattice {
    /// The lattice i (1, g) / points, modulo 1, whose shortest vector is longest among those that fit the mask.
    pub fn new(points: u32) -> Lattice {
        let bases = (1..points.max(2)).filter(|g| coprime(*g, points)).map(|g| reduced(points, g));
        let turned = bases.flat_map(|b| [b, DMat2::from_cols(b.y_axis, b.x_axis)]).filter(fits);
        let shortest = |b: &DMat2| b.x_axis.length_squared().min(b.y_axis.length_squared());
        let longest = turned.reduce(|best, b| if shortest(&b) > shortest(&best) { b } else { best });
        Lattice { basis: longest.expect("at least two points, at most MOST_POINTS") }
    }

    /// The lattice moved by a part of the square's side, its first point in the square having the smallest coordinates.
    pub fn placed(&self, by: DVec2) -> Placed {
        let corners = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE].map(|c| self.basis.inverse() * (c - by));
        let low = corners.iter().fold(DVec2::INFINITY, |m, v| m.min(*v)).ceil();
        let high = corners.iter().fold(DVec2::NEG_INFINITY, |m, v| m.max(*v)).floor();
        let origin = by + self.basis * low;
        let inside = |i: i32, j: i32| {
            let p = origin + self.basis * DVec2::new(f64::from(i), f64::from(j));
            p.cmpge(DVec2::ZERO).all() && p.cmplt(DVec2::ONE).all()
        };
        let size = (high - low).as_ivec2();
        let row = |j| (0..=size.x.min(31)).filter(|&i| inside(i, j)).fold(0, |bits, i| bits | 1u32 << i);
        Placed { origin, rows: (0..=size.y).map(row).collect() }
    }
}

/// True if it has no more rows than the mask wherever it lies, nor longer ones.
fn fits(basis: &DMat2) -> bool {
    let inverse = basis.inverse();
    let extent = inverse.x_axis.abs() + inverse.y_axis.abs();
    (extent + 1e-9).floor().max_element() < MOST_ROWS as f64
}

/// Every point has an x and a y of its own if these have no factor in common.
fn coprime(mut a: u32, mut b: u32) -> bool {
    while b > 0 {
        (a, b) = (b, a % b);
    }
    a == 1
}

/// The shortest two vectors of a lattice [Gauss], the shortest first.
fn reduced(points: u32, g: u32) -> DMat2 {
    let n = f64::from(points);
    let (mut a, mut b) = (DVec2::new(1.0, f64::from(g)) / n, DVec2::Y);
    loop {
        if b.length_squared() < a.length_squared() {
            std::mem::swap(&mut a, &mut b);
        }
        let shorter = b - a * (a.dot(b) / a.length_squared()).round();
        // By more than rounding, or it would go on for ever between two of the same length.
        if shorter.length_squared() > 0.999_999 * b.length_squared() {
            return DMat2::from_cols(a, b);
        }
        b = shorter;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_place_of_a_lattice_has_all_points_in_the_square_and_no_two_in_a_line_with_its_edges() {
        for points in (2..MOST_POINTS).step_by(7).chain([37, 64, 128, 255, 256, MOST_POINTS]) {
            let lattice = Lattice::new(points);
            for k in 0..16 {
                let by = super::super::place_of(k, points);
                let placed = lattice.placed(by);
                assert!(placed.rows.len() <= MOST_ROWS, "{} rows", placed.rows.len());
                let all = placed.points(&lattice);
                assert_eq!(all.len(), points as usize, "moved by {by}");
                for axis in 0..2 {
                    let mut places: Vec<f64> = all.iter().map(|p| p[axis]).collect();
                    places.sort_by(f64::total_cmp);
                    let least = places.windows(2).map(|w| w[1] - w[0]).fold(1.0, f64::min);
                    assert!(least > 0.99 / f64::from(points), "two points in a line: {least}");
                }
            }
        }
    }
}
