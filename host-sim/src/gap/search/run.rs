//! The search: forward steps from a beam of fits, then elimination and swaps. Every fit is a joint refit
//! of the law and all effects.

use estimator_core::physics::effect::EffectId;
use rayon::prelude::*;

use crate::gap::finding::Candidate;
use crate::gap::model::{
    dataset::Dataset, fit::Fit, fit::cost_of_number, problem::Problem, shape::Term,
};
use crate::gap::progress::Progress;
use crate::gap::search::{
    physical::is_fourier_series, screen::Screen, sets::added_effects, sets::keep_first,
    sets::keep_simplest_of_each_kind,
};
use crate::gap::thresholds;
use crate::model;

/// Fits that the next forward step goes on from.
const BEAM: usize = 3;
/// Most effects that are added.
pub(crate) const MOST_ADDED: usize = 5;

/// A search over the catalogue on one resolution of the logs.
pub(crate) struct Search<'a> {
    pub(crate) dataset: Dataset<'a>,
    /// What the first steps of its fits see of them.
    pub(crate) screen: &'a Screen,
    /// 1/N² for each sample, from the best fit so far.
    pub(crate) weights: Vec<f64>,
    /// The environment of the base model.
    pub(crate) base: &'a model::Environment,
    /// The effects of the base model.
    pub(crate) given: &'a [Term],
    /// The catalogue.
    pub(crate) ids: &'a [EffectId],
    /// Most effects that are added.
    pub(crate) most_added: usize,
    pub(crate) progress: &'a dyn Progress,
    /// Σ w r² of noise alone: the number of samples with a weight.
    pub(crate) noise_cost: f64,
    /// Samples for each independent residual.
    pub(crate) correlation: f64,
    /// Fits of the forward steps, for the report.
    pub(crate) tried: Vec<Fit>,
}

/// The result of a search.
pub(crate) struct SearchResult {
    pub(crate) best: Fit,
    /// The best fits with another effect in the place of one that was added, and what was passed over for it.
    pub(crate) rivals: Vec<Fit>,
    /// Whether the best is far from the noise.
    pub(crate) is_far: bool,
    /// The share of the base's excess over the noise that it takes off.
    pub(crate) explained: f64,
}

impl SearchResult {
    /// A result without rivals.
    pub(crate) fn alone(best: Fit) -> SearchResult {
        SearchResult {
            best,
            rivals: Vec::new(),
            is_far: false,
            explained: 1.0,
        }
    }
}

/// The state between two forward steps.
struct Forward {
    best: Fit,
    beam: Vec<Fit>,
    /// Σ w r² of the base under the present weights.
    base_cost: f64,
}

