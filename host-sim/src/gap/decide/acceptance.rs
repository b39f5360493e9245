//! Effects of a decision that take nothing off, or whose size may as well be 0.

use estimator_core::physics::effect::EffectId;

use crate::gap::decide::{decision::Decision, rivals::discriminability_margin};
use crate::gap::model::shape::{Free, Owner, Term};
use crate::gap::model::{
    dataset::Dataset, fit::Fit, start::of_size, start::repeats, weights::weights,
};
use crate::gap::search::{forms::in_plain_form, relatives::is_lateness, relatives::simpler};

/// The fit without the effect that is needed least, if that effect takes nothing off.
pub(crate) fn fit_without_idle_effect(decision: &Decision) -> Option<&Fit> {
    let decide = decision.thresholds;
    let cost = decision.best.cost;
    let most = cost + margin(decision).min(decide.acceptance.idle * cost);
    let without = decision.without.iter();
    without
        .min_by(|a, b| a.cost.total_cmp(&b.cost))
        .filter(|fit| fit.cost < most)
}

/// The fit without the effect that the held-out part speaks against most, if it does: with it that is foretold worse, by
/// much, or at all where the effect acts there as it does elsewhere. On a press at 100 Hz with counts of 5 µm a delay of
/// −3.2 ± 1.0 ms took something off the rest, left a third more of the held-out squares, and was `certain`.
pub(crate) fn fit_without_harmful_effect(decision: &Decision) -> Option<&Fit> {
    let each = decision.without.iter().zip(&decision.gains).enumerate();
    let worst = each.min_by(|(_, (_, a)), (_, (_, b))| a.total_cmp(b));
    let harmful = worst.filter(|(at, _)| decision.is_spoken_against(*at));
    harmful.map(|(_, (fit, _))| fit)
}

/// The difference in Σ w r² within which a fit is not told from the best.
fn margin(decision: &Decision) -> f64 {
    let margin = decision.thresholds.rivalry.margin;
    discriminability_margin(
        &decision.best,
        decision.samples(),
        decision.correlation,
        margin,
    )
}

/// Whether the held-out part is foretold worse with all effects than without any, where each seems to be needed beside
/// the others: two waves, a cable and an encoder's error, all `certain`, left a gel whose friction had doubled 14 % more
/// squares.
pub(crate) fn is_harmful(decision: &Decision) -> bool {
    let (before, after) = decision.rmse_n;
    let gain = 1.0 - (after / before).powi(2);
    !decision.without.is_empty() && gain < -decision.thresholds.acceptance.harm
}

/// The place of an added effect whose size may as well be 0, if nothing else could stand in its place, the held-out part
/// hardly misses it, or nothing had to be explained.
pub(crate) fn effect_without_size(decision: &Decision) -> Option<usize> {
    let decide = &decision.thresholds.acceptance;
    let best = &decision.best;
    let added = best.added();
    let is_known = |at: usize| {
        let number = added[at];
        let sigmas = match best.shape.terms[number].id {
            id if wanders(id) => decide.wander_sigmas,
            id if is_lateness(id) => decide.late_sigmas,
            _ => decide.size_sigmas,
        };
        let sigmas = match decision.gains[at] < decide.missed {
            true => sigmas.max(decide.hardly_missed_sigmas),
            false => sigmas,
        };
        has_size(decision, number, sigmas)
            && has_rate(decision, number, decide.size_sigmas)
            && !is_at_its_end(best, number)
    };
    let is_base_enough = decision.is_noise(decision.ratio.0);
    // Modes of one spectrum share their size, and no name depends on one of them; but one must be known.
    let id_of = |at: usize| best.shape.terms[added[at]].id;
    let is_one_known = |id: EffectId| (0..added.len()).any(|at| id_of(at) == id && is_known(at));
    (0..added.len()).find(|at| {
        let is_missed = decision.gains[*at] > decide.missed;
        let is_open = !is_base_enough && !decision.alternatives[*at].is_empty() && is_missed;
        !is_open && !is_one_known(id_of(*at))
    })
}

