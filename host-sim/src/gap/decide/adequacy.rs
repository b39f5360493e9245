//! Whether what a fit leaves is noise.
//!
//! A fit to two thirds of a log predicts the last third, and must be off there by no more than what noise and the
//! errors of the motion allow. Where it is off by more though a fit to the whole log is at the floor, the numbers' own
//! errors count as well: the encoder's error is one number in a hold, and where ten numbers hang on five holds two thirds
//! of them predict the last one badly. An exponent, a set and a slow relaxation that were all there were off by 1.3 times
//! what is allowed in the held-out parts, and at 0.98 in all.

use super::held_out::{trained, training_weights};
use super::prediction::prediction_variance;
use crate::gap::model::{dataset::Dataset, fit::Fit, problem::Problem};
use crate::gap::noise::floor::NoiseFloor;
use crate::gap::thresholds::Thresholds;

/// Whether a fit explains the logs, with the residuals over what is allowed on held-out parts.
pub(super) fn is_explained(
    dataset: &Dataset<'_>,
    all: &Problem<'_>,
    best: &Fit,
    ratio: f64,
    held_out: &[bool],
) -> bool {
    let thresholds = dataset.thresholds;
    let limit = allowance(dataset.floors, thresholds) * thresholds.explained.residuals;
    let used = all.weights.iter().filter(|weight| **weight > 0.0).count();
    let freedom = used.saturating_sub(best.numbers.len()) as f64;
    let is_at_floor = best.cost <= limit.powi(2) * freedom;
    ratio <= limit
        || is_at_floor && ratio <= limit * errors_of_numbers(dataset, all, best, held_out)
}

/// How many times as large residuals on held-out parts are because of the errors of the numbers.
fn errors_of_numbers(
    dataset: &Dataset<'_>,
    all: &Problem<'_>,
    best: &Fit,
    held_out: &[bool],
) -> f64 {
    let training = training_weights(all, held_out);
    let training = dataset.problem(&training);
    let each = dataset.floors.iter().map(|floor| floor.correlation);
    let correlation = each.fold(1.0, f64::max);
    let trained = trained(&training, best);
    let variance = prediction_variance(&training, all, &trained, held_out, correlation);
    let each = all.weights.iter().zip(held_out);
    let count = each.filter(|(weight, out)| **out && **weight > 0.0).count();
    (1.0 + variance / count.max(1) as f64).sqrt()
}

/// The factor by which residuals may be larger because of what the noise floors do not know.
fn allowance(floors: &[NoiseFloor], thresholds: &Thresholds) -> f64 {
    let (least, sigmas) = (thresholds.explained.coloured, thresholds.floor.sigmas);
    // Hum in a band is no effect of the catalogue, and no line either: the lines that rest shows may
    // stay, once a periodic disturbance has not taken them.
    let with_lines = |floor: &NoiseFloor| {
        let share = floor.lines_n / floor.used_n.max(f64::MIN_POSITIVE);
        1.0 + share.powi(2).min(1.0)
    };
    let lines = floors.iter().map(with_lines).fold(1.0, f64::max).sqrt();
    let unknown = |floor: &NoiseFloor| match floor.coloured {
        true => least.max(1.0 + sigmas * floor.uncertainty),
        false => floor.unseen,
    };
    lines * floors.iter().map(unknown).fold(1.0, f64::max)
}
