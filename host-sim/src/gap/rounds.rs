//! A search and its decision, asked until nothing more is named.
//!
//! Where something remains, an effect is weighed against all of it: beside a relaxation that explains 99.5 % of a
//! foam's record a curve that bends, 0.4 % of it, had no evidence. With the relaxation in the model it has, so that
//! an owner would be told of it only if he asked again. What is named is therefore made part of the model, and what
//! remains is asked for by itself.

use estimator_core::physics::effect::EffectId;

use super::decide::decision::Decision;
use super::decide::selection::decide;
use super::finding::{Candidate, NEARLY_NOISE, Verdict};
use super::model::dataset::Dataset;
use super::model::fit::Fit;
use super::model::known::Known;
use super::model::shape::Term;
use super::noise::floor::NoiseFloor;
use super::progress::{Progress, Within};
use super::search::run::{MOST_ADDED, Search, SearchResult};
use super::search::screen::Screen;
use super::search::sets::keep_first;
use crate::model::Environment;

/// Most rounds, each of which takes a search: a foam's record needed two, and a third that found nothing.
const MOST_ROUNDS: usize = 4;

/// What every round is asked with.
#[derive(Clone, Copy)]
pub(super) struct Rounds<'a> {
    /// The logs at the search's resolution.
    pub(super) coarse: Dataset<'a>,
    /// The logs at that of the last fits.
    pub(super) fine: Dataset<'a>,
    /// The catalogue.
    pub(super) ids: &'a [EffectId],
    /// Most effects that a round adds.
    pub(super) most_added: usize,
    /// Samples of the search for each independent residual.
    pub(super) correlation: f64,
    pub(super) progress: &'a dyn Progress,
}

/// The answer of one round, or of several.
pub(super) struct Answer {
    pub(super) decision: Decision,
    /// The sets of effects that came closest.
    pub(super) ladder: Vec<Candidate>,
    /// The fit of the set that came closest, named or not.
    pub(super) closest: Fit,
    /// The fit of what the first round began with.
    base: Fit,
}

impl Answer {
    /// Whether what remains beside the best set is at most about so many `times` the noise, and more than once.
    pub(super) fn leaves_what_may_be_noise(&self, times: f64) -> bool {
        let remains = self.decision.verdict.leaves_a_remainder();
        let sets = self.ladder.iter().map(|set| set.ratio);
        let least = sets.fold(self.decision.ratio.1, f64::min);
        remains && times > 1.0 && least <= NEARLY_NOISE * times
    }

    /// The base alone; `dataset` is what was decided with.
    pub(super) fn without_effects(mut self, dataset: &Dataset<'_>) -> Answer {
        self.decision.take_effects_back(dataset);
        self.ladder.retain(|set| set.ids.is_empty());
        self
    }

    /// Whether it explains nothing where another names a part: slow noise may be all that remains, but no reason to
    /// withhold what stands above it. A relaxation of cells, 98 % of their record, was.
    pub(super) fn takes_names_back(&self, other: &Answer) -> bool {
        self.decision.verdict == Verdict::Unexplained
            && other.decision.verdict == Verdict::PartlyExplained
    }
}

impl<'a> Rounds<'a> {
    /// The same with other noise floors.
    pub(super) fn with(&self, floors: &'a [NoiseFloor], correlation: f64) -> Rounds<'a> {
        Rounds {
            coarse: Dataset {
                floors,
                ..self.coarse
            },
            fine: Dataset {
                floors,
                ..self.fine
            },
            correlation,
            ..*self
        }
    }

    /// The same beside what is known of the numbers, at either resolution.
    pub(super) fn knowing(self, coarse: &'a Known, fine: &'a Known) -> Rounds<'a> {
        let mut knowing = self;
        (knowing.coarse.known, knowing.fine.known) = (Some(coarse), Some(fine));
        knowing
    }

    /// What is missing in an environment with effects.
    pub(super) fn answer(&self, environment: &Environment, given: &[Term]) -> Answer {
        let mut answer = self.round(environment, given, &Within::new(self.progress, 0.05, 0.9));
        for round in 1..MOST_ROUNDS {
            if !self.is_to_be_asked_again(&answer.decision) {
                break;
            }
            let from = 0.9 + 0.05 * (round - 1) as f64 / MOST_ROUNDS as f64;
            let progress = Within::new(self.progress, from, from + 0.05 / MOST_ROUNDS as f64);
            match self.with_more(&answer, &progress) {
                Some(more) => answer = more,
                None => break,
            }
        }
        answer
    }