impl Search<'_> {
    /// Finds the effects that are missing in the base.
    pub(crate) fn run(&mut self, base: Fit) -> SearchResult {
        let state = self.forward(&base);
        self.progress.at(0.6, "leaving out, swapping");
        let (best, base_cost) = (state.best, state.base_cost);
        let best = self.without_insignificant(best, base_cost);
        let best = self.with_form_instead_of_effect(best, base_cost);
        // Near the noise three waves would pass for an explanation; far from it the evidence decides.
        let prominent = self.decide().prominent_wave;
        if !self.is_far(&best) && is_fourier_series(&best, prominent, 3) {
            return SearchResult::alone(base);
        }
        let result = self.with_swaps(best, base_cost);
        let result = self.with_simpler_relative(result, base_cost);
        let result = self.with_decline(result, base_cost);
        let best = self.without_insignificant_forms(result.best, base_cost);
        SearchResult {
            is_far: self.is_far(&best),
            explained: (base_cost - best.cost) / (base_cost - self.noise_cost).max(1.0),
            best,
            ..result
        }
    }

    /// Adds one effect after the other to the base, until that ends. One is asked for where the base leaves no more than
    /// is allowed, too: on rigs with counts of 5 µm, or with counts that toggle, 1.3 times the errors were allowed, and
    /// effects that took 27 to 42 % off the squares were not looked for. Not so where what is left is known to follow the
    /// motion: beside steps of a converter that its noise does not reach an error of the encoder took a sixth off.
    fn forward(&mut self, base: &Fit) -> Forward {
        let mut state = Forward {
            best: base.clone(),
            base_cost: base.cost,
            beam: vec![base.clone()],
        };
        // Effects that only work together take little off one by one.
        let mut idle = 0;
        for level in 0..self.most_added {
            if self.is_adequate(&state.best) && (level > 0 || self.leaves_what_follows()) {
                break;
            }
            let before = state.best.cost;
            if !self.forward_step(&mut state, base, level) {
                break;
            }
            idle = if self.is_idle(before, &state.best) {
                idle + 1
            } else {
                0
            };
            if idle == 2 || self.is_series(&state.best) {
                break;
            }
        }
        state
    }

    /// Whether a fit is far from the noise.
    pub(super) fn is_far(&self, fit: &Fit) -> bool {
        fit.cost > self.decide().ran_away * self.noise_cost
    }

    /// Whether a step took little off, far from the noise.
    fn is_idle(&self, before: f64, after: &Fit) -> bool {
        self.is_far(after) && before - after.cost < self.decide().least_step * before
    }

    /// Whether waves of a fit that is far from the noise are a series that fits any curve.
    fn is_series(&self, fit: &Fit) -> bool {
        self.is_far(fit) && is_fourier_series(fit, self.decide().prominent_wave, 2)
    }

    /// Adds one effect to each fit of the beam. Returns false if the search ends with this step.
    fn forward_step(&mut self, state: &mut Forward, base: &Fit, level: usize) -> bool {
        self.report_level(level);
        let beam = state.beam.par_iter();
        let mut children: Vec<Fit> = beam.flat_map_iter(|fit| self.expanded(fit)).collect();
        children.sort_by(|a, b| self.score(a).total_cmp(&self.score(b)));
        keep_first(&mut children, added_effects);
        self.tried.extend_from_slice(&children);
        let Some(child) = children.first() else {
            return false;
        };
        // Taken before forms are tried on the child, since its rivals are without them.
        let excess = child.cost - self.noise_cost;
        let last = child.shape.terms.last();
        let is_accepted = last
            .is_some_and(|term| self.is_significant(term.id, &state.best, child, state.base_cost));
        if is_accepted {
            // The errors of the fit before are not those of the children.
            let at = self.nearest(&children);
            children[..=at].rotate_right(1);
            let best = children[0].clone();
            self.weigh(&best);
            let best = self.problem().fit(&best.shape, best.numbers);
            state.base_cost = self.with_present_cost(base).cost;
            state.best = self.best_with_forms(best, &children[1..], state.base_cost);
            children.insert(0, state.best.clone());
            keep_first(&mut children, added_effects);
        } else if level > 0 {
            return false;
        }
        let decide = self.decide();
        let least = excess.max(decide.least_excess * self.noise_cost);
        if least < decide.ran_away * self.noise_cost {
            children.retain(|fit| fit.cost - self.noise_cost <= decide.behind * least);
        }
        if self.is_far(&state.best) {
            keep_simplest_of_each_kind(&mut children);
            with_another_newcomer(&mut children, BEAM);
        }
        children.truncate(BEAM);
        state.beam = children
            .iter()
            .map(|fit| self.with_present_cost(fit))
            .collect();
        true
    }

    fn report_level(&self, level: usize) {
        // Later steps take longer: five effects take half of the time of the whole workflow.
        let share = 0.1 + 0.5 * level as f64 / self.most_added as f64;
        let what = format!(
            "effect {} of at most {}: {} in the catalogue",
            level + 1,
            self.most_added,
            self.ids.len()
        );
        self.progress.at(share, &what);
    }

    /// What decides in a search.
    pub(crate) fn decide(&self) -> &thresholds::Search {
        &self.dataset.thresholds.search
    }

    /// The least-squares problem under the present weights.
    pub(crate) fn problem(&self) -> Problem<'_> {
        self.dataset.problem(&self.weights)
    }

    /// Takes the weights from a fit. The costs of earlier fits are no longer comparable then.
    pub(crate) fn weigh(&mut self, fit: &Fit) {
        self.weights = self.dataset.weights(fit);
        self.noise_cost = self.weights.iter().filter(|w| **w > 0.0).count() as f64;
    }

    /// Fits the same shape again under the present weights.
    pub(crate) fn refitted(&self, fit: &Fit) -> Fit {
        self.problem().fit(&fit.shape, fit.numbers.clone())
    }

    /// The fit with its cost under the present weights.
    pub(super) fn with_present_cost(&self, fit: &Fit) -> Fit {
        Fit {
            cost: self.problem().cost(&fit.shape, &fit.numbers),
            ..fit.clone()
        }
    }

    /// The sets of effects that came closest, for the report.
    pub(crate) fn ladder(&self, base: &Fit, result: &SearchResult) -> Vec<Candidate> {
        let all: Vec<&Fit> = [base, &result.best]
            .into_iter()
            .chain(&result.rivals)
            .chain(&self.tried)
            .collect();
        let mut ladder: Vec<Candidate> = all
            .into_par_iter()
            .map(|fit| Candidate {
                ids: added_effects(fit),
                ratio: (self.with_present_cost(fit).cost / self.noise_cost).sqrt(),
            })
            .collect();
        ladder.sort_by(|a, b| a.ratio.total_cmp(&b.ratio));
        keep_first(&mut ladder, |candidate| candidate.ids.clone());
        // A set that was left before its fit converged may be worse than the base: it says nothing.
        if let Some(base) = ladder.iter().position(|candidate| candidate.ids.is_empty()) {
            ladder.truncate(base + 1);
        }
        ladder
    }

    /// The cost with a penalty on free numbers: BIC in units of independent residuals.
    pub(crate) fn score(&self, fit: &Fit) -> f64 {
        let each = cost_of_number(self.noise_cost, self.correlation);
        fit.cost / self.correlation + fit.numbers.len() as f64 * each
    }

    /// Whether what is allowed for is no noise: what a model left when it was identified, or what readings are rounded by.
    fn leaves_what_follows(&self) -> bool {
        let mut floors = self.dataset.floors.iter();
        floors.any(|floor| floor.left.is_some() || floor.is_mostly_rounding())
    }

    /// Whether a fit leaves hardly more than the noise.
    pub(crate) fn is_adequate(&self, fit: &Fit) -> bool {
        self.is_allowed(fit.cost)
    }

    /// Whether a cost is hardly more than that of the noise.
    pub(super) fn is_allowed(&self, cost: f64) -> bool {
        cost <= self.dataset.thresholds.explained.nothing_more * self.noise_cost
    }
}

/// Moves the first fit with another newcomer into the beam, where all of that have the same: what stands for
/// many effects a little, as a friction with a spring did, would leave no way to what is there. It must come
/// within twice the cost of the best.
fn with_another_newcomer(fits: &mut [Fit], beam: usize) {
    let newcomer = |fit: &Fit| fit.shape.terms.last().map(|term| term.id);
    let Some(first) = fits.first() else { return };
    let (id, most) = (newcomer(first), 2.0 * first.cost);
    let other = fits.iter().position(|fit| newcomer(fit) != id);
    if let Some(at) = other.filter(|at| *at >= beam && fits[*at].cost < most) {
        fits[beam - 1..=at].rotate_right(1);
    }
}
