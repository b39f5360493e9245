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
            let rivals: Vec<Vec<Fit>> = best
                .added()
                .into_iter()
                .map(|at| self.rivals_of(&best, at))
                .collect();
            let better = rivals
                .iter()
                .flatten()
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

    /// The best fits with another effect in the place of one.
    fn rivals_of(&self, best: &Fit, at: usize) -> Vec<Fit> {
        let mut fits = self.expanded(&self.without(best, at));
        let ids = added_effects(best);
        fits.retain(|fit| added_effects(fit) != ids);
        fits
    }
}