/// Whether an effect is what noise looks like in a log: a ramp, or a wave, the best of as many as it can tell.
fn wanders(id: EffectId) -> bool {
    id == EffectId::ForceDrift || repeats(id)
}

/// Whether an effect is a relaxation as fast as one can be, which within a sample is a damper, and the errors of the motion
/// look like one; or an error of the encoder, or a cogging, as long as one can be, which wants to be the form of the law,
/// or a zero; or a change of curves that takes the whole travel, which a material that every touch softens was.
fn is_at_its_end(best: &Fit, number: usize) -> bool {
    let second = Owner::Effect(number, 1);
    let of_its_end = match best.shape.terms[number].id {
        EffectId::StressRelaxation | EffectId::EncoderPeriodicError | EffectId::Cogging => second,
        EffectId::LoadingCurve => Owner::Effect(number, 2),
        _ => return false,
    };
    best.is_at(of_its_end, Free::is_at_highest)
}

/// The places of the added effects that may as well be the simpler effect of their family, with that effect: their
/// form takes off more, but its size is hardly known.
pub(crate) fn effects_of_uncertain_form(decision: &Decision) -> Vec<(usize, EffectId)> {
    let sigmas = decision.thresholds.acceptance.form_sigmas;
    let added = decision.best.added().into_iter().enumerate();
    let simpler = added.filter_map(|(at, number)| {
        let simpler = simpler(decision.best.shape.terms[number].id)?;
        (!has_size(decision, number, sigmas)).then_some((at, simpler))
    });
    simpler.collect()
}

/// The fit with an offset in the place of a drift that comes to rest, if the log does not tell them apart; or if that is as
/// soon as a drift can, and the offset is nearer to the best than to the fit without it: a zero that was 5 N off was a
/// drift of 96 N/s for 50 ms, which left 2 % less.
pub(crate) fn fit_with_offset(dataset: &Dataset<'_>, decision: &Decision) -> Option<Fit> {
    let best = &decision.best;
    let mut terms = best.shape.terms_at(&best.numbers);
    let mut added = best.added().into_iter().enumerate();
    let comes_to_rest =
        |number: usize| terms[number].id == EffectId::ForceDrift && terms[number].free[1];
    let (at, number) = added.find(|(_, number)| comes_to_rest(*number))?;
    let [rate, time_constant, ..] = terms[number].row;
    terms[number] = of_size(EffectId::ForceOffset, rate * time_constant);
    let offset = nearer_to_best(dataset, decision, at, terms)?;
    let is_told = offset.cost - best.cost > margin(decision);
    (!is_told || is_over_at_once(best, number)).then_some(offset)
}

/// Whether an effect is a drift that comes to rest as soon as a drift can.
fn is_over_at_once(best: &Fit, number: usize) -> bool {
    best.shape.terms[number].id == EffectId::ForceDrift
        && best.is_second_at(number, Free::is_at_lowest)
}

/// Whether a size of an effect differs from 0 by so many standard errors. One that is held does; of one at a bound, or
/// that the log does not determine, nobody knows.
fn has_size(decision: &Decision, number: usize, sigmas: f64) -> bool {
    let best = &decision.best;
    let mut sizes = best.shape.sizes_of(number).peekable();
    let is_held = sizes.peek().is_none();
    is_held || sizes.any(|at| differs_from_0(decision, at, sigmas) == Some(true))
}

/// Whether the rate of a relaxation differs from 0 by so many standard errors, or is as slow as one can be. Else it is whatever
/// has changed in a log: of a zero that jumped twice one of 0.06 ± 0.05 1/s was strong. Rates that were right: 7.
fn has_rate(decision: &Decision, number: usize, sigmas: f64) -> bool {
    let shape = &decision.best.shape;
    let is_relaxation = shape.terms[number].id == EffectId::StressRelaxation;
    let is_rate = |at: &usize| is_relaxation && shape.free[*at].owner == Owner::Effect(number, 1);
    let mut rates = (0..shape.free.len()).filter(is_rate);
    rates.all(|at| differs_from_0(decision, at, sigmas) != Some(false))
}

