//! The evaluation of one set of effects: refits at the log's own rate, held-out errors, rivals, verdict.

use rayon::prelude::*;

use super::adequacy::is_explained;
use super::decision::Decision;
use super::held_out::{HeldOutError, held_out_error, trained, weights_of};
use super::rivals::{Rivals, rivals};
use super::slow::slow_remainder;
use super::windows::held_out;
use crate::gap::finding::Verdict;
use crate::gap::model::{dataset::Dataset, fit::Fit, problem::Problem, weights::weights};
use crate::gap::search::run::SearchResult;
use crate::stats::correlation;

/// Most steps of the fit without an effect.
const STEPS_WITHOUT: usize = 12;

/// Evaluates the effects of a search's result.
pub(super) fn evaluate(dataset: &Dataset<'_>, base: &Fit, result: &SearchResult) -> Decision {
    let variances = dataset.variances(&result.best);
    let weights = weights(&variances);
    let all = dataset.problem(&weights);
    let held_out = held_out(dataset.logs);
    let refit = |fit: &Fit| all.fit(&fit.shape, fit.numbers.clone());
    let (base, best) = rayon::join(|| refit(base), || refit(&result.best));
    let without: Vec<Fit> = best
        .added()
        .par_iter()
        .map(|at| {
            let (shape, start) = best.without(*at, dataset.scales);
            all.fit_briefly(&shape, start, STEPS_WITHOUT)
        })
        .collect();
    let errors = held_out_errors(dataset, &all, &[&base, &best], &without, &held_out);
    let (before, after) = (errors[0], errors[1]);
    let gains = errors[2..]
        .iter()
        .map(|error| 1.0 - (after.rmse_n / error.rmse_n).powi(2))
        .collect();
    let correlation = correlation(&all.white(&all.residuals(&best.shape, &best.numbers)));
    let Rivals {
        alternatives,
        better,
    } = rivals(dataset, &all, &best, result, correlation);
    let is_ambiguous = alternatives.iter().any(|ids| !ids.is_empty());
    let is_small = is_explained(dataset, &all, &best, after.ratio, &held_out);
    let slow = is_small
        .then(|| slow_remainder(dataset, &all, &best))
        .flatten();
    let is_explained = is_small && slow.is_none();
    Decision {
        verdict: verdict(is_explained, !without.is_empty(), is_ambiguous),
        thresholds: *dataset.thresholds,
        alternatives,
        gains,
        there: shares_there(&all, &best, &without, &held_out),
        without,
        rmse_n: (before.rmse_n, after.rmse_n),
        least_rmse_n: after.rmse_n,
        evidence: Vec::new(),
        ratio: (before.ratio, after.ratio),
        slow,
        base,
        best,
        better,
        std_errors: Vec::new(),
        variances,
        held_out,
        correlation,
        is_beside_remainder: false,
        may_be_a_damper: false,
    }
}

/// The held-out errors of fits that are refitted to the rest.
fn held_out_errors(
    dataset: &Dataset<'_>,
    all: &Problem<'_>,
    fits: &[&Fit],
    without: &[Fit],
    held_out: &[bool],
) -> Vec<HeldOutError> {
    let training = weights_of(all, held_out, false);
    let training = dataset.problem(&training);
    let fits: Vec<&Fit> = fits.iter().copied().chain(without).collect();
    fits.into_par_iter()
        .map(|fit| held_out_error(all, &trained(&training, fit), held_out))
        .collect()
}

/// For each fit without an effect, the share of the squares by which its forces differ that is in the held-out part.
fn shares_there(all: &Problem<'_>, best: &Fit, without: &[Fit], held_out: &[bool]) -> Vec<f64> {
    let forces = |fit: &Fit| all.forces(&fit.shape, &fit.numbers);
    let with = forces(best);
    let share = |fit: &Fit| {
        let (mut there, mut whole) = (0.0, f64::MIN_POSITIVE);
        for ((with, without), out) in with.iter().zip(forces(fit)).zip(held_out) {
            let square = (with - without).powi(2);
            whole += square;
            there += if *out { square } else { 0.0 };
        }
        there / whole
    };
    without.par_iter().map(share).collect()
}

/// The held-out error (N) of a fit that is refitted to the rest.
pub(super) fn held_out_rmse_n(dataset: &Dataset<'_>, fit: &Fit) -> f64 {
    let weights = dataset.weights(fit);
    let all = dataset.problem(&weights);
    held_out_errors(dataset, &all, &[fit], &[], &held_out(dataset.logs))[0].rmse_n
}

fn verdict(is_explained: bool, has_effects: bool, is_ambiguous: bool) -> Verdict {
    if !is_explained {
        Verdict::Unexplained
    } else if !has_effects {
        Verdict::NoMissingEffect
    } else if is_ambiguous {
        Verdict::Ambiguous
    } else {
        Verdict::MissingEffects
    }
}
