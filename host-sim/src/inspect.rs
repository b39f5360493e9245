//! What is in a log, before any law: units that look wrong, noise, contacts, holds, and what the
//! log is good for. `check` prints it, and `estimate` says with it why a law cannot fit.

mod holds;
pub(crate) mod refreshed;
mod suspicion;

pub use holds::{Hold, holds};
pub(crate) use suspicion::{exchanged, falls_inwards, gives_work};
pub use suspicion::{suspicions, suspicions_without_contact};

use crate::log::UniformLog;
use crate::replay::{Replay, Touch};
use crate::signal;
use crate::stats::{highest, lowest, median, quantile, robust_deviation};

/// A force below rest by this many standard deviations of what it does in free air pulls.
const PULL_SIGMAS: f64 = 8.0;
/// Fewest samples before the first touch that tell what the force does in free air.
const FEWEST_UNTOUCHED: usize = 10;
/// A pull is one if it lasts for this many samples: spikes are not adhesion.
const PULL_SAMPLES: usize = 5;
/// The largest force, held for this share of the samples in contact, is the end of the range.
const FLAT_TOP_SHARE: f64 = 0.01;

/// What is in a log.
#[derive(Clone, Debug, PartialEq)]
pub struct Inspection {
    /// Standard deviation of the force noise, from second differences (N).
    pub noise_n: f64,
    /// Scatter of the force in free air after its noise is averaged out, over what white noise would
    /// leave; about 1 unless something disturbs the force slowly. `None` without enough free air.
    pub disturbance: Option<f64>,
    /// Resolution of the force (N), if it is quantised.
    pub force_step_n: Option<f64>,
    /// Resolution of the position (m), if it is quantised.
    pub position_step_m: Option<f64>,
    /// Force in free air before the first touch (N).
    pub rest_n: f64,
    /// Time in free air (s).
    pub free_s: f64,
    /// Touches.
    pub touches: Vec<Touch>,
    /// Holds in contact, with what the force did meanwhile.
    pub holds: Vec<Hold>,
    /// Deepest pull below the resting force (N); 0 if the contact never pulls.
    pub pull_n: f64,
    /// The force at which the channel ends, if flat tops show it (N).
    pub saturated_n: Option<f64>,
    /// Speeds in contact: the lower and upper decile of those above a tenth of the fastest (m/s).
    pub speeds_mps: Option<(f64, f64)>,
    /// Whether the probe stood still in contact, or went both ways, for long enough to be a second speed.
    pub changes_speed: bool,
}

/// A speed is one of its own from this many samples of contact on, and standing still is less than this share of the
/// fastest. Derived: a window of the filter at its default of eleven samples; a ramp of 0.3 s at 100 Hz beside a hold of
/// 40 s gave the damping within 1 %.
const OWN_SAMPLES: usize = 11;
const STANDSTILL: f64 = 0.1;

/// Inspects a log with the touches that a replay of it has found.
pub fn inspect(log: &UniformLog, replay: &Replay, touches: &[Touch]) -> Inspection {
    let noise_n = log.force_noise_n();
    let contacts = replay.contacts();
    let mut touched = vec![false; log.len()];
    for contact in &contacts {
        touched[contact.clone()].fill(true);
    }
    let free: Vec<f64> = pick(&log.force_n, &touched, false);
    // After a touch a contact that sticks pulls in what counts as free air; before the first one a log may begin in it:
    // that it then lets go is no pull of 1.5 N.
    let before = contacts.first().map_or(log.len(), |first| first.start);
    let after_n = quantile(free.get(before..).unwrap_or_default().iter().copied(), 0.75);
    let starts_touched =
        median(log.force_n[..before].iter().copied()) > after_n + PULL_SIGMAS * noise_n;
    let untouched = match before >= FEWEST_UNTOUCHED && !starts_touched {
        true => &log.force_n[..before],
        false => &free,
    };
    let rest_n = median(untouched.iter().copied());
    let sigma_n = noise_n.max(wander(untouched, rest_n));
    Inspection {
        noise_n,
        disturbance: disturbance(&free, noise_n),
        force_step_n: signal::step(&log.force_n),
        position_step_m: signal::step(&log.position_m),
        rest_n,
        free_s: free.len() as f64 * log.period_s(),
        touches: touches.to_vec(),
        holds: holds(log, replay),
        pull_n: pull(&log.force_n, rest_n, sigma_n),
        saturated_n: saturation(&pick(&log.force_n, &touched, true), noise_n),
        speeds_mps: speeds(replay),
        changes_speed: changes_speed(replay),
    }
}

fn pick(channel: &[f64], touched: &[bool], wanted: bool) -> Vec<f64> {
    let picked = channel
        .iter()
        .zip(touched)
        .filter(|(_, touched)| **touched == wanted);
    picked.map(|(value, _)| *value).collect()
}

