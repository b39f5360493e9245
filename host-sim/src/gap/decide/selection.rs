//! From the result of a search to a decision: rivals that explain more take over, and effects that do
//! not stand up to the evaluation are dropped, until what is left does.

use super::acceptance::{effect_without_size, fit_without_idle_effect, is_accepted};
use super::decision::Decision;
use super::evaluate::evaluate;
use crate::gap::finding::{Candidate, Verdict};
use crate::gap::model::{
    attenuation::corrected, dataset::Dataset, error::std_errors, fit::Fit, weights::weights,
};
use crate::gap::search::run::SearchResult;

/// Decides on the result of a search; `tried` are the sets of effects that were fitted.
pub(crate) fn decide(
    dataset: &Dataset<'_>,
    base: &Fit,
    mut result: SearchResult,
    tried: &[Candidate],
) -> Decision {
    loop {
        let accepted = accepted_decision(dataset, base, result, tried);
        let mut decision = with_standard_errors(dataset, accepted);
        match effect_without_size(&decision) {
            Some(at) => result = SearchResult::alone(decision.without.swap_remove(at)),
            None => return decision,
        }
    }
}

/// Takes the bias of the motion's errors off the numbers, and finds their standard errors.
fn with_standard_errors(dataset: &Dataset<'_>, decision: Decision) -> Decision {
    let weights = weights(&decision.variances);
    let problem = dataset.problem(&weights);
    let most = decision.thresholds.acceptance.correction_cost;
    let best = corrected(&problem, &decision.best, most);
    Decision {
        std_errors: std_errors(&problem, &best),
        best,
        ..decision
    }
}

/// Drops and swaps effects until the rest is accepted.
fn accepted_decision(
    dataset: &Dataset<'_>,
    base: &Fit,
    mut result: SearchResult,
    tried: &[Candidate],
) -> Decision {
    let mut swapped = false;
    loop {
        let mut decision = evaluate(dataset, base, &result);
        // At one sample of four a compliance seemed worse than the delay that it is not. There is one
        // swap, so that two fits that get stuck in turn do not swap for ever.
        if let Some(better) = decision.better.take().filter(|_| !swapped) {
            result.rivals.push(vec![result.best]);
            result.best = better;
            swapped = true;
            continue;
        }
        // An effect that seemed significant on the search's samples may take nothing off at the log's
        // own rate: a delay of 2 µs moved the turn of a play by a sample.
        if let Some(best) = fit_without_idle_effect(&decision) {
            result.best = best.clone();
            continue;
        }
        if decision.without.is_empty() || decision.verdict != Verdict::Unexplained {
            return decision;
        }
        let is_unambiguous = decision.alternatives.iter().all(Vec::is_empty);
        let is_accepted = is_accepted(&decision, tried);
        if is_accepted && is_unambiguous {
            return decision;
        }
        // Effects that leave much unexplained are not named; of those that explain most, the ones that
        // another effect could replace are not.
        result = SearchResult::alone(if is_accepted {
            without_ambiguous(dataset, &decision)
        } else {
            base.clone()
        });
    }
}

/// The best fit without the effects that others could replace.
fn without_ambiguous(dataset: &Dataset<'_>, decision: &Decision) -> Fit {
    let best = &decision.best;
    let added = best.added();
    let mut terms = best.shape.terms_at(&best.numbers);
    let ambiguous = added.iter().zip(&decision.alternatives).rev();
    for (at, _) in ambiguous.filter(|(_, alternatives)| !alternatives.is_empty()) {
        terms.remove(*at);
    }
    let (shape, start) = best.with_terms(terms, dataset.scales);
    let weights = weights(&decision.variances);
    dataset.problem(&weights).fit(&shape, start)
}
