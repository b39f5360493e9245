//! What a reader must know before using the numbers: why a law cannot fit, and where its parameters
//! come from.

use estimator_core::config::Surface;
use estimator_core::{LawKind, Status};

use super::outcome::Outcome;
use crate::inspect::{Inspection, suspicions};
use crate::log::UniformLog;
use crate::replay::Replay;

/// A force that falls by this share in a hold relaxes.
const RELAXES: f64 = 0.03;
/// A law that leaves this many times the noise does not explain the force.
const EXPLAINED: f64 = 3.0;

/// The sentences for one estimate.
pub fn explain(
    log: &UniformLog,
    replay: &Replay,
    outcome: &Outcome,
    inspection: &Inspection,
) -> Vec<String> {
    let mut notes = suspicions(log);
    notes.extend(contact(outcome, inspection));
    notes.extend(misfit(outcome, inspection));
    notes.extend(relaxation(outcome, inspection));
    notes.extend(adhesion(outcome, inspection));
    notes.extend(surface(replay, outcome));
    if let Some(limit) = inspection.saturated_n {
        notes.push(format!(
            "the force stands still at its largest value, {limit:.4} N: the channel saturates there"
        ));
    }
    notes
}

fn contact(outcome: &Outcome, inspection: &Inspection) -> Option<String> {
    outcome.touches.is_empty().then(|| {
        format!(
            "no contact: the force never rose above six standard deviations of its noise, {:.2e} N",
            6.0 * inspection.noise_n
        )
    })
}

fn misfit(outcome: &Outcome, inspection: &Inspection) -> Option<String> {
    let rmse = outcome.force_rmse_n?;
    let multiple = rmse / inspection.noise_n;
    (multiple > EXPLAINED).then(|| {
        format!(
            "{} leaves {rmse:.3e} N rms in contact, {multiple:.0} times the noise: it does not explain \
             this force, and its parameters describe it only on average",
            outcome.law.name()
        )
    })
}

fn relaxation(outcome: &Outcome, inspection: &Inspection) -> Option<String> {
    if !matches!(outcome.law, LawKind::KelvinVoigt | LawKind::HuntCrossley) {
        return None;
    }
    let hold = inspection
        .holds
        .iter()
        .max_by(|a, b| a.relaxed.total_cmp(&b.relaxed))?;
    (hold.relaxed > RELAXES).then(|| {
        format!(
            "the force relaxes by {:.0} % during the hold from {:.3} to {:.3} s: {} has no \
             relaxation, so its stiffness lies between that of the stroke and that of the hold",
            100.0 * hold.relaxed,
            hold.from_s,
            hold.to_s,
            outcome.law.name()
        )
    })
}

fn adhesion(outcome: &Outcome, inspection: &Inspection) -> Option<String> {
    (inspection.pull_n > 0.0 && !outcome.touches.is_empty()).then(|| {
        format!(
            "the contact pulls with up to {:.3e} N: adhesion, which the law does not have",
            inspection.pull_n
        )
    })
}

fn surface(replay: &Replay, outcome: &Outcome) -> Option<String> {
    let surface = outcome.value("surface")?;
    if replay.config.contact.surface != Surface::AtImpact || outcome.status == Status::NoContact {
        return None;
    }
    Some(format!(
        "the surface is taken from the impact, known to {:.1e} m: an error of it bends stiffness, \
         damping and exponent together, and their standard errors include it (--surface gives the \
         true position)",
        surface.std_error
    ))
}
