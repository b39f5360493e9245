//! Held-out parts: a fit to the others predicts them. The states (relaxation, play) run through all windows; only the
//! residuals are left out.

use crate::gap::model::{fit::Fit, problem::Problem};

/// Most steps of the fit to the part that is not held out.
const STEPS: usize = 8;

/// Errors of a fit on the held-out part.
#[derive(Clone, Copy)]
pub(super) struct HeldOutError {
    /// Root mean square of the residuals (N).
    pub(super) rmse_n: f64,
    /// Root mean square of the residuals over what is allowed.
    pub(super) ratio: f64,
}

/// The weights of the samples that are held out, or of the others.
pub(super) fn weights_of(all: &Problem<'_>, held_out: &[bool], is_out: bool) -> Vec<f64> {
    let each = all.weights.iter().zip(held_out);
    each.map(|(weight, out)| if *out == is_out { *weight } else { 0.0 })
        .collect()
}

/// The fit to the part that is not held out.
pub(super) fn trained(training: &Problem<'_>, fit: &Fit) -> Fit {
    training.fit_briefly(&fit.shape, fit.numbers.clone(), STEPS)
}

/// The errors of a fit on the held-out part; `all` is the problem with the weights of all samples.
pub(super) fn held_out_error(all: &Problem<'_>, fit: &Fit, held_out: &[bool]) -> HeldOutError {
    let residuals = all.residuals(&fit.shape, &fit.numbers);
    let measured = all.logs.iter().flat_map(|log| &log.count);
    let (mut squares, mut count, mut weighted, mut used) = (0.0, 0.0, 0.0, 0.0);
    let each = residuals
        .iter()
        .zip(all.weights)
        .zip(held_out)
        .zip(measured);
    for (((residual, weight), out), measured) in each {
        if !out || *measured == 0.0 {
            continue;
        }
        squares += residual * residual;
        count += 1.0;
        if *weight > 0.0 {
            weighted += weight * residual * residual;
            used += 1.0;
        }
    }
    HeldOutError {
        rmse_n: (squares / f64::max(count, 1.0)).sqrt(),
        ratio: (weighted / f64::max(used, 1.0)).sqrt(),
    }
}
