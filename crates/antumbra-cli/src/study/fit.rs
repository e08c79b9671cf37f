//! The cubic polynomial of log2 that is nearest to points, by least squares.

use glam::{DMat4, DVec4};

/// Coefficients from the constant on. `points` are (n, value); at least four different n.
pub fn cubic(points: &[(f64, f64)]) -> [f64; 4] {
    let powers = |n: f64| {
        let x = n.log2();
        DVec4::new(1.0, x, x * x, x * x * x)
    };
    let (mut normal, mut right) = (DMat4::ZERO, DVec4::ZERO);
    for &(n, value) in points {
        let p = powers(n);
        normal += DMat4::from_cols(p * p.x, p * p.y, p * p.z, p * p.w);
        right += value * p;
    }
    (normal.inverse() * right).to_array()
}

/// The polynomial at n.
pub fn at(c: [f64; 4], n: f64) -> f64 {
    let x = n.log2();
    ((c[3] * x + c[2]) * x + c[1]) * x + c[0]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_is_found_again() {
        let c = [0.667, 0.7794, 0.3967, -0.02716];
        let points: Vec<_> = (0..10).map(|i| f64::from(1 << i)).map(|n| (n, at(c, n))).collect();
        let found = cubic(&points);
        let off = found.iter().zip(&c).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 1e-9, "{found:?}");
    }

    #[test]
    fn a_fit_passes_between_points_that_disagree() {
        let points: Vec<_> = (0..10).flat_map(|i| [(f64::from(1 << i), 1.0), (f64::from(1 << i), 3.0)]).collect();
        let found = cubic(&points);
        assert!((0..10).all(|i| (at(found, f64::from(1 << i)) - 2.0).abs() < 1e-9), "{found:?}");
    }
}
