//! What a log says for and against the result of a replay, besides its parameters.

use estimator_core::Status;
use estimator_core::estimate::identify::method_info;
use estimator_core::physics::law::LawId;

use super::damping::{is_negative, taken_by_lateness};
use super::low_pass::may_be_the_filter;
use super::outcome::Outcome;
use super::reason::{EXPLAINED, Evidence, Reason};
use super::residual::surface_misfit;
use super::setup::has_no_zero;
use super::touches::departure;
use crate::inspect::{Inspection, refreshed::apart_s};
use crate::log::UniformLog;
use crate::replay::Replay;

/// A law that leaves so much less than another is clearly better.
const CLEARLY: f64 = 1.5;
/// A law that was chosen is not certain where another one, whose method has not converged, leaves so much less (two
/// modes for one: 0.6 %):
const NEARER: f64 = 1.005;
/// and where that is so much of the logarithm of the likelihood. Two modes, one of them left out: 22.3 and 20.0 mN over
/// 16 s, and K 1055 ± 6 N/m for 1500.
const NEARER_EVIDENCE: f64 = 20.0;
/// A force that falls by this share in a hold relaxes.
pub(crate) const RELAXES: f64 = 0.03;
/// A surface whose error may leave this share of the misfit may well be its cause.
pub(super) const SURFACE_SHARE: f64 = 0.5;
/// A surface is late if the force has left its baseline so many standard errors before it.
const LATE_SIGMAS: f64 = 3.0;
/// Exponents beyond these come from a fit that wanted to leave its bounds: the core's are 0.3 and 4, and no
/// contact that was ever measured lies between them and these.
const EXPONENTS: std::ops::Range<f64> = 0.4..3.9;
/// A material that relaxes by more than this share keeps no elastic force.
const MOST_RELAXING: f64 = 0.99;

/// Evidence on the result of a replay; `rmses_n` is what each law that was tried leaves over the whole log.
pub(super) fn evidence(
    log: &UniformLog,
    replay: &Replay,
    outcome: &Outcome,
    inspection: &Inspection,
    rmses_n: &[Option<f64>],
) -> Evidence {
    let misfit = outcome.force_rmse_n.map(|rmse| rmse / outcome.noise_n);
    let least = rmses_n
        .iter()
        .flatten()
        .copied()
        .fold(f64::INFINITY, f64::min);
    let whole = outcome.whole_log_rmse_n.unwrap_or(0.0);
    let samples: usize = replay.contacts().iter().map(|touch| touch.len()).sum();
    // Of a log of two materials the whole is another's, too.
    let of_this_material = outcome.force_rmse_n.unwrap_or(0.0);
    // Noise of the position is noise of the force times the stiffness, and a law with a memory fits some of it: 15 µm on
    // 1 N/mm made a relaxation of 0.42 ± 0.03. Three standard errors of what N samples of noise leave.
    let exceeds_noise =
        of_this_material > outcome.allowed_n * (1.0 + 3.0 / (2.0 * samples.max(1) as f64).sqrt());
    let decays = |relaxed: f64| relaxed > RELAXES;
    // A surface taken from the impact is late by what the noise hides, and its method says so.
    let finds_surface = method_info(replay.config.method).is_some_and(|info| info.finds_surface);
    let explained = misfit.is_none_or(|misfit| misfit <= EXPLAINED);
    Evidence {
        told: outcome.method_reason,
        misfit,
        explained: EXPLAINED,
        is_saturated: inspection.saturated_n.is_some(),
        has_no_zero: has_no_zero(log),
        drifts: false,
        has_other_force: false,
        is_dented: false,
        is_at_bound: is_at_bound(outcome) || is_negative(outcome),
        lateness: match is_filter(log, outcome) {
            true => Some(Reason::Lag),
            false => is_apart(log, outcome).then_some(Reason::Skew),
        },
        relaxes: !outcome.law.law().info().relaxes
            && inspection.holds.iter().any(|hold| decays(hold.relaxed)),
        has_better_law: whole > CLEARLY * least && exceeds_noise,
        has_nearer_law: whole > NEARER * least
            && exceeds_noise
            && samples as f64 * (whole / least).ln() > NEARER_EVIDENCE,
        is_surface_doubtful: (finds_surface || !explained) && is_surface_late(log, replay, outcome)
            || !explained && is_surface_the_cause(replay, outcome),
    }
}

/// Whether one of the channels is refreshed so slowly that Kelvin and Voigt's damping feels it, which no fit can tell: a
/// position that was new once in 5 ms made 12 N s/m of 10.
fn is_apart(log: &UniformLog, outcome: &Outcome) -> bool {
    outcome.law.law() == LawId::KelvinVoigt
        && apart_s(log).is_some_and(|apart_s| taken_by_lateness(outcome, apart_s).is_some())
}

/// Whether a relaxation may be that of the low-pass that the force went through: a spring and a damper
/// behind 20 to 100 Hz were a solid of up to three times the stiffness.
fn is_filter(log: &UniformLog, outcome: &Outcome) -> bool {
    let rates = ["relaxation_rate_1", "relaxation_rate_2"];
    let rate = |name: &str| outcome.value(name).map(|found| f64::from(found.value));
    rates
        .into_iter()
        .filter_map(rate)
        .any(|own| may_be_the_filter(log, own))
}

fn is_at_bound(outcome: &Outcome) -> bool {
    let value = |name: &str| outcome.value(name).map(|found| f64::from(found.value));
    let fractions = ["relaxation_fraction_1", "relaxation_fraction_2"];
    let relaxing: f64 = fractions.into_iter().filter_map(value).sum();
    value("exponent").is_some_and(|n| !EXPONENTS.contains(&n)) || relaxing > MOST_RELAXING
}

/// By how much the surface that was found lies behind where the force has left its baseline (m), a sample of that
/// approach aside; 0 where it does not.
pub(super) fn surface_late_m(log: &UniformLog, replay: &Replay, outcome: &Outcome) -> f64 {
    let touched = outcome.status != Status::NoContact;
    let both = outcome.value("surface").zip(departure(log, replay));
    both.filter(|_| touched).map_or(0.0, |(surface, left)| {
        (f64::from(surface.value) - left.to_m - left.step_m).max(0.0)
    })
}

fn is_surface_late(log: &UniformLog, replay: &Replay, outcome: &Outcome) -> bool {
    let error_m = outcome
        .value("surface")
        .map_or(0.0, |found| found.std_error.into());
    surface_late_m(log, replay, outcome) > LATE_SIGMAS * error_m
}

fn is_surface_the_cause(replay: &Replay, outcome: &Outcome) -> bool {
    let rmse = outcome.force_rmse_n.unwrap_or(f64::INFINITY);
    surface_misfit(replay, outcome.law, &outcome.parameters)
        .is_some_and(|share| share > SURFACE_SHARE * rmse)
}
