//! What is new on a rig whose model says what it left when it was identified.
//!
//! A measured record keeps a remainder that nothing in the catalogue explains, and against the floor alone sets of
//! effects that follow the remainder stand beside the one that is new: with a friction put into a foam's record, four
//! effects without a friction left a quarter of what the model itself had left before. What the model left is therefore
//! allowed for first, as a coloured process beside the noise, and an effect is new where the log leaves clearly more
//! without it. If nothing is, the log is asked as any other.

use std::borrow::Cow;

use super::finding::Verdict;
use super::model::shape::Term;
use super::noise::floor::NoiseFloor;
use super::noise::floors::largest_correlation;
use super::options::Options;
use super::progress::Within;
use super::rounds::{Answer, Rounds};
use crate::log::UniformLog;
use crate::model::{Environment, Model, Remainder};

/// What a user is told where the remainder was allowed for.
pub(super) const NOTE: &str = "what the model left when it was identified is allowed for";

/// What a model left when it was identified, in logs with these rates (Hz) of which the search takes every `step`-th
/// sample.
pub(super) struct AsIdentified {
    remainder: Remainder,
    rates_hz: Vec<f64>,
    step: usize,
}

impl AsIdentified {
    /// `None` if the model does not say what it left, or forces went through another low-pass then.
    pub(super) fn of(
        model: &Model,
        options: &Options,
        logs: &[Cow<'_, UniformLog>],
        step: usize,
    ) -> Option<AsIdentified> {
        let remainder = model.remainder?;
        (remainder.bandwidth_hz == options.bandwidth_hz).then(|| AsIdentified {
            remainder,
            rates_hz: logs.iter().map(|log| log.rate_hz).collect(),
            step,
        })
    }

    /// What is new in an environment with effects, if anything is. `rounds` have the floors without the remainder.
    pub(super) fn answer(
        &self,
        rounds: &Rounds<'_>,
        environment: &Environment,
        given: &[Term],
    ) -> Option<Answer> {
        let each = rounds.fine.floors.iter().zip(&self.rates_hz);
        let floors: Vec<NoiseFloor> = each
            .map(|(floor, rate_hz)| floor.beside(&self.remainder, *rate_hz))
            .collect();
        let explained = rounds.fine.thresholds.explained;
        let most = explained.coloured * explained.residuals;
        let mut thresholds = *rounds.fine.thresholds;
        // What explains the log as well as the model did before suffices.
        thresholds.explained.nothing_more = explained.sufficient;
        let correlation = largest_correlation(&floors, self.step);
        let mut beside = rounds.with(&floors, correlation);
        (beside.coarse.thresholds, beside.fine.thresholds) = (&thresholds, &thresholds);
        let progress = Within::new(rounds.progress, 0.05, 0.5);
        let mut answer = beside.round(environment, given, &progress);
        let decision = &mut answer.decision;
        let is_explained = matches!(
            decision.verdict,
            Verdict::MissingEffects | Verdict::Ambiguous
        );
        // One thing is new, whatever is open beside it. Several follow the remainder where it is not alike everywhere:
        // under a cantilever a curve that snaps stood beside seven of eighteen effects.
        let certain = decision.alternatives.iter().filter(|own| own.is_empty());
        let is_new = decision.ratio.0 > most && is_explained && certain.count() == 1;
        is_new.then(|| {
            answer.decision.stand_beside_remainder(&rounds.fine);
            answer
        })
    }
}
