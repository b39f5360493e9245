//! What a damping takes on of forces that are none of a damper.

use estimator_core::Status;
use estimator_core::physics::law::LawId;

use super::low_pass::delay_s;
use super::outcome::Outcome;
use crate::log::UniformLog;
use crate::replay::Replay;
use crate::signal;

/// So much of a count a position may read too little on the way in and too much on the way out: presses of 0.27 mm/s in
/// counts of 10 µm had 4.0 ± 0.4 N s/m for 10, which 0.16 of a count explains.
const OF_A_COUNT: f64 = 0.15;

/// A damping is hidden by the counts of an encoder where they may be this share of it: an error of a fifth that may be any.
const HIDDEN: f64 = 0.2;
/// So much of the damping matters: what is off by more is wrong by the fault table's rule.
pub(super) const MATTERS: f64 = 0.05;

/// An instant in contact.
pub(super) struct Instant {
    /// Since the touch began (s).
    pub(super) since_s: f64,
    pub(super) speed_mps: f64,
    /// Slope of the law (N/m).
    slope: f64,
}

/// What the damping takes on of another force (N), as a share of the damping: its regression on the damping's force.
/// `None` of a law that has no damping.
pub(super) fn carried(
    replay: &Replay,
    outcome: &Outcome,
    other: impl Fn(&Instant) -> f64,
) -> Option<f64> {
    let value = |name: &str| outcome.value(name).map(|found| f64::from(found.value));
    let damping = value("damping").filter(|_| value("second_stiffness").is_none())?;
    let stiffness = value("stiffness")?;
    let exponent = value("exponent");
    let reference_m = f64::from(replay.config.reference.depth_m);
    let (mut both, mut square) = (0.0, 0.0);
    for touch in replay.contacts() {
        for at in touch.clone() {
            let speed_mps = f64::from(replay.records.speed_mps(at));
            let depth = replay.final_depth_m(at).max(0.0) / reference_m;
            let shape = depth.powf(exponent.unwrap_or(0.0));
            let slope = match exponent {
                Some(n) if depth > 0.0 => n * stiffness * shape / depth,
                Some(_) => 0.0,
                None => stiffness,
            };
            let force_n = damping * speed_mps * shape;
            let since_s = replay.time_s(at) - replay.time_s(touch.start);
            both += force_n
                * other(&Instant {
                    since_s,
                    speed_mps,
                    slope,
                });
            square += force_n * force_n;
        }
    }
    (square > 0.0).then(|| both / square)
}

/// Whether the damping is negative, which no material's is, by so many standard errors.
pub(super) fn is_negative(outcome: &Outcome) -> bool {
    const SIGMAS: f32 = 3.0;
    let damping = outcome.value("damping");
    damping.is_some_and(|own| own.value < -SIGMAS * own.std_error)
}

/// What a lateness (s) takes off Kelvin and Voigt's damping (N s/m), where that matters: λ − KT, at every depth.
pub(super) fn taken_by_lateness(outcome: &Outcome, late_s: f64) -> Option<f64> {
    let value = |name: &str| outcome.value(name).map(|found| f64::from(found.value));
    if outcome.law.law() != LawId::KelvinVoigt {
        return None;
    }
    let taken = late_s * value("stiffness")?;
    (taken > MATTERS * value("damping")?.abs()).then_some(taken)
}

/// Widens the error of Kelvin and Voigt's damping by what a low-pass may take off it: whether it delays is not told.
pub(super) fn widen_by_low_pass(log: &UniformLog, outcome: &mut Outcome) {
    let taken = delay_s(log).and_then(|late_s| taken_by_lateness(outcome, late_s));
    outcome.widen_one("damping", taken.unwrap_or(0.0));
}

/// Widens the error of the damping by what an encoder with counts may do to it, and says where that hides it: then it has
/// not converged.
pub(super) fn widen_by_counts(
    log: &UniformLog,
    replay: &Replay,
    outcome: &mut Outcome,
) -> Option<String> {
    outcome.widen_one("damping", error_of_counts(log, replay, outcome)?);
    let damping = outcome.value("damping")?;
    let is_hidden = f64::from(damping.std_error) > HIDDEN * f64::from(damping.value.abs());
    (is_hidden && outcome.method_status == Status::Converged).then(|| {
        outcome.method_status = Status::Converging;
        "the motion is so slow for the counts of its encoder that the damping is hardly known: press faster, or read the \
         position finer"
            .into()
    })
}

/// What an encoder with counts may do to the damping (N s/m); `None` where the position has none. A count that lasts no
/// longer than the filter's delay is averaged.
fn error_of_counts(log: &UniformLog, replay: &Replay, outcome: &Outcome) -> Option<f64> {
    let count_m = signal::step(&log.position_m)?;
    let averaged_s = replay.delay as f64 * replay.period_s;
    let late = |now: &Instant| match now.speed_mps {
        0.0 => 0.0,
        speed_mps => {
            let lasts_s = count_m / speed_mps.abs();
            let share = lasts_s / (lasts_s + averaged_s);
            now.slope * OF_A_COUNT * count_m * share * speed_mps.signum()
        }
    };
    let damping = f64::from(outcome.value("damping")?.value);
    Some((damping * carried(replay, outcome, late)?).abs())
}
