//! Least squares with a cubic polynomial.

/// Coefficients of the best cubic, the constant first.
pub fn cubic(points: &[(f64, f64)]) -> [f64; 4] {
    // Normal equations, solved by Gaussian elimination with pivoting.
    let mut rows = [[0.0; 5]; 4];
    for (x, y) in points {
        for (i, row) in rows.iter_mut().enumerate() {
            for (j, cell) in row.iter_mut().enumerate() {
                *cell += x.powi(i as i32) * if j < 4 { x.powi(j as i32) } else { *y };
            }
        }
    }
    for k in 0..4 {
        let pivot = (k..4).max_by(|a, b| rows[*a][k].abs().total_cmp(&rows[*b][k].abs())).expect("there is one");
        rows.swap(k, pivot);
        let own = rows[k];
        for (_, row) in rows.iter_mut().enumerate().filter(|(i, _)| *i != k) {
            let factor = row[k] / own[k];
            row.iter_mut().zip(own).for_each(|(cell, above)| *cell -= factor * above);
        }
    }
    std::array::from_fn(|i| rows[i][4] / rows[i][i])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_a_polynomial_give_it_back() {
        let exact = [0.667, 0.7794, 0.3967, -0.02716];
        let at = |x: f64| exact.iter().rev().fold(0.0, |sum, c| sum * x + c);
        let points: Vec<_> = (0..10).map(|x| (f64::from(x), at(f64::from(x)))).collect();
        assert!(cubic(&points).iter().zip(exact).all(|(a, b)| (a - b).abs() < 1e-9), "{:?}", cubic(&points));
    }
}
