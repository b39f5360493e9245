//! What the decision comes to.

use std::collections::BTreeSet;

use estimator_core::physics::effect::EffectId;

use super::held_out::held_out_error;
use crate::gap::finding::Verdict;
use crate::gap::model::{dataset::Dataset, error::std_errors, fit::Fit, weights::weights};
use crate::gap::search::{evidence::Evidence, relatives::is_another_zero, relatives::stands_for};
use crate::gap::thresholds::Thresholds;
use crate::stats::rms;

/// The decision on the effects of a search.
pub(crate) struct Decision {
    pub(crate) verdict: Verdict,
    /// What it was decided with.
    pub(crate) thresholds: Thresholds,
    /// The fit of the base to the whole log.
    pub(crate) base: Fit,
    /// The fit with the effects to the whole log.
    pub(crate) best: Fit,
    /// A rival that explains more, as the search left it.
    pub(crate) better: Option<Fit>,
    /// Standard errors of the free numbers of `best`, in the parameters' units; `None` at a bound.
    pub(crate) std_errors: Vec<Option<f64>>,
    /// For every added effect of `best`, in the order of its terms, the effects that it could be as well.
    pub(crate) alternatives: Vec<Vec<EffectId>>,
    /// For every added effect, the share of the held-out squares that it takes off.
    pub(crate) gains: Vec<f64>,
    /// For every added effect, the share of what it does to the squares of the force that is in the held-out part.
    pub(crate) there: Vec<f64>,
    /// For every added effect, the fit without it.
    pub(crate) without: Vec<Fit>,
    /// RMSE (N) on the held-out part, before and after.
    pub(crate) rmse_n: (f64, f64),
    /// RMSE (N) of the best set of all on the held-out part, whether its effects are named or not.
    pub(crate) least_rmse_n: f64,
    /// What speaks for each effect that the search found.
    pub(crate) evidence: Vec<Evidence>,
    /// Residuals on the held-out part over what is allowed, before and after.
    pub(crate) ratio: (f64, f64),
    /// How many times as large (rms) means of the residuals are in motion as noise makes them, where that alone speaks
    /// against the fit.
    pub(crate) slow: Option<f64>,
    /// The variances (N²) that the residuals should have.
    pub(crate) variances: Vec<f64>,
    /// Whether each sample was held out.
    pub(crate) held_out: Vec<bool>,
    /// Samples for each independent residual.
    pub(crate) correlation: f64,
    /// Whether what the model left when it was identified was allowed for.
    pub(crate) is_beside_remainder: bool,
    /// Whether a delay by which the force is earlier than the position may as well be a damper.
    pub(crate) may_be_a_damper: bool,
}

impl Decision {
    /// What speaks for an effect of the best fit, by the number of its term.
    pub(crate) fn evidence_for(&self, number: usize) -> Option<&Evidence> {
        let id = self.best.shape.terms[number].id;
        self.evidence.iter().find(|evidence| evidence.id == id)
    }

    /// Whether the held-out part is foretold worse with an added effect, by much, or at all where it acts there as it does
    /// elsewhere.
    pub(crate) fn is_spoken_against(&self, at: usize) -> bool {
        let decide = &self.thresholds.acceptance;
        let (gain, there) = (self.gains[at], self.there[at]);
        gain < -decide.harm || gain < 0.0 && there > decide.acts_there
    }

    /// What speaks for those that are named.
    pub(crate) fn named_evidence(&self) -> Vec<Evidence> {
        let named = self.best.added_ids();
        let own = self.evidence.iter();
        own.filter(|evidence| named.contains(&evidence.id))
            .cloned()
            .collect()
    }

    /// Takes over what earlier decisions on parts of the effects found that these could be as well.
    pub(crate) fn join_alternatives(&mut self, parts: &[&Decision]) {
        for (at, id) in self.best.added_ids().into_iter().enumerate() {
            let known = parts
                .iter()
                .flat_map(|part| part.best.added_ids().into_iter().zip(&part.alternatives));
            let others = known.filter(|(other, _)| *other == id);
            let others: BTreeSet<EffectId> = others.flat_map(|(_, ids)| ids).copied().collect();
            others.into_iter().for_each(|other| self.open(at, other));
        }
    }

    /// Root mean square (N) of what a fit leaves of all samples that count.
    pub(crate) fn left_by_n(&self, fit: &Fit, dataset: &Dataset<'_>) -> f64 {
        let weights = weights(&self.variances);
        let problem = dataset.problem(&weights);
        let residuals = problem.residuals(&fit.shape, &fit.numbers);
        rms(problem.used().into_iter().map(|at| residuals[at]))
    }

