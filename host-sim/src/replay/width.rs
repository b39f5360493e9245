//! How wide the filter of a log is: as wide as the noise asks and the motion allows.
//!
//! A wide window averages the noise, and rounds peaks and corners. It starts as the board's, 8 samples or
//! 8 ms on either side, whichever is longer, and shrinks to half until it takes no more off the force than
//! half of the noise; 8 ms are never too wide at 1 kHz or below, where the board has no other.

use crate::log::UniformLog;
use crate::stats::quantile;

/// The board's half-width: samples, at 1 kHz.
pub(super) const SAMPLES: usize = 8;
const SECONDS: f64 = 8e-3;
/// What a window may take off the force, in standard deviations of its noise.
const ALLOWED: f64 = 0.5;
/// Half the window takes a quarter off a parabola, and half off a kink.
const HELPS: f64 = 0.7;
/// What noise exceeds in a tenth of its samples, in standard deviations.
const MOST: f64 = 1.645;
/// The probe moves above this share of its fast speed (the 99.9 % quantile: a hold may be all but a hundredth of a log).
const MOVING: f64 = 0.1;
/// Samples that are looked at: more tell nothing new.
const LOOKED_AT: usize = 4000;

/// Samples on either side of the filter's centre at the log's own rate, at least one.
pub(crate) fn half_width(log: &UniformLog) -> usize {
    let usual = (SECONDS * log.rate_hz).round() as usize;
    let slow = log.rate_hz <= 1.0 / SECONDS * SAMPLES as f64;
    let narrowest = match slow {
        true => usual.max(1),
        false => SAMPLES,
    };
    let mut half_width = usual.max(SAMPLES);
    if half_width == narrowest {
        return half_width;
    }
    let noise_n = log.force_noise_n();
    // The difference of two windows has noise of its own: 0.6/m of the variance for m = half_width.
    let allowed_n = |m: usize| noise_n * (ALLOWED * ALLOWED + MOST * MOST * 0.6 / m as f64).sqrt();
    let mut taken = taken_n(log, half_width);
    while half_width > narrowest && taken > allowed_n(half_width) {
        let narrower = (half_width / 2).max(narrowest);
        let less = taken_n(log, narrower);
        // A narrower window that takes off as much meets roughness of the force and no rounded motion.
        if less > HELPS * taken {
            break;
        }
        (half_width, taken) = (narrower, less);
    }
    half_width
}

/// What a window takes off the force (N) beyond one of half its width, in all but a tenth of the motion.
fn taken_n(log: &UniformLog, half_width: usize) -> f64 {
    let inner = half_width..log.len().saturating_sub(half_width);
    let way = |at: usize| (log.position_m[at + half_width] - log.position_m[at - half_width]).abs();
    let looked_at = || inner.clone().step_by((log.len() / LOOKED_AT).max(1));
    let moving_m = MOVING * quantile(looked_at().map(way), 0.999);
    let moving = looked_at().filter(|at| way(*at) > moving_m);
    let narrow = (half_width / 2).max(1);
    let taken = moving.map(|at| {
        let force_n = &log.force_n;
        match half_width {
            1 => mean(force_n, at, 1) - force_n[at],
            _ => mean(force_n, at, half_width) - mean(force_n, at, narrow),
        }
    });
    quantile(taken.map(f64::abs), 0.9)
}

/// The mean with the weights of the filter, (m(m + 1) − k²)/(2S).
fn mean(channel: &[f64], at: usize, half_width: usize) -> f64 {
    let m = half_width as f64;
    let squares = m * (m + 1.0) * (2.0 * m + 1.0) / 3.0;
    let weight = |k: usize| (m * (m + 1.0) - (k * k) as f64) / (2.0 * squares);
    let sides = (1..=half_width).map(|k| weight(k) * (channel[at - k] + channel[at + k]));
    weight(0) * channel[at] + sides.sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::Log;
    use rand::SeedableRng;
    use rand_distr::{Distribution, Normal};

    const SEED: u64 = 3;

    /// A press of 3 mm on 4 N/mm in `seconds`, with noise.
    fn press(rate_hz: f64, seconds: f64, noise_n: f64) -> UniformLog {
        let mut rng = rand_pcg::Pcg64::seed_from_u64(SEED);
        let noise = Normal::new(0.0, noise_n).unwrap();
        let count = (6.0 * seconds * rate_hz) as u32;
        let time: Vec<f64> = (0..count).map(|i| f64::from(i) / rate_hz).collect();
        let way = |t: &f64| 1.5e-3 * (1.0 - (std::f64::consts::TAU * t / seconds).cos());
        let position: Vec<f64> = time.iter().map(way).collect();
        let force = position.iter().map(|x| 4000.0 * x + noise.sample(&mut rng));
        let force = force.collect();
        Log::from_channels(time, position, force).uniform().unwrap()
    }

    #[test]
    fn the_width_is_that_of_the_board_at_1_khz_and_follows_seconds_noise_and_motion() {
        // Rate (Hz), length of a press (s), noise (N): half-width (samples).
        for (rate_hz, seconds, noise_n, expected) in [
            (1000.0, 0.8, 0.02, 8..=8),
            (1000.0, 0.1, 1e-5, 8..=8),
            (10_000.0, 0.8, 0.02, 80..=80),
            // Nothing to average, and a motion that turns: as narrow as the board's in samples.
            (10_000.0, 0.1, 1e-5, 8..=20),
            (200.0, 0.8, 0.02, 2..=4),
            // Slow presses keep the board's samples.
            (50.0, 100.0, 0.02, 8..=8),
            // The noise of so slow a log reads its curvature as well.
            (10.0, 4.0, 0.002, 1..=2),
        ] {
            let found = half_width(&press(rate_hz, seconds, noise_n));
            assert!(
                expected.contains(&found),
                "{rate_hz} Hz, {seconds} s: {found}"
            );
        }
    }
}
