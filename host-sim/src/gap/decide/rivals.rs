//! Effects that an accepted one could be as well: fits with another effect in its place that explain the
//! logs as well.

use estimator_core::physics::effect::EffectId;
use rayon::prelude::*;

use super::one_speed::is_one_speed;
use crate::gap::data::scales::Scales;
use crate::gap::model::{dataset::Dataset, fit::Fit, fit::cost_of_number, problem::Problem};
use crate::gap::noise::known::most_correlation;
use crate::gap::search::relatives::{are_late, is_lateness, oppose_motion, related, simpler};
use crate::gap::search::{run::SearchResult, sets::added_effects};
use crate::gap::thresholds::Rivalry;

/// Most steps of the refit of a rival.
const STEPS: usize = 30;
/// Stretches of the logs for [`is_worse_throughout`].
const STRETCHES: usize = 48;

/// The difference in Σ w r² within which two fits are not discriminated; `count` is the number of samples.
pub(crate) fn discriminability_margin(
    best: &Fit,
    count: f64,
    correlation: f64,
    margin: f64,
) -> f64 {
    margin * correlation * (best.cost / count).max(1.0)
}

/// The same, with what a model left and is allowed for.
pub(super) fn margin(dataset: &Dataset<'_>, best: &Fit, count: f64, correlation: f64) -> f64 {
    let decide = &dataset.thresholds.rivalry;
    let margin = |correlation| discriminability_margin(best, count, correlation, decide.margin);
    match dataset.floors.iter().any(|floor| floor.left.is_some()) {
        true => margin(correlation.min(most_correlation(count)))
            .max((decide.beside_remainder - 1.0) * best.cost),
        false => margin(correlation),
    }
}

/// The fits with another effect in the place of one.
pub(super) struct Rivals {
    /// For every added effect, the ids that fit as well in its place.
    pub(super) alternatives: Vec<Vec<EffectId>>,
    /// The fit of the search that, at the log's own rate, explains the logs better than the one it
    /// preferred.
    pub(super) better: Option<Fit>,
}

/// A fit of the search, and its refit at the log's own rate.
type Rival<'a> = (&'a Fit, Fit);

/// Refits the rivals of a search's result and compares them with the best fit.
pub(super) fn rivals(
    dataset: &Dataset<'_>,
    all: &Problem<'_>,
    best: &Fit,
    result: &SearchResult,
    correlation: f64,
) -> Rivals {
    let decide = &dataset.thresholds.rivalry;
    let count = all.weights.iter().filter(|w| **w > 0.0).count() as f64;
    let margin = margin(dataset, best, count, correlation);
    let is_one_speed = is_one_speed(dataset, best);
    let most = result.best.cost * followed(decide, is_one_speed) + margin;
    let close = result.rivals.iter().filter(|fit| fit.cost < most);
    let close: Vec<&Fit> = close.collect();
    let refitted: Vec<Rival<'_>> = close
        .par_iter()
        .map(|fit| {
            (
                *fit,
                all.fit_briefly(&fit.shape, fit.numbers.clone(), STEPS),
            )
        })
        .collect();
    let per_number = correlation * cost_of_number(count, correlation);
    let at_one_speed = match is_one_speed {
        true => margin.max((decide.at_one_speed - 1.0) * best.cost),
        false => margin,
    };
    let added = best.added().into_iter();
    Rivals {
        alternatives: added
            .map(|at| alternatives(all, best, at, &refitted, (margin, at_one_speed), decide))
            .collect(),
        better: better(best, &refitted, margin, per_number),
    }
}

/// How many times the Σ w r² of the best a rival may leave to be looked at.
fn followed(decide: &Rivalry, is_one_speed: bool) -> f64 {
    match is_one_speed {
        true => decide.followed.max(decide.at_one_speed),
        false => decide.followed,
    }
}