    /// Takes the effects back; `dataset` is what was decided with.
    pub(crate) fn take_effects_back(&mut self, dataset: &Dataset<'_>) {
        let weights = weights(&self.variances);
        self.best = self.base.clone();
        self.std_errors = std_errors(&dataset.problem(&weights), &self.best);
        self.rmse_n.1 = self.rmse_n.0;
        self.least_rmse_n = self.rmse_n.0;
        (self.alternatives, self.gains) = Default::default();
        (self.there, self.without) = Default::default();
    }

    /// Its names stand beside a remainder that was allowed for; `dataset` has the floors without it.
    pub(crate) fn stand_beside_remainder(&mut self, dataset: &Dataset<'_>) {
        self.is_beside_remainder = true;
        let is_any_clear = self.clear_names().any(|is_clear| is_clear);
        self.verdict = match is_any_clear {
            _ if self.without.is_empty() => Verdict::Unexplained,
            true => Verdict::PartlyExplained,
            false => Verdict::Ambiguous,
        };
        self.variances = dataset.variances(&self.best);
        let weights = weights(&self.variances);
        let problem = dataset.problem(&weights);
        let ratio = |fit: &Fit| held_out_error(&problem, fit, &self.held_out).ratio;
        self.ratio = (ratio(&self.base), ratio(&self.best));
        self.evidence = self.named_evidence();
        self.let_rivals_grade();
    }

    /// What could stand in the place of each effect says how sure its name is, and no evidence beside what remains.
    pub(crate) fn let_rivals_grade(&mut self) {
        let clear: Vec<bool> = self.clear_names().collect();
        let each = self.best.added_ids().into_iter().zip(&self.alternatives);
        for ((id, alternatives), is_clear) in each.zip(clear) {
            for own in self.evidence.iter_mut().filter(|own| own.id == id) {
                own.is_strong = is_clear;
                own.is_strong_group = true;
                own.alternatives = alternatives.clone();
            }
        }
    }

    /// Whether residuals of so many times what is allowed are hardly more than that.
    pub(crate) fn is_noise(&self, ratio: f64) -> bool {
        ratio.powi(2) <= self.thresholds.explained.nothing_more
    }

    /// How many samples count.
    pub(crate) fn samples(&self) -> f64 {
        self.variances.iter().filter(|v| **v > 0.0).count() as f64
    }

    /// Whether it adds any effect to the base.
    pub(crate) fn adds_any(&self) -> bool {
        !self.best.added().is_empty()
    }

    /// For each added effect, whether nothing but what stands for it could be in its place: a lag names the place where a
    /// delay is.
    pub(crate) fn clear_names(&self) -> impl Iterator<Item = bool> {
        let each = self.best.added_ids().into_iter().zip(&self.alternatives);
        each.map(|(id, others)| {
            let mut others = others.iter();
            others.all(|other| stands_for(id, *other) && !is_another_zero(id, *other))
        })
    }

    /// Leaves open whether an added effect is another one, and in what speaks for it too: where something remains the
    /// evidence grades a name, and not the rivals at the floor.
    pub(crate) fn open_with_evidence(&mut self, at: usize, other: EffectId) {
        if self.verdict == Verdict::PartlyExplained {
            let id = self.best.added_ids()[at];
            let mut own = self.evidence.iter_mut();
            if let Some(own) = own.find(|own| own.id == id) {
                own.alternatives.push(other);
            }
        }
        self.open(at, other);
    }

    /// Leaves open whether an added effect is another one: the verdict is no longer certain.
    pub(crate) fn open(&mut self, at: usize, other: EffectId) {
        if !self.alternatives[at].contains(&other) {
            self.alternatives[at].push(other);
        }
        if self.verdict == Verdict::MissingEffects {
            self.verdict = Verdict::Ambiguous;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::acceptance::tests::decision;
    use super::*;

    #[test]
    fn what_a_part_could_be_as_well_stays_open_in_the_whole() {
        let mut whole = decision(&[0.1, 0.1], &[2e4, 2e4]);
        whole.best.shape.terms[1].id = EffectId::ForceLag;
        let mut part = decision(&[0.1], &[2e4]);
        part.best.shape.terms[0].id = EffectId::ForceLag;
        // GIVEN a lag that was certain THEN nothing is open
        whole.join_alternatives(&[&part]);
        assert_eq!(whole.verdict, Verdict::MissingEffects);
        // AND one that may be a delay is open, once, and the offset beside it is not.
        part.alternatives[0] = vec![EffectId::TimeDelay];
        whole.join_alternatives(&[&part, &part]);
        assert_eq!(whole.alternatives, [vec![], vec![EffectId::TimeDelay]]);
        assert_eq!(whole.verdict, Verdict::Ambiguous);
    }
}
