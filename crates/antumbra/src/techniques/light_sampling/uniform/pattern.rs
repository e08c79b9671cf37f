//! Positions of the samples on the light, and their weights.

use crate::error::SpecError;
use glam::{DVec2, Vec2};

crate::choices! {
    /// How samples are spread.
    pub enum Pattern {
        /// A grid whose outer samples lie on the light's border.
        Regular = "regular",
        /// One sample at a random place in each cell of a grid.
        Stratified = "stratified",
        /// A sequence that fills the light evenly at any number of samples.
        LowDiscrepancy = "low-discrepancy",
    }
}

crate::choices! {
    /// Weights of the samples of a grid or quadtree.
    pub enum Weights {
        /// The part of the light that lies around a sample: half on the border, a quarter in the corners.
        Area = "area",
        /// All the same on a grid, less the finer it was refined in a quadtree [Schwärzler 2009, eq. 5 and 6].
        Paper = "paper",
    }
}

/// A place on the light in [-1/2, 1/2]² and its weight; the weights of a list add up to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Along the light's edges.
    pub place: Vec2,
    /// Part of the sum.
    pub weight: f32,
}

/// `count` samples of a light of `size` metres. A light without a height is sampled along its width and the other way
/// round; one sample is the light's centre.
pub fn samples(pattern: Pattern, weights: Weights, count: u32, size: Vec2) -> Result<Vec<Sample>, SpecError> {
    let extended = [size.x > 0.0, size.y > 0.0];
    if count == 1 || extended == [false, false] {
        return Ok(vec![Sample { place: Vec2::ZERO, weight: 1.0 }]);
    }
    if pattern == Pattern::LowDiscrepancy {
        return Ok(equal((0..count).map(|i| low_discrepancy(i, count, extended))));
    }
    let sides = grid_sides(pattern, count, size, extended)?;
    Ok(match pattern {
        Pattern::Regular => grid(sides, weights),
        _ => equal(stratified(sides)),
    })
}

/// Columns and rows of a grid of `count` samples whose steps along both edges are as alike as they can be.
fn grid_sides(pattern: Pattern, count: u32, size: Vec2, extended: [bool; 2]) -> Result<[u32; 2], SpecError> {
    match extended {
        [true, false] => return Ok([count, 1]),
        [false, true] => return Ok([1, count]),
        _ => {}
    }
    let stretch = |n: u32, [a, b]: [u32; 2]| {
        debug_assert_eq!(n, a * b);
        ((f64::from(a) / f64::from(b)) / f64::from(size.x / size.y)).ln().abs()
    };
    let best = |n: u32| {
        let divisors = (1..=n).filter(move |a| n.is_multiple_of(*a)).map(move |a| [a, n / a]);
        divisors.min_by(|a, b| stretch(n, *a).total_cmp(&stretch(n, *b))).unwrap_or([n, 1])
    };
    // Steps more than four times as long one way as the other are no grid of the light; a grid has two lines each way.
    let fair =
        |n: u32| stretch(n, best(n)) <= 4f64.ln() && (pattern != Pattern::Regular || best(n)[0].min(best(n)[1]) > 1);
    if fair(count) {
        return Ok(best(count));
    }
    let near: Vec<String> = [(1..count).rev().find(|n| fair(*n)), (count..=2 * count + 64).find(|n| fair(*n))]
        .iter()
        .flatten()
        .map(|n| format!("{n} ({} x {})", best(*n)[0], best(*n)[1]))
        .collect();
    Err(SpecError::Value {
        technique: "uniform-sampling".to_owned(),
        key: "samples".to_owned(),
        value: count.to_string(),
        expected: format!(
            "makes no even grid on a light of {} m x {} m; {} do, and pattern=low-discrepancy takes any number",
            size.x,
            size.y,
            near.join(" and ")
        ),
    })
}

/// The same weight for all.
fn equal(places: impl Iterator<Item = DVec2>) -> Vec<Sample> {
    let places: Vec<DVec2> = places.collect();
    let weight = (1.0 / places.len() as f64) as f32;
    places.into_iter().map(|p| Sample { place: p.as_vec2(), weight }).collect()
}

