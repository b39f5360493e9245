//! Swaps: every other effect is tried in the place of each that was added.

use crate::gap::model::fit::Fit;
use crate::gap::search::{run::Search, run::SearchResult, sets::added_effects};

/// Most rounds of swaps near the noise, and far from it, where a better set is no truer one and a round takes
/// as long as a forward step for each effect. The last round only finds the rivals.
const ROUNDS: [usize; 2] = [4, 2];

impl Search<'_> {
    /// Tries every other effect in the place of each, and takes what is better. The rivals are the fits
    /// of the last round, in which nothing was better.
    pub(crate) fn with_swaps(&self, mut best: Fit, base_cost: f64) -> SearchResult {
        let rounds = ROUNDS[usize::from(self.is_far(&best))];
        for round in 1..=rounds {
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
            match better {
                Some(_) if round == rounds => return with_rivals(best, rivals),
                Some(fit) => best = self.without_insignificant(fit.clone(), base_cost),
                None => return with_rivals(best, rivals),
            }
        }
        SearchResult::alone(best)
    }

    /// The best fits with another effect in the place of one.
    fn rivals_of(&self, best: &Fit, at: usize) -> Vec<Fit> {
        let mut fits = self.expanded(&self.without(best, at));
        let ids = added_effects(best);
        fits.retain(|fit| added_effects(fit) != ids);
        fits
    }
}

fn with_rivals(best: Fit, rivals: Vec<Vec<Fit>>) -> SearchResult {
    SearchResult {
        rivals,
        ..SearchResult::alone(best)
    }
}