/// A result whose best is now a fit without one of its effects: what stood in the place of another one stands there
/// still. Without them a friction beside a drift was certain on a cantilever's record, which a viscous drag beside
/// the same drift explained as well.
pub(super) fn result_without(
    result: SearchResult,
    best: Fit,
    dataset: &Dataset<'_>,
) -> SearchResult {
    let left = added_effects(&best);
    let all = added_effects(&result.best);
    let Some(gone) = all.into_iter().find(|id| !left.contains(id)) else {
        return SearchResult::alone(best);
    };
    let is_one_speed = is_one_speed(dataset, &best);
    let most = result.best.cost * followed(&dataset.thresholds.rivalry, is_one_speed);
    let close = result.rivals.iter().filter(|fit| fit.cost < most);
    SearchResult {
        rivals: fits_without(close, gone, dataset.scales),
        ..SearchResult::alone(best)
    }
}

/// Where fits that have an effect start without it; their costs are those with it.
fn fits_without<'a>(
    fits: impl Iterator<Item = &'a Fit>,
    gone: EffectId,
    scales: &Scales,
) -> Vec<Fit> {
    let without = |fit: &Fit| {
        let added = fit.added().into_iter();
        let mut same = added.filter(|at| fit.shape.terms[*at].id == gone);
        let (shape, numbers) = fit.without(same.next()?, scales);
        let cost = fit.cost;
        Some(Fit {
            shape,
            numbers,
            cost,
        })
    };
    fits.filter_map(without).collect()
}