/// Columns by rows from border to border, row by row.
fn grid([columns, rows]: [u32; 2], weights: Weights) -> Vec<Sample> {
    let at = |i: u32, n: u32| if n == 1 { 0.0 } else { f64::from(i) / f64::from(n - 1) - 0.5 };
    let places = (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y)));
    if weights == Weights::Paper {
        return equal(places.map(|(x, y)| DVec2::new(at(x, columns), at(y, rows))));
    }
    // The trapezoid rule.
    let part = |i: u32, n: u32| match n {
        1 => 1.0,
        _ if i == 0 || i == n - 1 => 0.5 / f64::from(n - 1),
        _ => 1.0 / f64::from(n - 1),
    };
    let sample = |(x, y)| Sample {
        place: DVec2::new(at(x, columns), at(y, rows)).as_vec2(),
        weight: (part(x, columns) * part(y, rows)) as f32,
    };
    places.map(sample).collect()
}

/// One place in each cell of a grid; the same places every time.
fn stratified([columns, rows]: [u32; 2]) -> impl Iterator<Item = DVec2> {
    let cells = (0..rows).flat_map(move |y| (0..columns).map(move |x| (x, y)));
    cells.map(move |(x, y)| {
        let inside = |i: u32, n: u32, seed: u32| match n {
            1 if columns * rows > 1 => 0.0,
            _ => (f64::from(i) + random((y * columns + x) * 2 + seed)) / f64::from(n) - 0.5,
        };
        DVec2::new(inside(x, columns, 0), inside(y, rows, 1))
    })
}

/// A number in [0, 1) that depends on its seed alone [Jarzynski, Olano 2020: PCG].
fn random(seed: u32) -> f64 {
    let state = seed.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    f64::from((word >> 22) ^ word) / f64::from(u32::MAX) * (1.0 - 1e-9)
}

/// Place `i` of `count`: the Hammersley set, whose every row and column is as even as the whole. The second
/// coordinate's digits are scrambled with the same mask, which takes the set's corner away from the light's corner.
fn low_discrepancy(i: u32, count: u32, extended: [bool; 2]) -> DVec2 {
    let along = (f64::from(i) + 0.5) / f64::from(count) - 0.5;
    match extended {
        [true, true] => {
            let digits = i.reverse_bits() ^ 0x5bd1_e995;
            DVec2::new(along, (f64::from(digits) + 0.5) / 2f64.powi(32) - 0.5)
        }
        [true, false] => DVec2::new(along, 0.0),
        [false, _] => DVec2::new(0.0, along),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Pattern; 3] = [Pattern::Regular, Pattern::Stratified, Pattern::LowDiscrepancy];

    #[test]
    fn weights_add_up_to_one_and_places_lie_on_the_light() {
        for pattern in ALL {
            for weights in [Weights::Area, Weights::Paper] {
                for (count, size) in [(1, Vec2::ONE), (4, Vec2::ONE), (128, Vec2::ONE), (81, Vec2::ONE), (7, Vec2::X)] {
                    let list = samples(pattern, weights, count, size).unwrap();
                    assert_eq!(list.len(), count as usize);
                    let sum: f64 = list.iter().map(|s| f64::from(s.weight)).sum();
                    assert!((sum - 1.0).abs() < 1e-6, "{pattern:?} {weights:?} {count}: {sum}");
                    assert!(list.iter().all(|s| s.place.abs().max_element() <= 0.5 && s.weight > 0.0));
                    assert!(size.y > 0.0 || list.iter().all(|s| s.place.y == 0.0));
                }
            }
        }
    }

    #[test]
    fn the_light_s_mean_is_met_better_by_even_patterns() {
        // The mean of x² y² over the light is 1/144; a regular grid from border to border needs its weights for it.
        let mean = |list: &[Sample]| -> f64 {
            let value = |p: DVec2| (p.x * p.y).powi(2);
            list.iter().map(|s| f64::from(s.weight) * value(s.place.as_dvec2())).sum()
        };
        for pattern in ALL {
            let found = mean(&samples(pattern, Weights::Area, 1024, Vec2::ONE).unwrap());
            assert!((found * 144.0 - 1.0).abs() < 0.02, "{pattern:?}: {found}");
        }
    }

    #[test]
    fn a_number_that_makes_no_grid_is_refused_with_its_neighbours() {
        let error = samples(Pattern::Regular, Weights::Area, 127, Vec2::ONE).unwrap_err().to_string();
        assert!(error.contains("126 (") && error.contains("128 ("), "{error}");
        assert_eq!(grid_sides(Pattern::Regular, 128, Vec2::ONE, [true; 2]).unwrap().iter().product::<u32>(), 128);
        assert_eq!(grid_sides(Pattern::Regular, 64, Vec2::new(4.0, 1.0), [true; 2]).unwrap(), [16, 4]);
    }
}
