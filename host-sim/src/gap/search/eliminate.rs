//! Backward elimination: effects that are not significant are left out.

use estimator_core::physics::effect::EffectId;
use rayon::prelude::*;

use crate::gap::model::{fit::Fit, shape::Shape};
use crate::gap::search::relatives::{as_simpler, simpler};
use crate::gap::search::run::{Search, SearchResult};

impl Search<'_> {
    /// Leaves effects out, the least needed first, until all that are left are significant.
    pub(crate) fn without_insignificant(&self, mut best: Fit, base_cost: f64) -> Fit {
        loop {
            let without: Option<(EffectId, Fit)> = best
                .added()
                .into_par_iter()
                .map(|at| (best.shape.terms[at].id, self.without(&best, at)))
                .min_by(|a, b| a.1.cost.total_cmp(&b.1.cost));
            match without {
                Some((id, fit)) if !self.is_significant(id, &fit, &best, base_cost) => best = fit,
                _ => return best,
            }
        }
    }

    /// The best fit without a term, from its own values and from those of the model file.
    pub(crate) fn without(&self, fit: &Fit, at: usize) -> Fit {
        self.fitted_from_both(fit.without(at, self.dataset.scales))
    }

    /// The better of two fits of a shape: from a start, and from the values of the model file.
    pub(super) fn fitted_from_both(&self, (shape, start): (Shape, Vec<f64>)) -> Fit {
        let from_file = shape.start();
        let (a, b) = rayon::join(
            || self.problem().fit(&shape, start),
            || self.problem().fit(&shape, from_file),
        );
        if a.cost <= b.cost { a } else { b }
    }

    /// Replaces an effect by the simpler one of its family where the difference is not significant: Stribeck's
    /// friction by Coulomb's.
    pub(crate) fn with_simpler_relative(
        &self,
        result: SearchResult,
        base_cost: f64,
    ) -> SearchResult {
        let mut relatives = result.best.added().into_iter().filter_map(|at| {
            let id = result.best.shape.terms[at].id;
            Some((at, id, simpler(id)?))
        });
        let Some((at, id, simpler)) = relatives.next() else {
            return result;
        };
        let only_simpler = Search {
            ids: &[simpler],
            weights: self.weights.clone(),
            tried: Vec::new(),
            ..*self
        };
        let fits = only_simpler.expanded(&self.without(&result.best, at));
        // Without the friction a backlash beside it goes to 0, and stays there: from the same numbers it need not.
        let from_same = self.in_simpler_form(&result.best, at);
        let fits = fits.into_iter().chain(from_same);
        let threshold = |cost: f64| self.effect_threshold(id, cost, &result.best, base_cost);
        match fits.min_by(|a, b| a.cost.total_cmp(&b.cost)) {
            Some(fit) if fit.cost - result.best.cost < threshold(fit.cost) => {
                // What is too little for another effect may leave the form open.
                let mut rivals = result.rivals;
                rivals.push(result.best);
                SearchResult {
                    best: fit,
                    rivals,
                    ..result
                }
            }
            _ => result,
        }
    }

    /// The fit with an effect as the simpler one of its family, from the numbers that it has.
    fn in_simpler_form(&self, best: &Fit, at: usize) -> Option<Fit> {
        let mut terms = best.shape.terms_at(&best.numbers);
        terms[at] = as_simpler(&terms[at])?;
        Some(self.with_terms(best, terms))
    }
}