/// Whether a number differs from 0 by so many standard errors, where that is known.
fn differs_from_0(decision: &Decision, at: usize, sigmas: f64) -> Option<bool> {
    let best = &decision.best;
    let number = best.shape.natural(at, best.numbers[at]);
    decision.std_errors[at].map(|error| number.abs() >= sigmas * error)
}

/// The fit with an added effect in its plain form, if that is nearer to the best than to the fit without it: the
/// rate and the time constant of a drift that comes to rest say little each, where its ramp is well known.
pub(crate) fn fit_in_plain_form(
    dataset: &Dataset<'_>,
    decision: &Decision,
    at: usize,
) -> Option<Fit> {
    let best = &decision.best;
    let mut terms = best.shape.terms_at(&best.numbers);
    let own = &mut terms[best.added()[at]];
    *own = in_plain_form(own)?;
    nearer_to_best(dataset, decision, at, terms)
}

/// The best fit with other terms, under the weights of a decision.
pub(super) fn refitted_with(dataset: &Dataset<'_>, decision: &Decision, terms: Vec<Term>) -> Fit {
    let (shape, start) = decision.best.with_terms(terms, dataset.scales);
    let weights = weights(&decision.variances);
    dataset.problem(&weights).fit(&shape, start)
}

/// The fit with other terms, if it is nearer to the best than to the fit without the added effect at a place.
fn nearer_to_best(
    dataset: &Dataset<'_>,
    decision: &Decision,
    at: usize,
    terms: Vec<Term>,
) -> Option<Fit> {
    let best = &decision.best;
    let other = refitted_with(dataset, decision, terms);
    (2.0 * other.cost < best.cost + decision.without[at].cost).then_some(other)
}

#[cfg(test)]
pub(in crate::gap) mod tests {
    use super::*;
    use crate::gap::data::scales::Scales;
    use crate::gap::finding::Verdict;
    use crate::gap::model::shape::Shape;
    use crate::gap::model::start::{tests::contact, whole};
    use crate::model::Model;
    use estimator_core::physics::effect::{EffectId, MOST_PARAMETERS};

    /// Cost of the best fit to as many samples.
    const SAMPLES: usize = 10_000;

    /// A fit with an added effect that is where it starts.
    fn at_start(model: &Model, scales: &Scales, term: Term) -> Fit {
        let shape = Shape::new(&model.environment, vec![term], scales);
        let (numbers, cost) = (shape.start(), 1.0);
        Fit {
            shape,
            numbers,
            cost,
        }
    }

    /// Force offsets of 1 N beside a contact, with standard errors (N) and what is left without each.
    pub(in crate::gap) fn decision(errors: &[f64], without: &[f64]) -> Decision {
        let (model, scales) = contact();
        let terms = vec![of_size(EffectId::ForceOffset, 1.0); errors.len()];
        let shape = Shape::new(&model.environment, terms, &scales);
        let environment = shape.environment_count();
        let fit = |cost: f64| Fit {
            numbers: shape.start(),
            shape: shape.clone(),
            cost,
        };
        let std_errors = (0..environment).map(|_| Some(1e-9));
        Decision {
            verdict: Verdict::MissingEffects,
            thresholds: Default::default(),
            base: fit(2.0 * SAMPLES as f64),
            best: fit(SAMPLES as f64),
            better: None,
            std_errors: std_errors.chain(errors.iter().copied().map(Some)).collect(),
            alternatives: vec![Vec::new(); errors.len()],
            gains: vec![0.5; errors.len()],
            there: vec![0.1; errors.len()],
            without: without.iter().copied().map(fit).collect(),
            rmse_n: (2.0, 1.0),
            least_rmse_n: 1.0,
            evidence: Vec::new(),
            ratio: (2.0, 1.0),
            slow: None,
            variances: vec![1.0; SAMPLES],
            held_out: vec![false; SAMPLES],
            correlation: 1.0,
            is_beside_remainder: false,
            may_be_a_damper: false,
        }
    }

