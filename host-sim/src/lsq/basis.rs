//! Orthonormal sets of columns: the changes of the force that some numbers of a model can make.

/// Projects a column off an orthonormal set.
pub(crate) fn project_out(column: &mut [f64], basis: &[Vec<f64>]) {
    for direction in basis {
        let share = dot(column, direction);
        column
            .iter_mut()
            .zip(direction)
            .for_each(|(value, b)| *value -= share * b);
    }
}

/// Adds what is new of a column to an orthonormal set that is orthogonal to `basis`.
pub(crate) fn add_column(set: &mut Vec<Vec<f64>>, mut column: Vec<f64>, basis: &[Vec<f64>]) {
    let before = dot(&column, &column);
    // Twice: the first projection leaves rounding errors of the column's whole magnitude.
    for _ in 0..2 {
        project_out(&mut column, basis);
        project_out(&mut column, set);
    }
    let square = dot(&column, &column);
    if square.is_finite() && square > 1e-10 * before && square > 0.0 {
        let scale = 1.0 / square.sqrt();
        column.iter_mut().for_each(|value| *value *= scale);
        set.push(column);
    }
}

/// Σ aᵢbᵢ, summed in four strands.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let (long, rest) = (a.len() / 4 * 4, a.len().min(b.len()));
    for (x, y) in a[..long].chunks_exact(4).zip(b[..long].chunks_exact(4)) {
        for lane in 0..4 {
            sums[lane] += x[lane] * y[lane];
        }
    }
    let tail: f64 = (long..rest).map(|at| a[at] * b[at]).sum();
    sums.iter().sum::<f64>() + tail
}
