//! Whether what a fit leaves is noise.
//!
//! A fit to two thirds of a log predicts the last third, and must be off there by no more than what noise and the
//! errors of the motion allow. Where it is off by more though a fit to the whole log is at the floor, the numbers' own
//! errors count as well: the encoder's error is one number in a hold, and where ten numbers hang on five holds two thirds
//! of them predict the last one badly. An exponent, a set and a slow relaxation that were all there were off by 1.3 times
//! what is allowed in the held-out parts, and at 0.98 in all.

use super::held_out::{trained, weights_of};
use super::prediction::prediction_variance;
use super::typical::are_no_noise;
use crate::gap::model::{dataset::Dataset, fit::Fit, problem::Problem};
use crate::gap::noise::{floor::NoiseFloor, floors::largest_correlation};
use crate::gap::thresholds::Thresholds;
use crate::stats::{correlation, highest, rms};

/// A sample says something of the noise where that makes this share of what is allowed.
const MOSTLY_NOISE: f64 = 0.8;

/// Whether a fit explains the logs, with the residuals over what is allowed on held-out parts.
pub(super) fn is_explained(
    dataset: &Dataset<'_>,
    all: &Problem<'_>,
    best: &Fit,
    ratio: f64,
    held_out: &[bool],
) -> bool {
    let thresholds = dataset.thresholds;
    let at_rest = || noise_at_rest(dataset, all, best);
    let limit = allowance(dataset.floors, thresholds, at_rest) * thresholds.explained.residuals;
    let freedom = all.used().len().saturating_sub(best.numbers.len()) as f64;
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
    let [weights, predicted] = [false, true].map(|is_out| weights_of(all, held_out, is_out));
    let [training, predicted] = [&weights, &predicted].map(|weights| dataset.problem(weights));
    let correlation = largest_correlation(dataset.floors, dataset.logs, 1);
    let trained = trained(&training, best);
    let variance = prediction_variance(&training, &predicted, &trained, correlation);
    (1.0 + variance / predicted.used().len().max(1) as f64).sqrt()
}

/// How many times what is allowed the residuals are where the probe stands still, at most: what a noise floor does not
/// know is there in a hold as well. A drag that was no drag left 1.7 times what is allowed in motion and 1.1 times in
/// holds, and slow noise with a hum was no excuse. Once, if they are no noise: a hand that pushed on a rig twenty times was
/// the noise of its rests, and so were chirps.
fn noise_at_rest(dataset: &Dataset<'_>, all: &Problem<'_>, best: &Fit) -> f64 {
    let speeds = dataset.logs.iter().flat_map(|log| &log.speed_mps);
    // Where the errors of the motion count as well, less is said of the noise.
    let least = MOSTLY_NOISE * highest(all.weights.iter().copied());
    let residuals = all.residuals(&best.shape, &best.numbers);
    if are_no_noise(&all.white(&residuals), dataset.thresholds) {
        return 1.0;
    }
    let each = residuals.iter().zip(all.weights).zip(speeds);
    let still = each.filter(|((_, weight), speed)| **speed == 0.0 && **weight >= least);
    let still: Vec<f64> = still.map(|((r, weight), _)| r * weight.sqrt()).collect();
    if still.is_empty() {
        return f64::INFINITY;
    }
    let independent = still.len() as f64 / correlation(&still);
    let error = dataset.thresholds.floor.sigmas / (2.0 * independent).sqrt();
    rms(still) * (1.0 + error)
}

/// The factor by which residuals may be larger because of what the noise floors do not know; no more than they are
/// `at_rest`.
fn allowance(floors: &[NoiseFloor], thresholds: &Thresholds, at_rest: impl FnOnce() -> f64) -> f64 {
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
    let most = lines * floors.iter().map(unknown).fold(1.0, f64::max);
    if most > 1.0 {
        most.min(at_rest().max(1.0))
    } else {
        1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn floor(coloured: bool, uncertainty: f64, unseen: f64) -> NoiseFloor {
        NoiseFloor {
            rest_n: Some(1e-3),
            coloured,
            uncertainty,
            unseen,
            ..NoiseFloor::white(1e-3, "")
        }
    }

    #[test]
    fn what_a_floor_does_not_know_is_allowed_as_far_as_holds_show_it() {
        let thresholds = Thresholds::default();
        let allowed =
            |floor: NoiseFloor, at_rest: f64| allowance(&[floor], &thresholds, || at_rest);
        // Slow noise that is known to 10 %, and three times that; in holds it is 1.05 times what was read, or less.
        let slow = || floor(true, 0.1, 1.0);
        assert!((allowed(slow(), f64::INFINITY) - 1.3).abs() < 1e-9);
        assert_eq!((allowed(slow(), 1.05), allowed(slow(), 0.8)), (1.05, 1.0));
        // A rest too short to tell; white noise that is known needs no hold.
        assert_eq!(allowed(floor(false, 0.0, 1.2), f64::INFINITY), 1.2);
        assert_eq!(allowed(floor(false, 0.0, 1.0), 3.0), 1.0);
        // A hum of as much power as the noise adds its own.
        let hum = NoiseFloor {
            lines_n: 1e-3,
            ..floor(false, 0.0, 1.0)
        };
        assert!((allowed(hum.clone(), f64::INFINITY).powi(2) - 2.0).abs() < 1e-9);
        assert_eq!(allowed(hum, 1.1), 1.1);
    }
}
