//! Orthonormal sets of columns: what some numbers of a model can do to the force.

use crate::gap::model::fit::dot;

/// Takes what lies along a set off a column.
pub(in crate::gap) fn remove(own: &mut [f64], basis: &[Vec<f64>]) {
    for one in basis {
        let share = dot(own, one);
        own.iter_mut()
            .zip(one)
            .for_each(|(value, b)| *value -= share * b);
    }
}

/// Adds a column to an orthonormal set, if anything of it is new.
pub(in crate::gap) fn extend(set: &mut Vec<Vec<f64>>, mut column: Vec<f64>, basis: &[Vec<f64>]) {
    let before = dot(&column, &column);
    for _ in 0..2 {
        remove(&mut column, basis);
        remove(&mut column, set);
    }
    let size = dot(&column, &column);
    if size.is_finite() && size > 1e-10 * before && size > 0.0 {
        let scale = 1.0 / size.sqrt();
        column.iter_mut().for_each(|value| *value *= scale);
        set.push(column);
    }
}
