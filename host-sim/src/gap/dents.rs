//! A surface that has not come back when it is touched again.
//!
//! What relaxes recovers as slowly, and nothing pulls its surface back: a dent stays, which fills as the material creeps.
//! The chapter's laws have a surface that follows the probe. No effect of the catalogue is a dent; where a model that
//! relaxes leaves something, or needs effects that it does not need with a dent, it is asked again with one.

use estimator_core::physics::effect::EffectId;
use estimator_core::physics::law::Recovery;

use super::finding::{Finding, Verdict};
use crate::diagnostic::Diagnostic;
use crate::model::Model;
use crate::number::quantity;

/// A dent leaves less than this share (rms) of what is left without one. Not measured; a Zener solid that was left alone for
/// 0.6 of its retardation time left 0.3.
const LESS: f64 = 0.8;
/// With fewer effects it may leave so many times as much. Derived: a tenth of the squares, as for a zero that steps.
const AS_MUCH: f64 = 1.05;

/// The finding with a dent between touches where that is better; `ask` finds what is missing, and `left_n` fits a model
/// alone and says what it leaves (N rms).
///
/// # Errors
/// Those of `ask` and `left_n`.
pub(super) fn allowed_for(
    model: &Model,
    ask: impl Fn(&Model) -> Result<Finding, Diagnostic>,
    left_n: impl Fn(&Model) -> Result<f64, Diagnostic>,
) -> Result<Finding, Diagnostic> {
    let finding = ask(model)?;
    let is_given = model.environment.recovery.is_some();
    if is_given || finding.verdict == Verdict::NoMissingEffect || !relaxes(&finding) {
        return Ok(finding);
    }
    let creeping = creeping(model);
    let spares = left_n(&creeping)? < AS_MUCH * finding.rmse_after_n;
    if !spares && left_n(&self::creeping(&finding.model))? > LESS * finding.rmse_after_n {
        return Ok(finding);
    }
    let mut dented = ask(&creeping)?;
    if !is_better(&dented, &finding) {
        return Ok(finding);
    }
    dented.notes.insert(
        0,
        format!(
            "the material was touched again before it had recovered: its surface creeps back (`recovery = \"creep\"`); with \
             one that follows the probe {} would be left",
            quantity(finding.rmse_after_n, 3, "N")
        ),
    );
    Ok(dented)
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

/// Whether a finding leaves much less than another, or no more with fewer effects.
fn is_better(dented: &Finding, other: &Finding) -> bool {
    let left = dented.rmse_after_n / other.rmse_after_n;
    left < LESS || left < AS_MUCH && dented.effects.len() < other.effects.len()
}
