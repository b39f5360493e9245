//! Swaps: every other effect is tried in the place of each that was added.

use crate::gap::model::fit::Fit;
use crate::gap::search::{run::Search, run::SearchResult, sets::added_effects};

/// Most swaps near the noise, and far from it, where a better set is no truer one and a round takes as long as
/// a forward step for each effect.
const MOST: [usize; 2] = [3, 1];

impl Search<'_> {
    /// Tries every other effect in the place of each, and takes what is better. The rivals are the fits
    /// of the last round, in which nothing was better or no swap was left.
    pub(crate) fn with_swaps(&self, mut best: Fit, base_cost: f64) -> SearchResult {
        let mut left = MOST[usize::from(self.is_far(&best))];
        loop {
            let added = best.added().into_iter();
            let mut rivals: Vec<Fit> = added.flat_map(|at| self.rivals_of(&best, at)).collect();
            if rivals.iter().any(|fit| self.is_tied(fit, &best)) {
                best = self.with_all_forms(best, base_cost);
                rivals = self.with_forms_where_near(rivals, &best, base_cost);
            }
            let better = rivals
                .iter()
                .min_by(|a, b| self.score(a).total_cmp(&self.score(b)))
                .filter(|fit| self.score(fit) < self.score(&best) - self.decide().swap_gain);
            let Some(fit) = better.filter(|_| left > 0) else {
                return SearchResult {
                    rivals,
                    ..SearchResult::alone(best)
                };
            };
            best = self.without_insignificant(fit.clone(), base_cost);
            left -= 1;
        }
    }

    /// Whether a fit cannot be told from the best.
    fn is_tied(&self, fit: &Fit, best: &Fit) -> bool {
        let noise = (best.cost / self.noise_cost).max(1.0);
        let margin = self.dataset.thresholds.rivalry.margin * self.correlation * noise;
        fit.cost - best.cost < margin
    }

    /// The fits, those that could be the best with the forms that are significant: the forms of two effects that
    /// tie may tell them apart.
    fn with_forms_where_near(&self, fits: Vec<Fit>, best: &Fit, base_cost: f64) -> Vec<Fit> {
        let most = self.dataset.thresholds.rivalry.followed * best.cost;
        fits.into_iter()
            .map(|fit| match fit.cost < most {
                true => self.with_all_forms(fit, base_cost),
                false => fit,
            })
            .collect()
    }

    /// The best fits with another effect in the place of one.
    fn rivals_of(&self, best: &Fit, at: usize) -> Vec<Fit> {
        let mut fits = self.expanded(&self.without(best, at));
        let ids = added_effects(best);
        fits.retain(|fit| added_effects(fit) != ids);
        fits
    }
}
