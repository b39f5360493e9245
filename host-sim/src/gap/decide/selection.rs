//! From the result of a search to a decision: rivals that explain more take over, and effects that do
//! not stand up to the evaluation are dropped, until what is left does.

use estimator_core::physics::effect::EffectId;

use super::acceptance::{
    effect_without_size, effects_of_uncertain_form, fit_in_plain_form, fit_with_offset,
    fit_without_harmful_effect, fit_without_idle_effect, is_harmful,
};
use super::decision::Decision;
use super::early::open_where_early;
use super::evaluate::{evaluate, held_out_rmse_n};
use super::rivals::{replacement, result_without};
use super::zero::open_where_zero_drifts;
use crate::gap::finding::{NEARLY_NOISE, Verdict};
use crate::gap::model::{
    attenuation::corrected, dataset::Dataset, error::std_errors, fit::Fit, weights::weights,
};
use crate::gap::search::evidence::Evidence;
use crate::gap::search::{relatives::simpler, run::SearchResult, sets::added_effects};

/// Decides on the result of a search; `evidence` is that for the effects of its best set.
pub(crate) fn decide(
    dataset: &Dataset<'_>,
    base: &Fit,
    mut result: SearchResult,
    evidence: &[Evidence],
) -> Decision {
    // What the best physical set leaves, named or not.
    let mut least_rmse_n = f64::INFINITY;
    let together = dataset.thresholds.evidence.together;
    if result.is_far && result.explained < together {
        // At the log's own rate it would not be nearer: only what stands for itself is evaluated.
        least_rmse_n = held_out_rmse_n(dataset, &result.best);
        let (best, _) = with_strong_effects(dataset, &result.best, evidence);
        result = SearchResult::alone(best);
    }
    let mut evidence = evidence.to_vec();
    loop {
        let (accepted, rest) =
            accepted_decision(dataset, base, result, &evidence, &mut least_rmse_n);
        result = rest;
        let mut decision = with_standard_errors(dataset, accepted);
        if let Some(offset) = fit_with_offset(dataset, &decision) {
            let drift = evidence
                .iter_mut()
                .filter(|own| own.id == EffectId::ForceDrift);
            drift.for_each(|own| own.id = EffectId::ForceOffset);
            result.best = offset;
            continue;
        }
        match effect_without_size(&decision) {
            Some(at) => match fit_in_plain_form(dataset, &decision, at) {
                Some(plain) => result.best = plain,
                None => result = result_without(result, decision.without.swap_remove(at), dataset),
            },
            None => {
                let decision = open_where_form_is_uncertain(decision);
                let decision = open_where_zero_drifts(dataset, decision);
                return open_where_early(dataset, decision);
            }
        }
    }
}

