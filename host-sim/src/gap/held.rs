//! What is new where the numbers of the base are what they were when it was identified.
//!
//! A refit of the base follows an effect as far as it can, and what is left of the effect looks like another: under a foam's
//! record a drag by direction, half of which its relaxation had taken on, was a hysteretic damping. Numbers that are known
//! are therefore held to what they were, within their errors, while one effect is looked for. Whether they have moved
//! instead, or one of them has, is weighed by what each supposition leaves and how many numbers it lets go (BIC).

use super::decide::decision::Decision;
use super::model::dataset::Dataset;
use super::model::{fit::Fit, fit::cost_of_number, known::Known, shape::Term, weights::weights};
use super::progress::Progress;
use super::rounds::{Answer, Rounds};
use crate::model::Environment;

/// What is asked with the numbers of the base held, at either resolution.
pub(super) struct Held<'a> {
    rounds: Rounds<'a>,
    coarse: Known,
    fine: Known,
}

impl<'a> Held<'a> {
    /// What is `known` of the base, beside logs.
    pub(super) fn of(known: &Known, rounds: &Rounds<'a>) -> Held<'a> {
        let samples = |dataset: &Dataset<'_>| -> f64 {
            dataset.logs.iter().map(|log| log.len() as f64).sum()
        };
        let finer = samples(&rounds.fine) / samples(&rounds.coarse);
        Held {
            rounds: *rounds,
            coarse: known.with_correlation(rounds.correlation),
            fine: known.with_correlation(finer * rounds.correlation),
        }
    }

    /// The one effect that explains the log beside numbers that are held, where that is likelier than that numbers have
    /// `moved`. Where a base that has moved explains it alone, nothing is new: on another record of a drive, which was as
    /// before, a friction moves by 5 %, and with it held a delay was new.
    pub(super) fn answer(
        &self,
        environment: &Environment,
        given: &[Term],
        moved: Option<&Answer>,
        is_explained: impl Fn(&Decision) -> bool,
        progress: &dyn Progress,
    ) -> Option<Answer> {
        let moved = moved.map(|moved| &moved.decision);
        if moved.is_some_and(|moved| !moved.adds_any()) {
            return None;
        }
        let one = Rounds {
            most_added: 1,
            ..self.rounds
        };
        let knowing = one.knowing(&self.coarse, &self.fine);
        let answer = knowing.round(environment, given, progress);
        let decision = &answer.decision;
        let stands = decision.adds_any() && is_explained(decision);
        (stands && self.is_likelier(decision, moved)).then_some(answer)
    }

    /// Whether held numbers with an effect are likelier than numbers that have moved, all of them beside what is said
    /// then, or one of them alone.
    fn is_likelier(&self, held: &Decision, moved: Option<&Decision>) -> bool {
        let weights = weights(&held.variances);
        let problem = self.rounds.fine.problem(&weights);
        let each = self.fine.correlation();
        let of_number = cost_of_number(held.samples(), each);
        let score = |cost: f64, numbers: f64| cost / each + numbers * of_number;
        let added = |fit: &Fit| fit.numbers.len() as f64 - held.base.numbers.len() as f64;
        let cost = problem
            .knowing(&self.fine)
            .cost(&held.best.shape, &held.best.numbers);
        let own = score(cost, added(&held.best));
        let all = self.fine.readings(&held.base.shape, &held.base.numbers);
        let are_moved = |moved: &Decision| {
            let best = &moved.best;
            let cost = problem.cost(&best.shape, &best.numbers);
            score(cost, added(best) + all.len() as f64)
        };
        let is_moved = |at: usize| {
            let but = self.fine.but(&held.base.shape, at);
            let start = held.base.numbers.clone();
            score(problem.knowing(&but).fit(&held.base.shape, start).cost, 1.0)
        };
        moved.is_none_or(|moved| own < are_moved(moved))
            && all.iter().all(|reading| own < is_moved(reading.number))
    }
}
