//! What a reader must know before using the numbers: why a law cannot fit, and where its parameters
//! come from.

use estimator_core::Status;
use estimator_core::estimate::{config::Surface, identify::method_info};
use estimator_core::physics::law::LawId;

use super::damping::taken_by_lateness;
use super::evidence::{RELAXES, SURFACE_SHARE};
use super::outcome::Outcome;
use super::reason::{EXPLAINED, NOISE_ALONE};
use super::residual::surface_misfit;
use super::stiffening::stiffening;
use crate::inspect::{Inspection, suspicions};
use crate::log::{Channel, UniformLog};
use crate::model::law_title;
use crate::number::quantity;
use crate::replay::Replay;
use crate::stats::{highest, lowest};

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
    notes.extend(counts(replay, outcome));
    notes.extend(relaxation(outcome, inspection));
    notes.extend(stiffening(&outcome.touches, outcome.law.law()));
    notes.extend(adhesion(outcome, inspection));
    notes.extend(surface(replay, outcome));
    notes.extend(simultaneity(outcome));
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
            "no contact: the force never rose above its noise in free air ({} rms){}",
            quantity(inspection.noise_n, 2, "N"),
            both_reversed(log).unwrap_or_default()
        ),
    })
}

/// What a log looks like whose position and force both have the other sign: pulled where it is farthest out.
fn both_reversed(log: &UniformLog) -> Option<String> {
    let lowest_n = lowest(log.force_n.iter().copied());
    let noise_n = log.force_noise_n();
    let pulls = -lowest_n > 20.0 * noise_n.max(highest(log.force_n.iter().copied()) / 20.0);
    pulls.then(|| {
        let remedy = log
            .columns()
            .option(&[(Channel::Position, -1.0), (Channel::Force, -1.0)]);
        format!(
            ", but fell to {}: if that is the contact, position and force both have the other sign ({remedy})",
            quantity(lowest_n, 3, "N")
        )
    })
}

fn misfit(replay: &Replay, outcome: &Outcome) -> Option<String> {
    let rmse = outcome.force_rmse_n?;
    if rmse <= EXPLAINED * outcome.noise_n {
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

/// What the counts of the position leave of the force of a stiff contact, where that is more than noise.
fn counts(replay: &Replay, outcome: &Outcome) -> Option<String> {
    let rmse_n = outcome.force_rmse_n?;
    let needs =
        rmse_n > NOISE_ALONE * replay.noise_n && outcome.noise_n > NOISE_ALONE * replay.noise_n;
    needs.then(|| {
        format!(
            "a count of the position times the stiffness is {} of force (rms, with its noise): as much may remain",
            quantity(outcome.noise_n, 2, "N")
        )
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

/// What a millisecond of skew would do to the damping of a contact whose damping nothing else tells from a delay: with
/// Kelvin and Voigt's law a force that is late by T leaves λ − KT, at every depth.
fn simultaneity(outcome: &Outcome) -> Option<String> {
    const SKEW_S: f64 = 1e-3;
    if outcome.skew.is_some() {
        return None;
    }
    taken_by_lateness(outcome, SKEW_S).map(|taken| {
        format!(
            "the damping takes force and position for read at the same instant: a force that is {} late takes {} off it, \
             and with this law the log does not tell which of the two it is",
            quantity(SKEW_S, 1, "s"),
            quantity(taken, 2, "N s/m")
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::Log;

    #[test]
    fn a_log_that_only_pulls_may_have_both_signs_reversed() {
        let t: Vec<f64> = (0..2000).map(|i| f64::from(i) * 1e-3).collect();
        let depth = |t: &f64| -2e-3 * (std::f64::consts::TAU * t).cos();
        let x: Vec<f64> = t.iter().map(depth).collect();
        let force = |sign: f64| x.iter().map(move |x| sign * 2000.0 * (sign * x).max(0.0));
        let log = |sign| {
            let log = Log::from_channels(t.clone(), x.clone(), force(sign).collect());
            log.uniform().unwrap()
        };
        let found = both_reversed(&log(-1.0)).unwrap();
        assert!(
            found.contains("fell to −4.00") && found.contains("x=-x_m,f=-f_n"),
            "{found}"
        );
        assert_eq!(both_reversed(&log(1.0)), None);
    }
}