/// The effects that explain the logs as well as one of the best fit: those that leave less than the `margin` more, of
/// drags and frictions where they are one less than `at_one_speed`, and richer forms of it that leave more than the
/// margin less.
fn alternatives(
    all: &Problem<'_>,
    best: &Fit,
    at: usize,
    rivals: &[Rival<'_>],
    (margin, at_one_speed): (f64, f64),
    decide: &Rivalry,
) -> Vec<EffectId> {
    let id = best.shape.terms[at].id;
    let ids = added_effects(best);
    let mut alternatives = Vec::new();
    for (_, fit) in rivals {
        let Some(other) = replacement(&ids, &added_effects(fit), id) else {
            continue;
        };
        let more = fit.cost - best.cost;
        let is_late = are_late(id, other)
            && match is_within_a_period(all, &[best, fit]) {
                true => more < decide.late_within_a_period * best.cost,
                false => {
                    more < decide.late * best.cost
                        && !is_worse_throughout(all, best, fit, decide.throughout_sigmas)
                }
            };
        let is_open = match related(id, other) {
            true => simpler(other) == Some(id) && is_form_open(best.cost, fit.cost, margin, decide),
            false => more < margin || is_late || oppose_motion(id, other) && more < at_one_speed,
        };
        if is_open && !alternatives.contains(&other) {
            alternatives.push(other);
        }
    }
    alternatives
}

/// Whether what makes the force late does so by less than a period: the force between two samples, which tells a
/// lag from a delay then, is not in a log. A lag of 1.5 ms at 200 Hz was a delay, `certain`.
fn is_within_a_period(all: &Problem<'_>, fits: &[&Fit]) -> bool {
    let period_s = all.logs.iter().map(|log| log.period_s).fold(0.0, f64::max);
    let late_s = |fit: &&Fit| {
        let terms = fit.shape.terms_at(&fit.numbers).into_iter();
        let late = terms.filter(|term| !term.given && is_lateness(term.id));
        late.map(|term| term.row[0].abs()).fold(0.0, f64::max)
    };
    fits.iter().map(late_s).all(|late_s| late_s < period_s)
}

/// Whether a richer form takes so much off that it may be the right one; the simpler one suffices.
fn is_form_open(simple: f64, rich: f64, margin: f64, decide: &Rivalry) -> bool {
    simple - rich > margin.max(decide.richer * simple)
}

/// The rival with the best score, if that beats the best fit by more than the margin; a free number costs
/// `per_number`.
fn better(best: &Fit, rivals: &[Rival<'_>], margin: f64, per_number: f64) -> Option<Fit> {
    let ids = added_effects(best);
    let score = |fit: &Fit| fit.cost + per_number * fit.numbers.len() as f64;
    // The search has preferred the simpler of two relatives already.
    let is_another = |fit: &Fit| {
        let others = added_effects(fit);
        ids.iter()
            .any(|id| replacement(&ids, &others, *id).is_some_and(|other| !related(*id, other)))
    };
    rivals
        .iter()
        .filter(|(_, fit)| is_another(fit))
        .min_by(|(_, a), (_, b)| score(a).total_cmp(&score(b)))
        .filter(|(_, fit)| score(fit) < score(best) - margin)
        .map(|(found, _)| (*found).clone())
}

/// Whether a rival is worse in most of the log and not by a few stretches of it. This is Vuong's test of
/// two models of which none contains the other, on sums over stretches, so that errors which last (steps
/// of the force channel, a touch) count once each.
fn is_worse_throughout(all: &Problem<'_>, best: &Fit, rival: &Fit, sigmas: f64) -> bool {
    let squares = |fit: &Fit| -> Vec<f64> {
        let residuals = all.residuals(&fit.shape, &fit.numbers);
        let each = residuals.iter().zip(all.weights);
        each.map(|(r, w)| w * r * r).collect()
    };
    let each = squares(rival).into_iter().zip(squares(best));
    let more: Vec<f64> = each.map(|(rival, best)| rival - best).collect();
    let stretches = more.chunks(more.len().div_ceil(STRETCHES).max(1));
    let sums: Vec<f64> = stretches.map(|stretch| stretch.iter().sum()).collect();
    let error = sums.iter().map(|sum| sum * sum).sum::<f64>().sqrt();
    sums.iter().sum::<f64>() > sigmas * error
}

/// The effect in `others` that takes the place of `id` in `ids`, if all other effects are the same.
pub(super) fn replacement(ids: &[EffectId], others: &[EffectId], id: EffectId) -> Option<EffectId> {
    let mut rest = others.to_vec();
    for kept in ids.iter().filter(|kept| **kept != id) {
        let at = rest.iter().position(|other| other == kept)?;
        rest.remove(at);
    }
    match rest[..] {
        [other] if other != id => Some(other),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::super::acceptance::tests::decision;
    use super::*;
    use crate::gap::model::start::tests::contact;

    #[test]
    fn what_stood_in_an_effects_place_still_does_when_another_is_dropped() {
        let (friction, drag, drift) = (
            EffectId::CoulombFriction,
            EffectId::ViscousDrag,
            EffectId::ForceDrift,
        );
        let fit = |ids: [EffectId; 2]| {
            let mut fit = decision(&[0.1, 0.1], &[2e4, 2e4]).best;
            let terms = &mut fit.shape.terms;
            terms
                .iter_mut()
                .zip(ids)
                .for_each(|(term, id)| term.id = id);
            fit
        };
        // GIVEN a friction beside a drift that is dropped, with a drag in the place of the friction, and of the drift
        let rivals = [fit([drag, drift]), fit([friction, drag])];
        // THEN the drag alone stands for the friction alone.
        let left = fits_without(rivals.iter(), drift, &contact().1);
        assert_eq!(left.len(), 1);
        assert_eq!(
            replacement(&[friction], &added_effects(&left[0]), friction),
            Some(drag)
        );
    }

    #[test]
    fn a_richer_friction_that_takes_a_twentieth_off_leaves_the_form_open() {
        let (coulomb, stribeck) = (EffectId::CoulombFriction, EffectId::StribeckFriction);
        assert_eq!(simpler(stribeck), Some(coulomb));
        assert_eq!(simpler(EffectId::BoucWen), Some(coulomb));
        assert_eq!(simpler(coulomb), None);
        let is_open =
            |rich: f64, margin: f64| is_form_open(1000.0, rich, margin, &Rivalry::default());
        assert!(is_open(940.0, 12.0));
        assert!(!is_open(960.0, 12.0));
        // AND what scatter alone may take off leaves nothing open.
        assert!(!is_open(940.0, 70.0));
    }
}
