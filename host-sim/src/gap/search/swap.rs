//! Swaps: every other effect is tried in the place of each that was added.

use estimator_core::physics::effect::EffectId;
use rayon::prelude::*;

use crate::gap::model::{fit::Fit, shape::FEWEST_CYCLES, shape::Free};
use crate::gap::search::{run::Search, run::SearchResult, sets::added_effects};

/// Most swaps near the noise, and far from it, where a better set is no truer one and a round takes as long as
/// a forward step for each effect.
const MOST: [usize; 2] = [3, 1];

/// An encoder's error with fewer cycles in contact is nearly the form of a law: others with a form of their own are nearer
/// to each other than beside a wave. A soft layer, rounded in its depth, was such an error of 1.6 cycles.
const FEW_CYCLES: f64 = 2.5;
/// Times Σ w r² of the best up to which others then get their forms: that layer without its rounding left 1.6 times as much.
const NEAR_FEW_CYCLES: f64 = 2.0;

impl Search<'_> {
    /// Tries every other effect in the place of each, and takes what is better. The rivals are the fits
    /// of the last round, in which nothing was better or no swap was left.
    pub(crate) fn with_swaps(&self, mut best: Fit, base_cost: f64) -> SearchResult {
        let mut left = MOST[usize::from(self.is_far(&best))];
        loop {
            let added = best.added().into_par_iter();
            let rivals = added.flat_map_iter(|at| self.rivals_of(&best, at));
            let mut rivals: Vec<Fit> = rivals.collect();
            let has_few_cycles = has_few_cycles(&best);
            if has_few_cycles || rivals.iter().any(|fit| self.is_tied(fit, &best)) {
                best = self.with_all_forms(best, base_cost);
                let near = match has_few_cycles {
                    true => NEAR_FEW_CYCLES,
                    false => self.dataset.thresholds.rivalry.followed,
                };
                rivals = self.with_forms_where_near(rivals, near * best.cost, base_cost);
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

    /// The fits, those that leave less than `most` with the forms that are significant: the forms of two effects that
    /// tie may tell them apart.
    fn with_forms_where_near(&self, fits: Vec<Fit>, most: f64, base_cost: f64) -> Vec<Fit> {
        fits.into_par_iter()
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

/// Whether an error of the encoder was added that has few cycles in contact.
fn has_few_cycles(best: &Fit) -> bool {
    let is_few =
        |pitch: &Free, number: f64| (number - pitch.highest).exp() * FEW_CYCLES > FEWEST_CYCLES;
    let is_wave = |at: &usize| best.shape.terms[*at].id == EffectId::EncoderPeriodicError;
    let mut waves = best.added().into_iter().filter(is_wave);
    waves.any(|at| best.is_second_at(at, is_few))
}