/// A richer form whose size the log hardly knows may as well be the simpler one of its family.
fn open_where_form_is_uncertain(mut decision: Decision) -> Decision {
    for (at, simpler) in effects_of_uncertain_form(&decision) {
        decision.open(at, simpler);
    }
    decision
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

/// Drops and swaps effects until the rest is accepted, and gives what the rest was chosen from.
fn accepted_decision(
    dataset: &Dataset<'_>,
    base: &Fit,
    mut result: SearchResult,
    evidence: &[Evidence],
    least_rmse_n: &mut f64,
) -> (Decision, SearchResult) {
    let mut before_swap = None;
    loop {
        let mut decision = evaluate(dataset, base, &result);
        // At one sample of four a compliance seemed worse than the delay that it is not. There is one
        // swap, so that two fits that get stuck in turn do not swap for ever.
        if before_swap.is_none()
            && let Some(better) = better(dataset, &decision, base, &result)
        {
            before_swap = Some(result.best.clone());
            result.rivals.push(result.best);
            result.best = better;
            continue;
        }
        // An effect that seemed significant on the search's samples may take nothing off at the log's
        // own rate: a delay of 2 µs moved the turn of a play by a sample.
        let idle = fit_without_idle_effect(&decision);
        // Where something remains each effect stands for itself, below.
        let is_small = decision.verdict != Verdict::Unexplained;
        let harmful = || fit_without_harmful_effect(&decision).filter(|_| is_small);
        if let Some(best) = idle.or_else(harmful) {
            result = result_without(result, best.clone(), dataset);
            continue;
        }
        if is_small && is_harmful(&decision) {
            result = SearchResult::alone(base.clone());
            continue;
        }
        *least_rmse_n = least_rmse_n.min(decision.rmse_n.1);
        decision.least_rmse_n = *least_rmse_n;
        decision.evidence = evidence.to_vec();
        if decision.without.is_empty() || decision.verdict != Verdict::Unexplained {
            return (decision, result);
        }
        if explains_nothing(&decision) {
            result = SearchResult::alone(base.clone());
            continue;
        }
        if is_strong_together(&decision) {
            return (named_together(decision), result);
        }
        // Something remains: each effect stands for itself.
        let (best, dropped) = with_strong_effects(dataset, &decision.best, evidence);
        if !dropped {
            decision.verdict = Verdict::PartlyExplained;
            return (decision, result);
        }
        let is_undone = |before: &Fit| is_swap_undone(before, &decision.best, &best);
        let before = before_swap.clone().filter(is_undone);
        result = SearchResult::alone(before.unwrap_or(best));
    }
}

/// A rival that leaves less at the log's own rate, or explains the logs with the richer form of an effect where the simpler
/// one does not: at one sample of four the peak of a friction where it begins to slide was nothing, and at all of them it
/// left 1.7 times the noise.
fn better(
    dataset: &Dataset<'_>,
    decision: &Decision,
    base: &Fit,
    result: &SearchResult,
) -> Option<Fit> {
    if decision.better.is_some() || decision.verdict != Verdict::Unexplained {
        return decision.better.clone();
    }
    let ids = added_effects(&result.best);
    let is_richer = |fit: &&Fit| {
        let others = added_effects(fit);
        let mut each = ids.iter();
        each.any(|id| replacement(&ids, &others, *id).and_then(simpler) == Some(*id))
    };
    let explains = |fit: &&Fit| {
        let alone = SearchResult::alone((*fit).clone());
        evaluate(dataset, base, &alone).verdict != Verdict::Unexplained
    };
    let mut rivals = result.rivals.iter().filter(is_richer);
    rivals.find(explains).cloned()
}

/// The decision with its effects named together; what could stand in the place of one opens it.
fn named_together(mut decision: Decision) -> Decision {
    decision.verdict = Verdict::PartlyExplained;
    if decision.alternatives.iter().any(|own| !own.is_empty()) {
        decision.let_rivals_grade();
    }
    decision
}

/// Whether what a swap brought in has no evidence, so that what it took the place of stands there still. A friction by
/// speed, 6 % better than a delay under a servo's record, was dropped, and the delay with it.
fn is_swap_undone(before: &Fit, swapped: &Fit, left: &Fit) -> bool {
    let known = before.added_ids();
    let newcomers = swapped.added_ids().into_iter();
    let mut newcomers = newcomers.filter(|id| !known.contains(id)).peekable();
    newcomers.peek().is_some() && !newcomers.any(|id| left.added_ids().contains(&id))
}

/// Whether the effects explain nearly all of it together, and each is needed: a spectrum of relaxation, an
/// exponent and a bond take 99 % off under a cantilever, and hardly one of them half. Near the noise a large share is enough
/// for each, and one of them may be open: a weight and a friction left 1.3 times the noise of a lift, 1.5 % of what there was,
/// and beside a remainder that predicts itself a friction, which is slow, takes little off.
fn is_strong_together(decision: &Decision) -> bool {
    let decide = &decision.thresholds.evidence;
    let added = decision.best.added();
    let each = || added.iter().map(|number| decision.evidence_for(*number));
    let is_near = decision.ratio.1 < NEARLY_NOISE;
    let are_large = is_near && each().all(|own| own.is_some_and(|own| own.is_large));
    let are_sound = each().all(|own| own.is_some_and(|own| own.is_strong_group));
    let is_sound = added.len() == 1 || are_sound || are_large;
    let least = match is_sound {
        true => decide.together,
        false => decide.together_unsound,
    };
    let is_unambiguous = decision.alternatives.iter().all(Vec::is_empty);
    let is_clear = is_unambiguous || are_large && decision.clear_names().any(|is_clear| is_clear);
    explained_share(decision) >= least
        && is_clear
        && each().all(|own| own.is_some_and(|own| own.is_needed))
}

/// Whether effects explain no part of what the base leaves: with them the error is larger, whatever its weights say, or
/// hardly smaller.
fn explains_nothing(decision: &Decision) -> bool {
    let share = explained_share(decision).max(explained_of_all(decision));
    decision.rmse_n.1 >= decision.rmse_n.0 || share < decision.thresholds.evidence.explains
}

/// The share of what the base leaves above the noise of the held-out part that effects take off.
fn explained_share(decision: &Decision) -> f64 {
    let (before, after) = decision.ratio;
    taken_off([before, after].map(|ratio| ratio * ratio))
}

/// The same of all samples: what acts at the first touch only may be in no held-out window.
fn explained_of_all(decision: &Decision) -> f64 {
    taken_off([&decision.base, &decision.best].map(|fit| fit.cost / decision.samples()))
}

/// The share of what is above the noise that is gone, of squares before and after as multiples of it.
fn taken_off(squares: [f64; 2]) -> f64 {
    let [before, after] = squares.map(|times| (times - 1.0).max(0.0));
    1.0 - after / before.max(f64::MIN_POSITIVE)
}

/// The best fit with the effects that are named though something remains, and whether others were dropped.
fn with_strong_effects(dataset: &Dataset<'_>, best: &Fit, evidence: &[Evidence]) -> (Fit, bool) {
    let of = |id| evidence.iter().find(|evidence| evidence.id == id);
    let mut terms = best.shape.terms_at(&best.numbers);
    let is_any_strong = terms
        .iter()
        .any(|term| !term.given && of(term.id).is_some_and(|evidence| evidence.is_strong));
    let before = terms.len();
    terms.retain(|term| {
        term.given
            || (is_any_strong
                && of(term.id)
                    .is_some_and(|evidence| evidence.is_strong_group && !evidence.is_faint(term)))
    });
    let dropped = terms.len() < before;
    let (shape, numbers) = best.with_terms(terms, dataset.scales);
    let cost = best.cost;
    let start = Fit {
        shape,
        numbers,
        cost,
    };
    let weights = dataset.weights(&start);
    let problem = dataset.problem(&weights);
    (problem.fit(&start.shape, start.numbers), dropped)
}

#[cfg(test)]
mod tests {
    use super::super::acceptance::tests::decision;
    use super::*;
    use crate::gap::finding::Support;
    use estimator_core::physics::effect::EffectId;

    const IDS: [EffectId; 2] = [EffectId::Adhesion, EffectId::StribeckFriction];

    /// Whether effects that explain so much of ten times the noise are named together, each with evidence of its own or not.
    fn is_together(share: f64, sound: &[bool]) -> bool {
        is_together_of(10.0, share, sound, false)
    }

    /// The same of so many times the noise, where each takes a large share or none does.
    fn is_together_of(before: f64, share: f64, sound: &[bool], is_large: bool) -> bool {
        let mut decision = decision(&vec![0.1; sound.len()], &vec![2e4; sound.len()]);
        let terms = &mut decision.best.shape.terms;
        terms
            .iter_mut()
            .zip(IDS)
            .for_each(|(term, id)| term.id = id);
        let evidence = |(id, is_sound): (EffectId, &bool)| Evidence {
            id,
            support: Support::default(),
            alternatives: Vec::new(),
            is_strong: *is_sound,
            is_strong_group: *is_sound,
            is_large,
            is_needed: true,
            faint_waves: Vec::new(),
        };
        decision.evidence = IDS.into_iter().zip(sound).map(evidence).collect();
        decision.ratio = (
            before,
            (1.0 + (before.powi(2) - 1.0) * (1.0 - share)).sqrt(),
        );
        is_strong_together(&decision)
    }

    #[test]
    fn what_a_swap_took_the_place_of_stands_where_the_newcomer_has_no_evidence() {
        let fit = |ids: &[EffectId]| {
            let mut fit = decision(&vec![0.1; ids.len()], &vec![2e4; ids.len()]).best;
            let terms = fit.shape.terms.iter_mut().zip(ids);
            terms.for_each(|(term, id)| term.id = *id);
            fit
        };
        let (friction, delay, by_speed) = (
            EffectId::CoulombFriction,
            EffectId::TimeDelay,
            EffectId::StribeckFriction,
        );
        let (before, swapped) = (fit(&[friction, delay]), fit(&[friction, by_speed]));
        assert!(is_swap_undone(&before, &swapped, &fit(&[friction])));
        // A newcomer that stays has taken the place, and one that was dropped before may have been another's.
        assert!(!is_swap_undone(&before, &swapped, &fit(&[by_speed])));
        assert!(!is_swap_undone(&before, &before, &fit(&[friction])));
    }

    #[test]
    fn what_is_explained_is_a_share_of_what_is_above_the_noise() {
        // GIVEN 10 000 samples of which the base leaves twice the noise
        let mut decision = decision(&[0.1], &[2e4]);
        decision.ratio = (2.0_f64.sqrt(), 1.4_f64.sqrt());
        decision.best.cost = 1.7e4;
        assert!((explained_share(&decision) - 0.6).abs() < 1e-9);
        assert!((explained_of_all(&decision) - 0.3).abs() < 1e-9);
        // AND no more than all of it.
        decision.best.cost = 0.5e4;
        assert_eq!(explained_of_all(&decision), 1.0);
    }

    #[test]
    fn a_companion_without_evidence_of_its_own_needs_nearly_all_to_be_explained() {
        assert!(is_together(0.96, &[true, true]));
        assert!(!is_together(0.94, &[true, true]));
        // A friction beside an adhesion of no catalogue's form made 97 % of it.
        assert!(!is_together(0.97, &[true, false]));
        assert!(is_together(0.99, &[false, false]));
        // Near the noise a large share of each is enough: 1.4 times of 6 remain, and 1.7 times of 8.
        assert!(is_together_of(6.0, 0.97, &[false, false], true));
        assert!(!is_together_of(6.0, 0.97, &[false, false], false));
        assert!(!is_together_of(8.0, 0.97, &[false, false], true));
        // One effect is not called so for a companion.
        assert!(is_together(0.96, &[false]));
    }
}
