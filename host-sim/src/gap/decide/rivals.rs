//! Who else an effect could be: fits with another one in its place that explain the logs as well.

use estimator_core::physics::effect::{EffectId, Family};
use rayon::prelude::*;

use crate::gap::decide::evidence::Evidence;
use crate::gap::model::fit::{Fit, Problem};
use crate::gap::search::search::{Found, added};

/// Rivals whose Σ w r² is within so many independent standard errors squared are not told apart.
const APART: f64 = 12.0;

/// Stretches of the logs for [`Evidence::is_worse_throughout`], and the standard errors it asks for.
const STRETCHES: usize = 48;
const SURE: f64 = 2.0;
/// A share of Σ w r² that no such errors make: 6.6 % and more for a lag that was one, mostly in the
/// fastest of 48 stretches.
const LATE: f64 = 0.05;

/// Σ w r² within which two fits are not told apart.
pub(in crate::gap) fn apart(best: &Fit, count: f64, correlation: f64) -> f64 {
    APART * correlation * (best.cost / count).max(1.0)
}

/// What came of the fits with another effect in the place of one.
pub(in crate::gap) struct Rivals {
    /// For every added effect the ids that fit as well in its place.
    pub(in crate::gap) alternatives: Vec<Vec<EffectId>>,
    /// The search's fit that explains the logs better, at their own rate, than the one it preferred.
    pub(in crate::gap) better: Option<Fit>,
}

impl Evidence<'_> {
    pub(in crate::gap) fn rivals(
        &self,
        all: &Problem<'_>,
        best: &Fit,
        found: &Found,
        correlation: f64,
    ) -> Rivals {
        let ids = added(best);
        let count = all.weights.iter().filter(|w| **w > 0.0).count() as f64;
        let apart = apart(best, count, correlation);
        // At the search's coarse resolution a rival may be further off than at this one: a compliance that
        // follows in 2 ms, seen every 4, by 14 %.
        let coarse = found.best.cost;
        let close: Vec<&Fit> = found
            .rivals
            .iter()
            .flatten()
            .filter(|fit| fit.cost < coarse * 1.20 + apart)
            .collect();
        let refitted: Vec<Fit> = close
            .par_iter()
            .map(|fit| all.walk(&fit.shape, fit.numbers.clone(), 30))
            .collect();
        let as_well = |at: usize| {
            let own = best.shape.terms[at].id;
            let mut alternatives = Vec::new();
            for fit in &refitted {
                let Some(other) = replaced(&ids, &added(fit), own) else {
                    continue;
                };
                let more = fit.cost - best.cost;
                let open = are_late(own, other)
                    && more < LATE * best.cost
                    && !self.is_worse_throughout(all, best, fit);
                if (more < apart || open) && !related(own, other) && !alternatives.contains(&other)
                {
                    alternatives.push(other);
                }
            }
            alternatives
        };
        let price = correlation * (count / correlation).max(2.0).ln();
        let score = |fit: &Fit| fit.cost + price * fit.numbers.len() as f64;
        // The simpler of two relatives has been preferred already.
        let is_another = |fit: &Fit| {
            let own =
                |id: &EffectId| replaced(&ids, &added(fit), *id).filter(|o| !related(*id, *o));
            ids.iter().any(|id| own(id).is_some())
        };
        let better = close
            .iter()
            .zip(&refitted)
            .filter(|own| is_another(own.1))
            .min_by(|a, b| score(a.1).total_cmp(&score(b.1)))
            .filter(|own| score(own.1) < score(best) - apart);
        Rivals {
            alternatives: best.added().into_iter().map(as_well).collect(),
            better: better.map(|(fit, _)| (*fit).clone()),
        }
    }

    /// Whether a rival is worse in most of the log and not by a few stretches of it: Vuong's test of
    /// two models of which none holds the other, on sums over stretches, so that errors which last
    /// (steps of the force channel, a touch) count once each. A delay of 4.5 ms under a sine of 0.2 Hz
    /// was worse than a lag by 80, 0.7 standard errors of that sum.
    fn is_worse_throughout(&self, all: &Problem<'_>, best: &Fit, rival: &Fit) -> bool {
        let squares = |fit: &Fit| -> Vec<f64> {
            let residuals = all.residuals(&fit.shape, &fit.numbers);
            let each = residuals.iter().zip(all.weights);
            each.map(|(r, w)| w * r * r).collect()
        };
        let each = squares(rival).into_iter().zip(squares(best));
        let more: Vec<f64> = each.map(|(rival, best)| rival - best).collect();
        let stretches = more.chunks(more.len().div_ceil(STRETCHES).max(1));
        let sums: Vec<f64> = stretches.map(|own| own.iter().sum()).collect();
        let spread = sums.iter().map(|own| own * own).sum::<f64>().sqrt();
        sums.iter().sum::<f64>() > SURE * spread
    }
}

/// Whether both only make the force late: in slow motion they differ by less than a rig errs.
pub(in crate::gap) fn are_late(one: EffectId, other: EffectId) -> bool {
    one != other
        && [one, other]
            .iter()
            .all(|id| id.info().family == Family::Lateness)
}

/// The id that stands in `others` where `own` stands in `ids`, if all else is the same.
fn replaced(ids: &[EffectId], others: &[EffectId], own: EffectId) -> Option<EffectId> {
    let mut rest = others.to_vec();
    for id in ids.iter().filter(|id| **id != own) {
        let at = rest.iter().position(|other| other == id)?;
        rest.remove(at);
    }
    match rest[..] {
        [other] if other != own => Some(other),
        _ => None,
    }
}

/// Whether one is a special case of the other: no ambiguity, the simpler one wins where it is adequate.
pub(in crate::gap) fn related(one: EffectId, other: EffectId) -> bool {
    let family = one.info().family;
    one == other || (family.is_nested() && family == other.info().family)
}