    #[test]
    fn an_effect_that_may_as_well_be_0_is_none_unless_another_may_stand_for_it() {
        // GIVEN a newton that is known to a quarter, and to a half
        assert_eq!(effect_without_size(&decision(&[0.25], &[2e4])), None);
        let unknown = decision(&[0.5], &[2e4]);
        assert_eq!(effect_without_size(&unknown), Some(0));
        // THEN an effect that a rival may replace is left ambiguous, and modes of one spectrum are not
        // decided on one by one.
        let open = Decision {
            alternatives: vec![vec![EffectId::CableStiffness]],
            ..unknown
        };
        assert_eq!(effect_without_size(&open), None);
        // Where the base is enough it is none,
        let spared = Decision {
            ratio: (1.0, 0.9),
            ..open
        };
        assert_eq!(effect_without_size(&spared), Some(0));
        let open = Decision {
            ratio: (2.0, 1.0),
            ..spared
        };
        // AND one that is hardly missed is not.
        let idle = Decision {
            gains: vec![0.03],
            ..open
        };
        assert_eq!(effect_without_size(&idle), Some(0));
        // What is hardly missed has to be known to an eighth, and a quarter is not enough.
        let known_to = |std_error: f64| Decision {
            gains: vec![0.03],
            ..decision(&[std_error], &[2e4])
        };
        assert_eq!(effect_without_size(&known_to(0.25)), Some(0));
        assert_eq!(effect_without_size(&known_to(0.1)), None);
        assert_eq!(
            effect_without_size(&decision(&[0.5, 0.25], &[2e4, 2e4])),
            None
        );
        // But where none of them is known they are none: two waves of 1.3 ± 0.6 N in 36 s of slow noise.
        assert_eq!(
            effect_without_size(&decision(&[0.5, 0.5], &[2e4, 2e4])),
            Some(0)
        );
    }

    #[test]
    fn of_effects_with_which_the_held_out_part_is_foretold_worse_the_worst_goes_first() {
        let mut both = decision(&[0.1, 0.1], &[2e4, 3e4]);
        assert!(fit_without_harmful_effect(&both).is_none());
        both.gains = vec![-0.06, -0.3];
        assert_eq!(fit_without_harmful_effect(&both).unwrap().cost, 3e4);
        // What acts outside the held-out windows changes nothing there.
        both.gains = vec![-0.02, 0.4];
        assert!(fit_without_harmful_effect(&both).is_none());
        // One that acts there as elsewhere takes nothing off.
        both.there[0] = 0.3;
        assert_eq!(fit_without_harmful_effect(&both).unwrap().cost, 2e4);
    }

    #[test]
    fn an_effect_whose_size_has_no_standard_error_is_none() {
        // GIVEN a newton at a bound: a play wider than the whole travel has one
        let mut bound = decision(&[0.1], &[2e4]);
        bound.std_errors.pop();
        bound.std_errors.push(None);
        assert_eq!(effect_without_size(&bound), Some(0));
        // THEN one that is held is what it is.
        bound.best.shape.free.pop();
        assert_eq!(effect_without_size(&bound), None);
    }

    #[test]
    fn what_slow_noise_looks_like_and_a_lateness_must_be_known_better() {
        // GIVEN a size of 1 that is known to a quarter, and to an eighth
        let is_dropped = |id: EffectId, std_error: f64| {
            let mut decision = decision(&[std_error], &[2e4]);
            decision.best.shape.terms[0].id = id;
            effect_without_size(&decision)
        };
        for id in [EffectId::ForceDrift, EffectId::Cogging, EffectId::TimeDelay] {
            assert_eq!(is_dropped(id, 1.0 / 4.0), Some(0));
            assert_eq!(is_dropped(id, 1.0 / 8.0), None);
        }
        assert_eq!(is_dropped(EffectId::CoulombFriction, 1.0 / 4.0), None);
    }

