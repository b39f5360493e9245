//! The scales of the logs: ranges, speeds, times and noise.

use estimator_core::physics::fit_range::Scale;

use super::fit_data::FitData;
use super::repetition;
use crate::stats::{median, quantile};

/// Scales of the logs, from which starts, bounds and thresholds are made: no length, force or time in the
/// workflow is absolute.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scales {
    /// Range of the position (m).
    pub(crate) travel_m: f64,
    /// Range of the force without its outer 1 % (N).
    pub(crate) force_n: f64,
    /// Largest force (N).
    pub(crate) highest_n: f64,
    /// Smallest force (N).
    pub(crate) lowest_n: f64,
    /// 95 % quantile of the magnitude of the speed (m/s), of samples that move.
    pub(crate) speed_mps: f64,
    /// 95 % quantile of the magnitude of the acceleration (m/s²).
    pub(crate) acceleration_mps2: f64,
    /// Duration of the longest log (s).
    pub(crate) duration_s: f64,
    /// Time between samples (s).
    pub(crate) period_s: f64,
    /// Standard deviation of the position (m).
    pub(crate) position_noise_m: f64,
    /// Standard deviation of the speed (m/s).
    pub(crate) speed_noise_mps: f64,
    /// Deepest position (m).
    pub(crate) deepest_m: f64,
    /// Largest distance of the position from 0 (m).
    pub(crate) reach_m: f64,
    /// Frequency (Hz) at which the motion repeats, if it does.
    pub(crate) motion_hz: Option<f64>,
    /// Quantiles of the position (m), evenly spaced from the lowest to the deepest one.
    pub(crate) positions_m: [f64; QUANTILES],
    /// How often the motion goes beyond each of them.
    pub(crate) passes: [usize; QUANTILES],
}

/// Quantiles of the position that are kept.
const QUANTILES: usize = 33;

impl Scales {
    /// A size in which the catalogue's rows say starts and ranges.
    pub(crate) fn size(&self, scale: Scale) -> f64 {
        match scale {
            Scale::Travel => self.travel_m,
            Scale::Force => self.force_n,
            Scale::SmallForce => 0.05 * self.force_n,
            Scale::HighestForce => self.highest_n,
            Scale::LowestForce => self.lowest_n,
            Scale::Stiffness => self.force_n / self.travel_m,
            Scale::Speed => self.speed_mps,
            Scale::SpeedNoise => self.speed_noise_mps,
            // What divides by these is finite on a log that stands still at 0.
            Scale::Acceleration => self.acceleration_mps2.max(f64::MIN_POSITIVE),
            Scale::Reach => self.reach_m.max(f64::MIN_POSITIVE),
            Scale::Duration => self.duration_s,
            Scale::Period => self.period_s,
            Scale::PositionNoise => self.position_noise_m,
            // Of a motion that is all in contact, with a margin.
            Scale::PitchInContact => 0.5 * self.travel_m,
        }
    }

    /// The time (s) that the longest log may be beyond a position: no more than the share of all samples there.
    pub(crate) fn time_beyond_s(&self, position_m: f64) -> f64 {
        let beyond = self.positions_m.iter().filter(|x| **x > position_m);
        self.duration_s * beyond.count() as f64 / QUANTILES as f64
    }

    /// How often the motion goes beyond a position (m).
    pub(crate) fn passes_beyond(&self, position_m: f64) -> usize {
        let at = self.positions_m.iter().position(|x| *x > position_m);
        at.map_or(0, |at| self.passes[at])
    }

    /// Measures the scales of logs.
    pub(crate) fn of(logs: &[FitData]) -> Scales {
        let first = &logs[0];
        let position = || logs.iter().flat_map(|log| log.position_m.iter().copied());
        let force = || logs.iter().flat_map(|log| log.force_n.iter().copied());
        let speed_noise_mps = median(first.speed_noise_mps.iter().copied());
        let speeds = logs.iter().flat_map(|log| &log.speed_mps);
        let moving = speeds
            .map(|speed| speed.abs())
            .filter(|speed| *speed > 3.0 * speed_noise_mps);
        let accelerations = logs.iter().flat_map(|log| &log.acceleration_mps2);
        let accelerating = accelerations
            .map(|acceleration| acceleration.abs())
            .filter(|acceleration| *acceleration > 0.0);
        let duration_s = logs.iter().map(|log| log.duration_s() + log.period_s);
        let (lowest_m, deepest_m) = (quantile(position(), 0.0), quantile(position(), 1.0));
        let positions_m = evenly_spaced_quantiles(position());
        let travel_m = deepest_m - lowest_m;
        Scales {
            travel_m,
            force_n: (quantile(force(), 0.995) - quantile(force(), 0.005)).max(f64::MIN_POSITIVE),
            highest_n: quantile(force(), 1.0),
            lowest_n: quantile(force(), 0.0),
            speed_mps: quantile(moving, 0.95),
            acceleration_mps2: quantile(accelerating, 0.95),
            duration_s: duration_s.fold(0.0, f64::max),
            period_s: first.period_s,
            position_noise_m: first.position_noise_m,
            speed_noise_mps,
            deepest_m,
            reach_m: deepest_m.abs().max(lowest_m.abs()),
            motion_hz: repetition::of(first),
            positions_m,
            passes: positions_m.map(|own| {
                let each = logs
                    .iter()
                    .map(|log| passes(&log.position_m, own, travel_m));
                each.sum()
            }),
        }
    }
}

/// How often a motion goes beyond a position (m), having been a twentieth of the travel (m) before it.
fn passes(motion_m: &[f64], position_m: f64, travel_m: f64) -> usize {
    let (mut is_before, mut count) = (false, 0);
    for own in motion_m {
        if *own < position_m - 0.05 * travel_m {
            is_before = true;
        } else if is_before && *own > position_m {
            (is_before, count) = (false, count + 1);
        }
    }
    count
}

/// Quantiles of numbers, evenly spaced from the lowest to the highest.
fn evenly_spaced_quantiles(numbers: impl Iterator<Item = f64>) -> [f64; QUANTILES] {
    let mut sorted: Vec<f64> = numbers.collect();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().saturating_sub(1);
    std::array::from_fn(|at| sorted.get(at * last / (QUANTILES - 1)).map_or(0.0, |x| *x))
}
