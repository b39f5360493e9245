//! Inverses of curvatures.

use crate::dense;
use crate::gap::model::fit::Fit;

/// Which free numbers stand at a bound.
pub(in crate::gap) fn stuck(fit: &Fit) -> Vec<bool> {
    let each = fit.shape.free.iter().zip(&fit.numbers);
    each.map(|(free, number)| free.is_at_bound(*number))
        .collect()
}

/// The inverse in units of the columns' sizes, numbers at a bound left out.
pub(in crate::gap) fn inverse(curvature: &[f64], stuck: &[bool], n: usize) -> Option<Vec<f64>> {
    let out = |at: usize| stuck[at] || curvature[at * n + at] <= 0.0;
    let size: Vec<f64> = (0..n)
        .map(|i| curvature[i * n + i].max(f64::MIN_POSITIVE).sqrt())
        .collect();
    let mut scaled: Vec<f64> = (0..n * n)
        .map(|at| match (at / n, at % n) {
            (row, column) if row == column => 1.0 + 1e-12,
            (row, column) if out(row) || out(column) => 0.0,
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
    for (at, own) in inverse.iter_mut().enumerate() {
        *own /= size[at / n] * size[at % n];
    }
    Some(inverse)
}
