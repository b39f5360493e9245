//! What a damping takes on of forces that are none of a damper.

use super::outcome::Outcome;
use crate::log::UniformLog;
use crate::replay::Replay;
use crate::signal;

/// So much of a count a position may read too little on the way in and too much on the way out: presses of 0.27 mm/s in
/// counts of 10 µm had 4.0 ± 0.4 N s/m for 10, which 0.16 of a count explains.
const OF_A_COUNT: f64 = 0.15;

/// What the damping takes on of another force, as a share of the damping: its regression on the damping's force.
/// `other` (N) is asked with a record, the first one of its touch, the slope of the law there (N/m) and the speed (m/s).
/// `None` of a law that has no damping.
pub(super) fn carried(
    replay: &Replay,
    outcome: &Outcome,
    other: impl Fn(usize, usize, f64, f64) -> f64,
) -> Option<f64> {
    let value = |name: &str| outcome.value(name).map(|found| f64::from(found.value));
    let damping = value("damping").filter(|_| value("second_stiffness").is_none())?;
    let stiffness = value("stiffness")?;
    let exponent = value("exponent");
    let reference_m = f64::from(replay.config.reference.depth_m);
    let (mut both, mut square) = (0.0, 0.0);
    for touch in replay.contacts() {
        for at in touch.clone() {
            let speed = f64::from(replay.records.speed_mps(at));
            let depth = replay.final_depth_m(at).max(0.0) / reference_m;
            let shape = depth.powf(exponent.unwrap_or(0.0));
            let slope = match exponent {
                Some(n) if depth > 0.0 => n * stiffness * shape / depth,
                Some(_) => 0.0,
                None => stiffness,
            };
            let force_n = damping * speed * shape;
            both += force_n * other(at, touch.start, slope, speed);
            square += force_n * force_n;
        }
    }
    (square > 0.0).then(|| both / square)
}

/// What an encoder with counts may do to the damping (N s/m); `None` where the position has none. A count that lasts no
/// longer than the filter's delay is averaged.
pub(super) fn error_of_counts(log: &UniformLog, replay: &Replay, outcome: &Outcome) -> Option<f64> {
    let count_m = signal::step(&log.position_m)?;
    let averaged_s = replay.delay as f64 * replay.period_s;
    let late = |_: usize, _: usize, slope: f64, speed: f64| match speed {
        0.0 => 0.0,
        _ => {
            let lasts_s = count_m / speed.abs();
            slope * OF_A_COUNT * count_m * lasts_s / (lasts_s + averaged_s) * speed.signum()
        }
    };
    let damping = f64::from(outcome.value("damping")?.value);
    Some((damping * carried(replay, outcome, late)?).abs())
}
