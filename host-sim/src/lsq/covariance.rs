//! What the covariances of a fit are made of: the inverse of a curvature, and what correlated terms add up to.

use super::dense;

/// The largest ridge (of a diagonal of ones) that an inverse is taken with.
const MOST_RIDGE: f64 = 1e-3;

/// The square roots of the diagonal of a curvature: the magnitudes of the columns of the Jacobian.
pub(super) fn magnitudes(curvature: &[f64], n: usize) -> Vec<f64> {
    let magnitude = |i: usize| curvature[i * n + i].max(f64::MIN_POSITIVE).sqrt();
    (0..n).map(magnitude).collect()
}

/// The inverse of a curvature with zeros for the numbers that are excluded. It is taken in units of the
/// columns' magnitudes, with `ridge` on the diagonal, and a larger one where the columns are linearly
/// dependent to rounding; `None` if `MOST_RIDGE` does not suffice.
pub(crate) fn inverse(curvature: &[f64], excluded: &[bool], mut ridge: f64) -> Option<Vec<f64>> {
    let n = excluded.len();
    let is_out = |at: usize| excluded[at] || curvature[at * n + at] <= 0.0;
    let size = magnitudes(curvature, n);
    let factor = loop {
        let scaled: Vec<f64> = (0..n * n)
            .map(|at| match (at / n, at % n) {
                (row, column) if row == column => 1.0 + ridge,
                (row, column) if is_out(row) || is_out(column) => 0.0,
                (row, column) => curvature[at] / (size[row] * size[column]),
            })
            .collect();
        match dense::cholesky(&scaled, n) {
            Some(factor) => break factor,
            None if ridge > MOST_RIDGE => return None,
            None => ridge *= 10.0,
        }
    };
    let mut inverse = dense::inverse(&factor, n);
    for (at, entry) in inverse.iter_mut().enumerate() {
        *entry = match (at / n, at % n) {
            (row, column) if excluded[row] || excluded[column] => 0.0,
            (row, column) => *entry / (size[row] * size[column]),
        };
    }
    Some(inverse)
}

/// The covariance of a sum of correlated terms, row by row: Newey and West's Σ κ(l) Σ s(h)s(h−l)ᵀ, where κ is
/// Bartlett's window 1 − l/(lags + 1).
pub(crate) fn newey_west<const N: usize>(scores: &[[f64; N]], lags: usize) -> Vec<f64> {
    let mut sum = vec![0.0; N * N];
    for lag in 0..=lags {
        let window = 1.0 - lag as f64 / (lags + 1) as f64;
        let window = if lag == 0 { 0.5 } else { window };
        for (now, then) in scores.get(lag..).unwrap_or_default().iter().zip(scores) {
            for row in 0..N {
                for column in 0..N {
                    let both = now[row] * then[column] + now[column] * then[row];
                    sum[row * N + column] += window * both;
                }
            }
        }
    }
    sum
}

/// The variance of a sum of correlated terms: Newey and West's sum for one column. It is summed lag by lag and
/// not pair by pair as above, which shows in the last digits of a standard error.
pub(crate) fn long_run_variance(terms: &[f64], lags: usize) -> f64 {
    (0..=lags)
        .map(|lag| {
            let both: f64 = terms.iter().zip(&terms[lag..]).map(|(a, b)| a * b).sum();
            let window = 1.0 - lag as f64 / (lags + 1) as f64;
            if lag == 0 { both } else { 2.0 * window * both }
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_inverse_knows_nothing_of_what_is_excluded() {
        // GIVEN a third number that is excluded, and columns of very different magnitude
        let curvature = [4e8, 2e4, 0.0, 2e4, 5.0, 0.0, 0.0, 0.0, 7.0];
        let found = inverse(&curvature, &[false, false, true], 1e-13).unwrap();
        // THEN the others have the inverse of their own block.
        let determinant = 4e8 * 5.0 - 4e8;
        for (at, exact) in [(0, 5.0), (1, -2e4), (3, -2e4), (4, 4e8)] {
            assert!((found[at] * determinant / exact - 1.0).abs() < 1e-9, "{at}");
        }
        assert!([2, 5, 6, 7, 8].iter().all(|at| found[*at] == 0.0));
    }

    #[test]
    fn a_dependent_column_gets_a_ridge_and_a_curvature_that_is_not_finite_no_inverse() {
        assert!(inverse(&[1.0, 1.0, 1.0, 1.0], &[false; 2], 1e-12).is_some());
        assert!(inverse(&[1.0, f64::NAN, f64::NAN, 1.0], &[false; 2], 1e-12).is_none());
    }

    #[test]
    fn a_variance_is_the_covariance_of_one_column() {
        let terms: Vec<f64> = (0..50).map(|at| f64::from(at * at % 17) - 8.0).collect();
        let scores: Vec<[f64; 1]> = terms.iter().map(|term| [*term]).collect();
        let (one, other) = (long_run_variance(&terms, 4), newey_west(&scores, 4)[0]);
        assert!((one / other - 1.0).abs() < 1e-12, "{one} {other}");
    }
}
