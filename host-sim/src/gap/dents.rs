//! A surface that has not come back when it is touched again.
//!
//! What relaxes recovers as slowly, and nothing pulls its surface back: a dent stays, which fills as the material creeps.
//! The chapter's laws have a surface that follows the probe. No effect of the catalogue is a dent; where a model that
//! relaxes leaves something, or less with a dent, or needs effects that it does not need with one, it is asked with one:
//! first, where the model alone leaves less with one.

use estimator_core::physics::effect::EffectId;
use estimator_core::physics::law::Recovery;

use super::finding::{Finding, Verdict};
use super::search::run::MOST_ADDED;
use crate::diagnostic::Diagnostic;
use crate::model::Model;
use crate::number::quantity;

/// A dent leaves less than this share (rms) of what is left without one. Not measured; a Zener solid that was left alone for
/// 0.6 of its retardation time left 0.3.
const LESS: f64 = 0.8;
/// Beside the same effects, where what is left without one passes for noise, it leaves less than this share. Derived: 2 % of
/// the squares of 500 independent samples, ten times what chance takes. Without it a stiffness was 5 standard errors off, a
/// relaxation 6.
pub(super) const SLIGHTLY_LESS: f64 = 0.99;
/// A dent is looked for first if a model alone leaves less than this share (rms) with one. Of 23 rigs with a dent in whatever
/// relaxes 0.5 to 0.94.
const LIKELY: f64 = 0.95;
/// With fewer effects it may leave so many times as much; with others that are no more, and explain the log, it leaves less
/// by as much. Derived: a tenth of the squares, as for a zero that steps. Beside a dent a friction was Coulomb's and left 0.88
/// times what a loop of Bouc and Wen's did without one.
const AS_MUCH: f64 = 1.05;

/// The finding with a dent between touches where that is better. `ask` finds what is missing, from a first search where that
/// is known; `once` finds at most so many effects with one search, and `alone` fits a model to which nothing is added.
///
/// # Errors
/// Those of `ask`, `once` and `alone`.
pub(super) fn allowed_for(
    model: &Model,
    ask: impl Fn(&Model, Option<Finding>) -> Result<Finding, Diagnostic>,
    once: impl Fn(&Model, usize) -> Result<Finding, Diagnostic>,
    alone: impl Fn(&Model) -> Result<Finding, Diagnostic>,
) -> Result<Finding, Diagnostic> {
    if model.environment.recovery.is_some() {
        return ask(model, None);
    }
    let creeping = creeping(model);
    let creeping_alone = match model.environment.law.info().relaxes {
        true => Some(alone(&creeping)?),
        false => None,
    };
    let first = match &creeping_alone {
        Some(creeping_alone) if is_likely(creeping_alone, &alone(model)?) => {
            Some(once(&creeping, MOST_ADDED)?)
        }
        _ => None,
    };
    if let Some(dented) = &first
        && let Some(undented_n) = undented_n(dented, model, once)?
    {
        return Ok(with_note(dented.clone(), undented_n));
    }
    let finding = ask(model, None)?;
    if !relaxes(&finding) {
        return Ok(finding);
    }
    let creeping_alone = match creeping_alone {
        Some(known) => known,
        None => alone(&creeping)?,
    };
    let most_n = AS_MUCH * finding.rmse_after_n;
    let is_complete = finding.verdict == Verdict::NoMissingEffect;
    let spares = !is_complete && creeping_alone.rmse_before_n < most_n;
    let less = match is_explained(&finding) {
        true => SLIGHTLY_LESS,
        false => LESS,
    };
    let left_n = || alone(&self::creeping(&finding.model)).map(|own| own.rmse_before_n);
    if !spares && left_n()? > less * finding.rmse_after_n {
        return Ok(finding);
    }
    let dented = ask(&creeping, first)?;
    if !is_better(&dented, &finding) {
        return Ok(finding);
    }
    Ok(with_note(dented, finding.rmse_after_n))
}

/// What a search for as few effects without a dent leaves (N rms), where with one the log is explained to its noise, and
/// without one not as well. `None` where that is not so. What has a dent is not explained without, and the whole search for
/// that took ten times as long.
fn undented_n(
    dented: &Finding,
    model: &Model,
    once: impl Fn(&Model, usize) -> Result<Finding, Diagnostic>,
) -> Result<Option<f64>, Diagnostic> {
    if !is_explained(dented) {
        return Ok(None);
    }
    let other = once(model, dented.effects.len())?;
    let needs_dent = match other.verdict {
        Verdict::NoMissingEffect => false,
        Verdict::Unexplained | Verdict::PartlyExplained => true,
        _ => is_better(dented, &other),
    };
    Ok(needs_dent.then_some(other.rmse_after_n))
}

/// Whether a model alone leaves less with a dent, of the held-out part or of the whole log. What else is missing may spoil
/// the one and not the other: beside a permanent set a dent left 1.2 times as much of what was held out, and 0.6 times as
/// much of the log.
fn is_likely(creeping: &Finding, following: &Finding) -> bool {
    creeping.rmse_before_n < LIKELY * following.rmse_before_n
        || creeping.whole_n() < LIKELY * following.whole_n()
}

/// The finding with a note of the dent, and of what is left (N rms) without one.
fn with_note(mut dented: Finding, undented_n: f64) -> Finding {
    dented.notes.insert(
        0,
        format!(
            "the material was touched again before it had recovered: its surface creeps back (`recovery = \"creep\"`); with \
             one that follows the probe {} would be left",
            quantity(undented_n, 3, "N")
        ),
    );
    dented
}

/// The model with a surface that creeps back.
fn creeping(model: &Model) -> Model {
    let mut creeping = model.clone();
    creeping.environment.recovery = Some(Recovery::ByCreep);
    creeping
}

/// Whether anything of what was found, or that came near, relaxes.
fn relaxes(finding: &Finding) -> bool {
    let near = finding.ladder.first().into_iter().flat_map(|own| &own.ids);
    let effects = finding.model.effects.iter().map(|own| own.id.as_str());
    finding.model.environment.law.info().relaxes
        || effects
            .chain(near.map(|id| id.name()))
            .any(|id| id == EffectId::StressRelaxation.name())
}

/// Whether a log is explained to its noise.
fn is_explained(finding: &Finding) -> bool {
    matches!(
        finding.verdict,
        Verdict::NoMissingEffect | Verdict::MissingEffects
    )
}

/// Whether a finding leaves much less than another, or no more with fewer effects, or clearly less with no more where it
/// explains the log, or less with the same where what the other leaves passes for noise.
fn is_better(dented: &Finding, other: &Finding) -> bool {
    let left = dented.rmse_after_n / other.rmse_after_n;
    let ids = |finding: &Finding| -> Vec<_> {
        let mut ids: Vec<_> = finding.effects.iter().map(|effect| effect.id).collect();
        ids.sort();
        ids
    };
    let (own, others) = (dented.effects.len(), other.effects.len());
    left < LESS
        || left < AS_MUCH && own < others
        || left * AS_MUCH < 1.0 && own <= others && is_explained(dented)
        || left < SLIGHTLY_LESS && is_explained(other) && ids(dented) == ids(other)
}
