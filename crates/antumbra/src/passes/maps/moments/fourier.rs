//! The series of `shaders/fourier.wesl` in double precision.

use std::f64::consts::PI;

/// The series for an occluder `u` of the range of depths behind the receiver: about 1 for u > 0, about 0 for u < 0.
pub fn comparison(terms: u32, u: f64) -> f64 {
    0.5 + (0..terms).map(|k| weight(terms, k) * (span(terms) * odd(k) * u).sin()).sum::<f64>()
}

/// How far the series rises over 0 again where it should be 0, and the error added by rounding of its terms; no more
/// than a fifth, which a series of one or two terms exceeds.
pub fn ripple(terms: u32, rounding: f32) -> f32 {
    // The first minimum lies about half a period of the last term from the step.
    let below = |i: i32| comparison(terms, -f64::from(i) / 4096.0);
    let first_low = (1..4096).find(|&i| below(i + 1) > below(i)).unwrap_or(4096);
    let highest = (first_low..=4096).map(below).fold(0.0, f64::max);
    let rounded: f64 = (0..terms).map(|k| 2.0 * weight(terms, k) * f64::from(rounding)).sum();
    (highest + rounded).min(0.2) as f32
}

/// The part of half a period that depths take.
fn span(terms: u32) -> f64 {
    f64::from(terms) / f64::from(terms + 1)
}

fn odd(term: u32) -> f64 {
    PI * f64::from(2 * term + 1)
}

/// 2 / c_k, damped as Lanczos does.
fn weight(terms: u32, term: u32) -> f64 {
    let at = odd(term) / f64::from(2 * terms);
    2.0 / odd(term) * at.sin() / at
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_series_is_a_step_but_for_its_ripple() {
        for terms in 1..=16 {
            let ripple = f64::from(ripple(terms, 0.0));
            let far = 1.0 / f64::from(terms);
            let umbra = (0..=100).map(|i| -far - (1.0 - far) * f64::from(i) / 100.0).map(|u| comparison(terms, u));
            let highest = umbra.fold(f64::MIN, f64::max);
            println!("{terms} terms: ripple {ripple:.5}, highest in the umbra {highest:.5}");
            assert!((comparison(terms, 0.0) - 0.5).abs() < 1e-12);
            assert!(terms < 3 || highest <= ripple + 1e-7, "{terms} terms: {highest} over a ripple of {ripple}");
            assert!(terms < 4 || ripple < 0.02, "{terms} terms: {ripple}");
        }
    }
}
