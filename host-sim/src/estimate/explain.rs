//! What a reader must know before using the numbers: why a law cannot fit, and where its parameters
//! come from.

use estimator_core::Status;
use estimator_core::estimate::{config::Surface, identify::method_info};
use estimator_core::physics::law::LawId;

use super::evidence::{RELAXES, SURFACE_SHARE};
use super::outcome::Outcome;
use super::reason::EXPLAINED;
use super::residual::surface_misfit;
use crate::inspect::{Inspection, suspicions};
use crate::log::UniformLog;
use crate::model::law_title;
use crate::number::quantity;
use crate::replay::Replay;
use crate::stats::highest;

/// The sentences for one estimate.
pub fn explain(
    log: &UniformLog,
    replay: &Replay,
    outcome: &Outcome,
    inspection: &Inspection,
) -> Vec<String> {
    let mut notes = suspicions(log);
    notes.extend(contact(log, replay, outcome, inspection));
    notes.extend(misfit(replay, outcome));
    notes.extend(relaxation(outcome, inspection));
    notes.extend(adhesion(outcome, inspection));
    notes.extend(surface(replay, outcome));
    if let Some(limit) = inspection.saturated_n {
        notes.push(format!(
            "the force stays at its largest value, {}: the channel saturates there",
            quantity(limit, 4, "N")
        ));
    }
    notes
}

fn contact(
    log: &UniformLog,
    replay: &Replay,
    outcome: &Outcome,
    inspection: &Inspection,
) -> Option<String> {
    if !outcome.touches.is_empty() {
        return None;
    }
    Some(match replay.config.contact.surface {
        Surface::Known { position_m } => {
            let farthest = log.position_m.iter().copied();
            format!(
                "no contact: the surface is given at {}, and the probe came no farther than {}",
                quantity(f64::from(position_m), 4, "m"),
                quantity(highest(farthest), 4, "m")
            )
        }
        Surface::AtImpact => format!(
            "no contact: the force never rose above its noise in free air ({} rms)",
            quantity(inspection.noise_n, 2, "N")
        ),
    })
}

fn misfit(replay: &Replay, outcome: &Outcome) -> Option<String> {
    let rmse = outcome.force_rmse_n?;
    if rmse <= EXPLAINED * replay.noise_n {
        return None;
    }
    let leaves = format!(
        "{} leaves {} rms in contact, {} the noise",
        law_title(outcome.law.name()),
        quantity(rmse, 3, "N"),
        times(rmse / replay.noise_n),
    );
    let surface = surface_misfit(replay, outcome.law, &outcome.parameters)
        .filter(|share| *share > SURFACE_SHARE * rmse);
    Some(match surface {
        Some(share) => format!(
            "{leaves}: but the uncertainty of the surface alone may leave {}; give its position \
             (--surface) before doubting the law",
            quantity(share, 2, "N")
        ),
        None => format!(
            "{leaves}: it does not explain this force, and its parameters describe it only on average"
        ),
    })
}

/// "4.5 ×", "220 ×": more digits mean nothing.
pub(crate) fn times(ratio: f64) -> String {
    match ratio {
        ratio if ratio.is_infinite() => "∞ ×".into(),
        ratio if ratio < 10.0 => format!("{ratio:.1} ×"),
        ratio => format!("{ratio:.0} ×"),
    }
}

/// The same where a noise follows: "4.5 × the noise", "any multiple of the noise" where that is zero.
pub(crate) fn multiple(ratio: f64) -> String {
    if ratio.is_infinite() {
        return "any multiple of".into();
    }
    times(ratio)
}

fn relaxation(outcome: &Outcome, inspection: &Inspection) -> Option<String> {
    if outcome.law.law().info().relaxes {
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
            law_title(outcome.law.name())
        )
    })
}

fn adhesion(outcome: &Outcome, inspection: &Inspection) -> Option<String> {
    (inspection.pull_n > 0.0 && !outcome.touches.is_empty()).then(|| {
        format!(
            "the force falls to {} below rest: adhesion (or friction, or a moving resting force), which the \
             law does not have",
            quantity(inspection.pull_n, 3, "N")
        )
    })
}

fn surface(replay: &Replay, outcome: &Outcome) -> Option<String> {
    let surface = outcome.value("surface")?;
    let found = method_info(replay.config.method).is_some_and(|info| info.finds_surface);
    let known = replay.config.contact.surface != Surface::AtImpact;
    if found || known || outcome.status == Status::NoContact {
        return None;
    }
    let error_m = f64::from(surface.std_error);
    let known = match error_m > 0.0 {
        true => format!(", known to {}", quantity(error_m, 2, "m")),
        false => ", which came too suddenly to say how well it is known".into(),
    };
    let bent = match outcome.law.law() {
        LawId::KelvinVoigt => "stiffness and damping",
        LawId::HuntCrossley => "stiffness, damping and exponent together",
        LawId::Zener => "the resting stiffness",
        LawId::QuasiLinear => "stiffness and exponent together",
        _ => "the parameters",
    };
    Some(format!(
        "the surface is taken from the impact{known}: an error of it bends {bent}, and their \
         standard errors include it (--surface gives the true position)"
    ))
}