    #[test]
    fn a_relaxation_as_fast_and_a_change_of_curves_as_long_as_one_can_be_are_none() {
        let (model, scales) = contact();
        let is_at_its_end = |id: EffectId, row: [f64; MOST_PARAMETERS]| {
            let mut term = whole(id, row, 1);
            term.free = row.map(|number| number != 0.0);
            super::is_at_its_end(&at_start(&model, &scales, term), 0)
        };
        let is_too_fast = |rate_per_s| {
            is_at_its_end(EffectId::StressRelaxation, [0.2, rate_per_s, 0.0, 0.0, 0.0])
        };
        assert!(is_too_fast(1e9) && !is_too_fast(30.0) && !is_too_fast(1e-9));
        let is_too_long =
            |width_m| is_at_its_end(EffectId::LoadingCurve, [0.2, 0.0, width_m, 0.0, 0.0]);
        assert!(is_too_long(1.0) && !is_too_long(1e-4));
    }

    #[test]
    fn a_relaxation_whose_rate_may_as_well_be_0_is_none() {
        let (model, scales) = contact();
        let row = [0.2, 0.1, 0.0, 0.0, 0.0];
        let best = at_start(&model, &scales, whole(EffectId::StressRelaxation, row, 2));
        // GIVEN a fraction of 0.2 that is known, and a rate of 0.1 1/s to a fifth, to a half, and not at all
        let dropped = |rate_error: Option<f64>| {
            let mut decision = decision(&[0.1], &[2e4]);
            let mut errors = vec![Some(1e-3); best.numbers.len()];
            *errors.last_mut().unwrap() = rate_error;
            (decision.best, decision.std_errors) = (best.clone(), errors);
            effect_without_size(&decision)
        };
        assert_eq!(dropped(Some(0.02)), None);
        assert_eq!(dropped(Some(0.05)), Some(0));
        assert_eq!(dropped(None), None);
    }

    #[test]
    fn a_loop_that_is_hardly_known_may_be_coulombs_friction() {
        // GIVEN a loop of Bouc and Wen's whose stiffness of 1 is known to a ninth, and to a seventh
        let known_to = |std_error: f64| {
            let mut decision = decision(&[std_error], &[2e4]);
            decision.best.shape.terms[0].id = EffectId::BoucWen;
            effects_of_uncertain_form(&decision)
        };
        assert_eq!(known_to(1.0 / 9.0), []);
        assert_eq!(known_to(1.0 / 7.0), [(0, EffectId::CoulombFriction)]);
        // An offset has no simpler form.
        assert_eq!(effects_of_uncertain_form(&decision(&[0.3], &[2e4])), []);
    }

    #[test]
    fn a_drift_that_is_over_as_soon_as_one_can_be_is_an_offset() {
        let (model, scales) = contact();
        let with = |time_constant_s: f64| {
            let mut row = [0.0; MOST_PARAMETERS];
            row[..2].copy_from_slice(&[1.0, time_constant_s]);
            let drift = whole(EffectId::ForceDrift, row, 2);
            is_over_at_once(&at_start(&model, &scales, drift), 0)
        };
        assert!(with(1e-9) && !with(0.5) && !with(1e9));
    }

    #[test]
    fn an_effect_that_takes_nothing_off_at_the_logs_own_rate_is_idle() {
        // GIVEN 12 independent samples' worth of Σ w r² as the bound
        assert!(fit_without_idle_effect(&decision(&[0.1], &[1.0011e4])).is_some());
        assert!(fit_without_idle_effect(&decision(&[0.1], &[1.0013e4])).is_none());
        // AND where much is left, a hundredth of it.
        let mut bad = decision(&[0.1], &[1.02e6]);
        bad.best.cost = 1e6;
        assert!(fit_without_idle_effect(&bad).is_none());
        bad.without[0].cost = 1.001e6;
        assert!(fit_without_idle_effect(&bad).is_some());
    }
}
