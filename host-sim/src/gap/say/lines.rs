//! Lines in the residuals: the strongest in time and the strongest along the travel.

use std::f64::consts::TAU;

use crate::gap::data::fit_data::FitData;
use crate::gap::finding::{Pattern, Region};
use crate::gap::say::log_residuals::LogResiduals;
use crate::spectral;
use crate::stats::range;

/// Most samples that lines along the travel are looked for in.
const MOST_SAMPLES: usize = 3000;
/// The first number of half cycles over the travel.
const FIRST_HALVES: usize = 6;

/// The lines of a log that hold more than a share of the energy of its residuals.
pub(crate) fn lines(of_log: &LogResiduals<'_>, least_share: f64) -> Vec<Region> {
    let residuals: Vec<f64> = of_log
        .residuals
        .iter()
        .zip(of_log.variances)
        .map(|(residual, v)| if *v > 0.0 { *residual } else { 0.0 })
        .collect();
    let energy: f64 = residuals.iter().map(|r| r * r).sum();
    let count = residuals.len() as f64;
    let region = |id, share: f64, pattern| Region {
        id,
        share: share.min(1.0),
        rms_n: (share.min(1.0) * energy / count).sqrt(),
        samples: 1.0,
        pattern: Some(pattern),
    };
    let is_line = |(share, _): &(f64, f64)| *share > least_share;
    let in_time = line_in_time(of_log.log, &residuals, energy)
        .filter(is_line)
        .map(|(share, hz)| region("line", share, Pattern::Line { hz }));
    let along_travel = line_along_travel(of_log.log, &residuals)
        .filter(is_line)
        .map(|(share, m)| region("pitch", share, Pattern::Pitch { m }));
    in_time.into_iter().chain(along_travel).collect()
}

/// The share of the energy in the strongest line in time, and its frequency (Hz).
fn line_in_time(log: &FitData, residuals: &[f64], energy: f64) -> Option<(f64, f64)> {
    if !log.is_nearly_even() {
        return None;
    }
    let series = log.in_slots(residuals.iter().copied());
    let slots = series.len();
    let count = slots as f64;
    let power = spectral::power(series, slots);
    let share = |at: usize| 2.0 * power[at] / (count * energy.max(f64::MIN_POSITIVE));
    let strongest = (4..slots / 2).max_by(|a, b| share(*a).total_cmp(&share(*b)))?;
    let hz = strongest as f64 / (count * log.period_s);
    Some((share(strongest), hz))
}

/// The share of the energy in the strongest line along the travel, and its pitch (m).
fn line_along_travel(log: &FitData, residuals: &[f64]) -> Option<(f64, f64)> {
    let travel_m = range(&log.position_m);
    let stride = (log.len() / MOST_SAMPLES).max(1);
    let share = |halves: usize| {
        let per_m = TAU * 0.5 * halves as f64 / travel_m.max(f64::MIN_POSITIVE);
        let (mut re, mut im, mut energy) = (0.0, 0.0, 0.0);
        for at in (0..residuals.len()).step_by(stride) {
            let (sin, cos) = (per_m * log.position_m[at]).sin_cos();
            re += residuals[at] * cos;
            im += residuals[at] * sin;
            energy += residuals[at] * residuals[at];
        }
        let used = residuals.len().div_ceil(stride) as f64;
        2.0 * (re * re + im * im) / (used * energy.max(f64::MIN_POSITIVE))
    };
    let finest = (travel_m / (16.0 * log.position_noise_m)).clamp(4.0, 200.0) as usize;
    let shares: Vec<f64> = (FIRST_HALVES..2 * finest).map(share).collect();
    let at = (0..shares.len()).max_by(|a, b| shares[*a].total_cmp(&shares[*b]))?;
    let pitch_m = 2.0 * travel_m / (at + FIRST_HALVES) as f64;
    Some((shares[at], pitch_m))
}