/// Means of 32 samples scatter by σ/√32 if the noise is white.
fn disturbance(free: &[f64], noise_n: f64) -> Option<f64> {
    const BLOCK: usize = 32;
    let means: Vec<f64> = free
        .chunks_exact(BLOCK)
        .map(|block| block.iter().sum::<f64>() / BLOCK as f64)
        .collect();
    if means.len() < 8 || noise_n <= 0.0 {
        return None;
    }
    let middle = median(means.iter().copied());
    Some(wander(&means, middle) / (noise_n / (BLOCK as f64).sqrt()))
}

/// Standard deviation of a force, hum and drift included.
fn wander(free: &[f64], rest_n: f64) -> f64 {
    robust_deviation(free.iter().map(|force| force - rest_n))
}

fn pull(force_n: &[f64], rest_n: f64, sigma_n: f64) -> f64 {
    // The smallest of neighbours that all pull: what lasts, not what spikes.
    let lasting = force_n
        .windows(PULL_SAMPLES)
        .map(|window| lowest(window.iter().map(|force| rest_n - force)));
    let deepest = lasting.fold(0.0, f64::max);
    if deepest > PULL_SIGMAS * sigma_n {
        deepest
    } else {
        0.0
    }
}

fn saturation(contact: &[f64], noise_n: f64) -> Option<f64> {
    let peak = highest(contact.iter().copied());
    // Noise never repeats the largest code in a row; the end of a range does.
    let longest = contact
        .split(|force| *force < peak)
        .map(<[f64]>::len)
        .max()
        .unwrap_or(0);
    let enough = (FLAT_TOP_SHARE * contact.len() as f64).max(10.0);
    (noise_n > 0.0 && longest as f64 > enough).then_some(peak)
}

/// The speeds in and out are two, and so are that of a ramp and that of a hold.
fn changes_speed(replay: &Replay) -> bool {
    let contacts = replay.contacts().into_iter().flatten();
    let speeds: Vec<f64> = contacts
        .map(|index| f64::from(replay.records.speed_mps(index)))
        .collect();
    let fastest = speeds.iter().map(|speed| speed.abs()).fold(0.0, f64::max);
    let still = STANDSTILL * fastest;
    let is_own =
        |is: &dyn Fn(f64) -> bool| speeds.iter().filter(|speed| is(**speed)).count() >= OWN_SAMPLES;
    let kinds = [
        is_own(&|speed| speed > still),
        is_own(&|speed| speed < -still),
        is_own(&|speed| speed.abs() <= still),
    ];
    fastest > 0.0 && kinds.into_iter().filter(|is| *is).count() >= 2
}

fn speeds(replay: &Replay) -> Option<(f64, f64)> {
    let contacts = replay.contacts().into_iter().flatten();
    let mut speeds: Vec<f64> = contacts
        .map(|index| f64::from(replay.records.speed_mps(index).abs()))
        .collect();
    let fastest = speeds.iter().copied().fold(0.0, f64::max);
    speeds.retain(|speed| *speed > 0.1 * fastest);
    speeds.sort_unstable_by(f64::total_cmp);
    let at = |share: f64| speeds.get((share * speeds.len() as f64) as usize).copied();
    Some((at(0.1)?, at(0.9)?))
}

#[cfg(test)]
mod tests {
    use estimator_core::Config;
    use estimator_core::estimate::method::Method;

    use crate::estimate::{Choices, estimate};
    use crate::log::Log;

    /// Whether a press of 2 N/mm along a way of position (mm) and second shows more than one speed.
    fn changes_speed(way: &[(f64, f64)]) -> bool {
        let end_s = way.last().map_or(0.0, |last| last.0);
        let time_s: Vec<f64> = (0..(1e3 * end_s) as u32)
            .map(|at| f64::from(at) * 1e-3)
            .collect();
        let position = |t: &f64| {
            let at = way.partition_point(|point| point.0 <= *t);
            let ((from_s, from), (to_s, to)) = (way[at - 1], way[at]);
            1e-3 * (from + (to - from) * (t - from_s) / (to_s - from_s))
        };
        let x: Vec<f64> = time_s.iter().map(position).collect();
        let noise = |at: usize| 5e-3 * (at as f64 * 1.7).sin() * (at as f64 * 0.37).cos();
        let f = x.iter().enumerate();
        let f = f.map(|(at, x)| 2000.0 * x.max(0.0) + noise(at)).collect();
        let log = Log::from_channels(time_s, x, f).uniform().unwrap();
        let method = [Method::KELVIN_VOIGT];
        let found = estimate(&log, Config::default(), &method, Choices::default()).unwrap();
        found.inspection.changes_speed
    }

    #[test]
    fn a_ramp_beside_a_hold_has_two_speeds_and_so_has_one_in_and_out() {
        assert!(changes_speed(&[(0.0, -1.0), (1.5, 2.0), (3.0, 2.0)]));
        assert!(changes_speed(&[(0.0, -1.0), (1.5, 2.0), (3.0, -1.0)]));
        assert!(!changes_speed(&[(0.0, -1.0), (1.5, 2.0)]));
    }
}