    /// Whether what remains beside what is named is more than errors of its form: a friction that differs along the
    /// way left 1.3 times the noise beside Stribeck's, and a loading curve would have explained that. Of few effects only the
    /// first are wanted.
    fn is_to_be_asked_again(&self, decision: &Decision) -> bool {
        let is_far = decision.ratio.1.powi(2) > self.fine.thresholds.search.ran_away;
        let wants_more = self.most_added == MOST_ADDED;
        wants_more
            && is_far
            && decision.verdict == Verdict::PartlyExplained
            && !decision.without.is_empty()
    }

    /// One search and its decision.
    pub(super) fn round(
        &self,
        environment: &Environment,
        given: &[Term],
        progress: &dyn Progress,
    ) -> Answer {
        let screen = Screen::of(self.coarse.logs);
        let mut search = Search {
            dataset: self.coarse,
            screen: &screen,
            weights: vec![1.0; self.coarse.logs.iter().map(|log| log.len()).sum()],
            base: environment,
            given,
            ids: self.ids,
            most_added: self.most_added,
            progress,
            noise_cost: 0.0,
            tried: Vec::new(),
            correlation: self.correlation,
        };
        progress.at(0.0, "fitting the base");
        let base = search.base_fit();
        search.weigh(&base);
        let base = search.unstuck(search.refitted(&base));
        let base = search.with_forms_of_given(base);
        let result = search.run(base.clone());
        let ladder = search.ladder(&base, &result);
        let evidence = search.evidence(&base, &result);
        let closest = result.best.clone();
        progress.at(0.9, "held-out part and rivals");
        Answer {
            decision: decide(&self.fine, &base, result, &evidence),
            ladder,
            closest,
            base,
        }
    }

    /// The answer with what is named beside it where its effects are part of the model, if anything is.
    fn with_more(&self, answer: &Answer, progress: &dyn Progress) -> Option<Answer> {
        let before = &answer.decision;
        let named = &before.best;
        let shape = &named.shape;
        let environment = shape
            .base
            .with_values(&shape.environment_at(&named.numbers));
        let mut given = shape.terms_at(&named.numbers);
        given.iter_mut().for_each(|term| term.given = true);
        let more = self.round(&environment, &given, progress);
        if more.decision.without.is_empty() {
            return None;
        }
        let Answer {
            decision: beside,
            ladder,
            closest,
            ..
        } = more;
        // Only what the owner gave is given.
        let mut both = beside.best.clone();
        let was = both.shape.terms.iter_mut().zip(&shape.terms);
        was.for_each(|(term, before)| term.given = before.given);
        let evidence = [before.named_evidence(), beside.named_evidence()].concat();
        let mut decision = decide(
            &self.fine,
            &answer.base,
            SearchResult::alone(both),
            &evidence,
        );
        let is_more = decision.without.len() > before.without.len()
            && named
                .added_ids()
                .iter()
                .all(|id| decision.best.added_ids().contains(id));
        if !is_more {
            return None;
        }
        decision.join_alternatives(&[before, &beside]);
        let least_rmse_n = before.least_rmse_n.min(beside.least_rmse_n);
        decision.least_rmse_n = decision.least_rmse_n.min(least_rmse_n);
        Some(Answer {
            ladder: joined(&answer.ladder, ladder, &named.added_ids()),
            decision,
            closest,
            base: answer.base.clone(),
        })
    }
}

/// Sets that came closest in two rounds, those of the second beside what the first named.
fn joined(first: &[Candidate], mut second: Vec<Candidate>, named: &[EffectId]) -> Vec<Candidate> {
    for candidate in &mut second {
        candidate.ids.extend_from_slice(named);
        candidate.ids.sort();
    }
    second.extend_from_slice(first);
    second.sort_by(|a, b| a.ratio.total_cmp(&b.ratio));
    keep_first(&mut second, |candidate| candidate.ids.clone());
    second
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_of_a_second_round_stand_beside_what_the_first_named() {
        let (friction, drift) = (EffectId::CoulombFriction, EffectId::ForceDrift);
        let candidate = |ids: &[EffectId], ratio: f64| Candidate {
            ids: ids.to_vec(),
            ratio,
        };
        let first = [candidate(&[friction], 3.0), candidate(&[], 9.0)];
        // GIVEN the friction as the second round's base, and a drift beside it
        let second = vec![candidate(&[drift], 2.0), candidate(&[], 2.9)];
        let joined = joined(&first, second, &[friction]);
        // THEN each set stands once, with what it leaves at best.
        let ids: Vec<&[EffectId]> = joined.iter().map(|own| own.ids.as_slice()).collect();
        let both: [&[EffectId]; 3] = [&[friction, drift], &[friction], &[]];
        assert_eq!(ids, both);
        assert_eq!(joined[1].ratio, 2.9);
    }
}
