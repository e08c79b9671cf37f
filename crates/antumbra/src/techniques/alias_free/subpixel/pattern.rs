//! Positions of the samples of a pixel: any pattern with one sample in the pixel's middle [Pan 2009, section 3.4].

use crate::error::Error;
use glam::DVec2;

/// Most samples per pixel.
pub const MOST_SAMPLES: usize = 128;

crate::choices! {
    /// A pattern by formula.
    pub enum Arrangement {
        /// The lattice with the largest distance between samples: a rotated grid.
        Rotated = "rotated",
        /// Rows and columns, shifted so that one sample is in the middle.
        Grid = "grid",
    }
}

/// Samples of a pixel, in pixels from its middle, x to the right and y down. The first is in the middle.
#[derive(Clone, Debug, PartialEq)]
pub struct Pattern(Vec<DVec2>);

impl Pattern {
    /// `count` samples by formula. They repeat from pixel to pixel, so that the image is sampled evenly.
    pub fn arranged(arrangement: Arrangement, count: u32) -> Pattern {
        let n = count.clamp(1, MOST_SAMPLES as u32);
        let points = match arrangement {
            Arrangement::Rotated => lattice(n, best_generator(n)),
            Arrangement::Grid => {
                // As square as the number allows, wider than high.
                let rows = (1..=n.isqrt()).rev().find(|r| n.is_multiple_of(*r)).unwrap_or(1);
                let columns = n / rows;
                let at = |k: u32, of: u32| wrapped(f64::from(k) / f64::from(of));
                (0..n).map(|i| DVec2::new(at(i % columns, columns), at(i / columns, rows))).collect()
            }
        };
        Pattern(points)
    }

    /// A custom pattern, in fractions of a pixel from its upper left corner. Errors name the sample and its fault.
    pub fn of_points(points: &[[f32; 2]]) -> Result<Pattern, Error> {
        let refused = |message: String| Err(Error::Pattern { message });
        if points.is_empty() || points.len() > MOST_SAMPLES {
            return refused(format!("it has {} samples; a pixel has 1 to {MOST_SAMPLES}", points.len()));
        }
        if let Some((i, p)) = points.iter().enumerate().find(|(_, p)| !p.iter().all(|v| (0.0..=1.0).contains(v))) {
            return refused(format!("sample {} at {} {} is not in the pixel, from 0 to 1", i + 1, p[0], p[1]));
        }
        let mut centred: Vec<DVec2> = points.iter().map(|p| DVec2::from(p.map(f64::from)) - 0.5).collect();
        match centred.iter().filter(|p| p.length() < 1e-6).count() {
            1 => {}
            0 => return refused("none of its samples is in the pixel's middle, 0.5 0.5".to_owned()),
            several => return refused(format!("{several} of its samples are in the pixel's middle, 0.5 0.5")),
        }
        centred.sort_by_key(|p| p.length() >= 1e-6);
        centred[0] = DVec2::ZERO;
        Ok(Pattern(centred))
    }

    /// The samples.
    pub fn samples(&self) -> &[DVec2] {
        &self.0
    }

    /// Words of 32 bits for one bit per sample: 1, 2 or 4.
    pub fn words(&self) -> usize {
        self.0.len().div_ceil(32).next_power_of_two()
    }
}

/// From [0, 1) to the same position of a pixel whose middle is 0.
fn wrapped(v: f64) -> f64 {
    let v = v.fract();
    if v < 0.5 { v } else { v - 1.0 }
}

/// A lattice of rank 1 with its first point in the middle.
fn lattice(n: u32, generator: u32) -> Vec<DVec2> {
    let at = |k: u32| wrapped(f64::from(k % n) / f64::from(n));
    (0..n).map(|i| DVec2::new(at(i), at(i * generator))).collect()
}

/// The generator whose lattice has the largest distance between samples, also across the pixel's border.
fn best_generator(n: u32) -> u32 {
    let closest = |g: u32| {
        let points = lattice(n, g);
        points.iter().skip(1).map(|p| p.length_squared()).fold(f64::INFINITY, f64::min)
    };
    (1..n).fold((1, 0.0), |best, g| if closest(g) > best.1 + 1e-9 { (g, closest(g)) } else { best }).0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pattern_starts_in_the_middle_and_covers_the_pixel_evenly() {
        for arrangement in [Arrangement::Rotated, Arrangement::Grid] {
            for n in [1, 6, 8, 16, 32, 64, 128] {
                let pattern = Pattern::arranged(arrangement, n);
                let samples = pattern.samples();
                assert_eq!((samples.len(), samples[0]), (n as usize, DVec2::ZERO), "{arrangement:?} of {n}");
                assert!(samples.iter().all(|p| p.min_element() >= -0.5 && p.max_element() < 0.5));
                // A line through the torus leaves out no wider strip than a grid would.
                let apart = |a: DVec2, b: DVec2| {
                    let d = (a - b).abs();
                    d.min(1.0 - d).length()
                };
                let pairs = samples.iter().enumerate().flat_map(|(i, a)| samples[..i].iter().map(|b| apart(*a, *b)));
                let closest = pairs.fold(1.0, f64::min);
                // No arrangement of discs in a plane is closer than a hexagonal one.
                let widest = (2.0 / (3f64.sqrt() * f64::from(n))).sqrt();
                let least = if arrangement == Arrangement::Grid { 0.6 } else { 0.8 };
                assert!(n == 1 || closest > least * widest, "{arrangement:?} of {n}: {closest} of {widest}");
            }
        }
    }

    #[test]
    fn patterns_of_ones_own_need_one_sample_in_the_middle() {
        let made = Pattern::of_points(&[[0.1, 0.2], [0.5, 0.5], [1.0, 0.0]]).expect("is one");
        assert_eq!(made.samples()[0], DVec2::ZERO);
        assert_eq!((made.samples().len(), made.words()), (3, 1));
        for (points, words) in [
            (vec![], "0 samples"),
            (vec![[0.5, 0.5]; 129], "129 samples"),
            (vec![[0.5, 0.5], [0.5, 1.5]], "sample 2 at 0.5 1.5"),
            (vec![[0.5, 0.25]], "none of its samples"),
            (vec![[0.5, 0.5], [0.5, 0.5]], "2 of its samples"),
            (vec![[f32::NAN, 0.5]], "sample 1"),
        ] {
            let error = Pattern::of_points(&points).expect_err("must be refused").to_string();
            assert!(error.contains(words), "{error} does not say {words}");
        }
    }
}
