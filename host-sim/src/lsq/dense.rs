//! Small dense symmetric systems: a dozen unknowns, row by row in one slice.

/// The lower Cholesky factor L of a symmetric positive matrix, LLᵀ = A; `None` if it is not positive
/// to rounding.
pub(crate) fn cholesky(matrix: &[f64], n: usize) -> Option<Vec<f64>> {
    let mut factor = vec![0.0; n * n];
    for row in 0..n {
        for column in 0..=row {
            let known: f64 = (0..column)
                .map(|k| factor[row * n + k] * factor[column * n + k])
                .sum();
            let left = matrix[row * n + column] - known;
            factor[row * n + column] = if row == column {
                // A pivot of 1e-14 of its diagonal is rounding.
                if left <= 1e-14 * matrix[row * n + row].abs() || !left.is_finite() {
                    return None;
                }
                left.sqrt()
            } else {
                left / factor[column * n + column]
            };
        }
    }
    Some(factor)
}

/// Solves LLᵀx = b.
pub(crate) fn solve(factor: &[f64], n: usize, right: &[f64]) -> Vec<f64> {
    let mut x = right.to_vec();
    for row in 0..n {
        let known: f64 = (0..row).map(|k| factor[row * n + k] * x[k]).sum();
        x[row] = (x[row] - known) / factor[row * n + row];
    }
    for row in (0..n).rev() {
        let known: f64 = (row + 1..n).map(|k| factor[k * n + row] * x[k]).sum();
        x[row] = (x[row] - known) / factor[row * n + row];
    }
    x
}

/// The inverse from a Cholesky factor.
pub(crate) fn inverse(factor: &[f64], n: usize) -> Vec<f64> {
    let mut inverse = vec![0.0; n * n];
    for column in 0..n {
        let mut unit = vec![0.0; n];
        unit[column] = 1.0;
        for (row, value) in solve(factor, n, &unit).into_iter().enumerate() {
            inverse[row * n + column] = value;
        }
    }
    inverse
}

/// A·B.
pub(crate) fn product(a: &[f64], b: &[f64], n: usize) -> Vec<f64> {
    let entry = |at: usize| (0..n).map(|k| a[at / n * n + k] * b[k * n + at % n]).sum();
    (0..n * n).map(entry).collect()
}

/// gᵀCg.
pub(crate) fn quadratic(matrix: &[f64], gradient: &[f64]) -> f64 {
    let n = gradient.len();
    (0..n)
        .map(|i| {
            let row: f64 = (0..n).map(|j| matrix[i * n + j] * gradient[j]).sum();
            row * gradient[i]
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    const A: [f64; 9] = [4.0, 2.0, 0.6, 2.0, 5.0, -1.0, 0.6, -1.0, 3.0];

    #[test]
    fn a_matrix_times_its_inverse_is_one() {
        let inverse = inverse(&cholesky(&A, 3).unwrap(), 3);
        for (at, value) in product(&A, &inverse, 3).into_iter().enumerate() {
            let unit = f64::from(u8::from(at % 4 == 0));
            assert!((value - unit).abs() < 1e-14, "{at}: {value}");
        }
    }

    #[test]
    fn a_singular_matrix_has_no_factor() {
        assert!(cholesky(&[1.0, 2.0, 2.0, 4.0], 2).is_none());
    }
}
