//! Inverses of curvatures.

use crate::dense;
use crate::gap::model::fit::Fit;

/// For each free number, whether it is at a bound.
pub(crate) fn at_bound(fit: &Fit) -> Vec<bool> {
    let each = fit.shape.free.iter().zip(&fit.numbers);
    each.map(|(free, number)| free.is_at_bound(*number))
        .collect()
}

/// The inverse of a curvature without the numbers at a bound. It is taken in units of the columns'
/// magnitudes, with a ridge where they are linearly dependent to rounding; `None` if a ridge of 1e-3
/// does not suffice.
pub(crate) fn inverse(curvature: &[f64], at_bound: &[bool]) -> Option<Vec<f64>> {
    let n = at_bound.len();
    let is_out = |at: usize| at_bound[at] || curvature[at * n + at] <= 0.0;
    let size: Vec<f64> = (0..n)
        .map(|i| curvature[i * n + i].max(f64::MIN_POSITIVE).sqrt())
        .collect();
    let mut scaled: Vec<f64> = (0..n * n)
        .map(|at| match (at / n, at % n) {
            (row, column) if row == column => 1.0 + 1e-12,
            (row, column) if is_out(row) || is_out(column) => 0.0,
            (row, column) => curvature[at] / (size[row] * size[column]),
        })
        .collect();
    let mut ridge = 1e-12;
    let factor = loop {
        match dense::cholesky(&scaled, n) {
            Some(factor) => break factor,
            None if ridge > 1e-3 => return None,
            None => {
                ridge *= 10.0;
                (0..n).for_each(|i| scaled[i * n + i] = 1.0 + ridge);
            }
        }
    };
    let mut inverse = dense::inverse(&factor, n);
    for (at, entry) in inverse.iter_mut().enumerate() {
        *entry /= size[at / n] * size[at % n];
    }
    Some(inverse)
}
