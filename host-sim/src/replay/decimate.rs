//! A fast log as a board would see it: means over blocks of its samples, at one to two kilohertz.
//!
//! The estimator's filter holds 65 samples at most, 3 ms at 20 kHz, and its noise is that of so short a
//! window: the residual was 3.8 times what it need be. A mean over a block is the anti-aliasing filter, the
//! same for both channels, so that neither comes later than the other. Faults are recognised first, in the
//! samples as they were taken, and samples that are not measurements stay out of the means.

use estimator_core::Faults;

use super::sensing::Readings;
use super::width::half_width;
use crate::log::UniformLog;
use crate::signal;

/// A log up to this rate (Hz) goes into the estimator as it is.
const FASTEST_HZ: f64 = 2000.0;
/// A faster one is averaged until the filter's half-width is this many samples, as on the board.
const HALF_WIDTH: usize = 8;

/// The log in means of so many samples that a board could have sampled it; `None` if it is slow
/// enough, or so quiet and quick that the filter must be as narrow as it is.
pub fn decimated(log: &UniformLog) -> Option<UniformLog> {
    // A thousandth: 2048 Hz rounded is no reason.
    if log.rate_hz <= 1.001 * FASTEST_HZ || !log.recognised.is_empty() {
        return None;
    }
    let factor = half_width(log) / HALF_WIDTH;
    if factor < 2 {
        return None;
    }
    let readings = Readings::of(log);
    let measured = |at: &usize| !readings.invented.contains(*at);
    let mut means = without_samples(log, factor);
    let mut is_line = Vec::new();
    for block in 0..log.len() / factor {
        let samples = block * factor..(block + 1) * factor;
        let invented = !samples.clone().any(|at| measured(&at));
        let kept = || samples.clone().filter(|at| invented || measured(at));
        let mean = |channel: &[f64]| {
            let count = kept().count() as f64;
            kept().map(|at| channel[at]).sum::<f64>() / count
        };
        let faults = samples
            .clone()
            .map(|at| readings.faults.at(at) | readings.bridged_faults.at(at));
        means
            .time_s
            .push(log.time_s[samples.clone()].iter().sum::<f64>() / factor as f64);
        means.position_m.push(mean(&readings.position_m));
        means.force_n.push(mean(&readings.force_n));
        means.in_gap.push(invented);
        is_line.push(log.in_gap[samples].contains(&true));
        means
            .recognised
            .push(faults.fold(Faults::NONE, |all, faults| all | faults));
    }
    if !log.slower.is_empty() {
        // Between the samples of a slower rate lie straight lines, which count and have no noise: cells that were held
        // at 256 Hz between ramps at 2 kHz read 10⁻²³ N.
        let noise_n = signal::noise_of_measured(&means.force_n, &is_line);
        means.compensated.noise_n.get_or_insert(noise_n);
    }
    means.notes.push(format!(
        "{} Hz are more than the estimator needs: it sees means of {factor} samples, {} a second, and forces, \
         noise and the table are of these means",
        log.rate_hz,
        (means.rate_hz * 1e3).round() / 1e3
    ));
    Some(means)
}

/// A log for means of `factor` samples of another.
fn without_samples(log: &UniformLog, factor: usize) -> UniformLog {
    let count_m = log.position_step_m;
    let mut means = UniformLog {
        path: log.path.clone(),
        kind: log.kind,
        source: log.source.clone(),
        rate_hz: log.rate_hz / factor as f64,
        slower: log.slower.clone(),
        position_step_m: count_m.or_else(|| signal::step(&log.position_m)),
        notes: log.notes.clone(),
        compensated: log.compensated.clone(),
        ..UniformLog::default()
    };
    means.compensated.noise_n = log.compensated.noise_n.map(|n| n / (factor as f64).sqrt());
    means.compensated.saturated = Vec::new();
    means.compensated.turning = Vec::new();
    means
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::Log;
    use rand::SeedableRng;
    use rand_distr::{Distribution, Normal};

    const SEED: u64 = 5;

    #[test]
    fn the_noise_of_means_is_not_that_of_lines_between_the_samples_of_a_slower_rate() {
        // GIVEN presses at 4 kHz for 2 s, then a hold of 20 s at 250 Hz, 20 mN of noise
        let mut rng = rand_pcg::Pcg64::seed_from_u64(SEED);
        let noise = Normal::new(0.0, 0.02).unwrap();
        let fast = (0..8000).map(|i| 2.5e-4 * f64::from(i));
        let time: Vec<f64> = fast
            .chain((0..5000).map(|i| 2.0 + 4e-3 * f64::from(i)))
            .collect();
        let way = |t: &f64| 1.5e-3 * (1.0 - (std::f64::consts::TAU * t.min(1.5)).cos());
        let position: Vec<f64> = time.iter().map(way).collect();
        let force = position.iter().map(|x| 4000.0 * x + noise.sample(&mut rng));
        let log = Log::from_channels(time.clone(), position.clone(), force.collect());
        let log = log.uniform().unwrap();
        assert_eq!(log.slower.len(), 1);
        let means = decimated(&log).unwrap();
        // THEN it is that of means of what was measured.
        let expected_n = 0.02 / (log.rate_hz / means.rate_hz).sqrt();
        let ratio = means.force_noise_n() / expected_n;
        assert!((0.9..1.1).contains(&ratio), "{ratio}");
    }
}
