//! Whether what is there at rest in free air is noise. A chirp, a burst or a wander at rest would otherwise become
//! the floor, and everything as small would be explained.

use std::ops::Range;

use crate::gap::noise::spectrum::detrended;
use crate::gap::thresholds::Floor;
use crate::log::UniformLog;
use crate::signal;
use crate::stats::{correlation, correlation_of_fourths, median, quantile, rms};

/// Samples of a block in which the noise is read from second differences: to 12 %.
const BLOCK: usize = 64;

/// The kurtosis of normal noise, and of a sine.
const NORMAL: f64 = 3.0;
const SINE: f64 = 1.5;

/// How far the kurtosis of what is there is from that of normal noise.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kurtosis {
    /// In `decide.sigmas` standard errors.
    pub(super) off: f64,
    /// Whether that of a sine would be off by more than so many.
    tells_a_sine: bool,
}

/// Whether what is there is noise, `times` as large as second differences say.
pub(super) fn is_noise(times: f64, kurtosis: Kurtosis, decide: &Floor) -> bool {
    let Kurtosis { off, tells_a_sine } = kurtosis;
    let is_first_order = times <= decide.largest_colour
        && off >= -1.0
        && (times <= decide.slight_colour || off <= 1.0);
    is_first_order || times <= decide.filtered_colour && tells_a_sine && off.abs() <= 0.5
}

/// The kurtosis of what is there. The forces are those without the lines that stay in phase: a hum of half of the
/// power makes one of 2.6.
pub(super) fn kurtosis(force_n: &[f64], rests: &[Range<usize>], decide: &Floor) -> Kurtosis {
    let each = rests.iter().map(settled);
    let count: usize = each.clone().map(|rest| rest.len()).sum();
    let stretches = each.map(|rest| detrended(&force_n[rest]));
    let (square, fourth) = stretches.flatten().fold((0.0, 0.0), |(two, four), force| {
        (two + force.powi(2), four + force.powi(4))
    });
    let count = count.max(1) as f64;
    // 3 for normal noise, 1.5 for a sine, 1 for two levels, more than 3 for bursts and for what dies out.
    let kurtosis = fourth * count / (square * square).max(f64::MIN_POSITIVE);
    // Of normal noise the squares say nothing once the variance is taken out, and Hermite's fourth polynomial has
    // the autocorrelation 24 ρ⁴.
    let error = (24.0 * longest(force_n, rests, correlation_of_fourths) / count).sqrt();
    Kurtosis {
        off: (kurtosis - NORMAL) / (decide.sigmas * error),
        tells_a_sine: NORMAL - SINE > decide.sigmas * error,
    }
}

/// Standard deviation (N) of the quiet part of the rests, from second differences, if there is one: a tenth or more
/// of them is quieter than `decide.quiet` times their median. `None` as well where the codes of a converter make
/// most of the noise, which then comes and goes with the level.
pub(super) fn quiet_n(
    log: &UniformLog,
    rests: &[Range<usize>],
    (noise_n, code_n): (f64, f64),
    decide: &Floor,
) -> Option<f64> {
    if code_n > decide.fine_code * noise_n {
        return None;
    }
    let mut blocks_n = Vec::new();
    for rest in rests.iter().map(settled) {
        let blocks = log.force_n[rest.clone()].chunks_exact(BLOCK);
        for (block, gaps) in blocks.zip(log.in_gap[rest].chunks_exact(BLOCK)) {
            let differences: Vec<f64> =
                signal::second_differences_of_measured(block, gaps).collect();
            if 2 * differences.len() > BLOCK {
                blocks_n.push(rms(differences) / 6.0_f64.sqrt());
            }
        }
    }
    let most_n = decide.quiet * median(blocks_n.iter().copied());
    let quiet_n = || blocks_n.iter().copied().filter(|noise_n| *noise_n < most_n);
    // Of two blocks the lower one: the other may hold the end of a burst.
    (10 * quiet_n().count() >= blocks_n.len().max(1)).then(|| quantile(quiet_n(), 0.4))
}

/// A rest without its first tenth, in which what the motion leaves behind dies out.
pub(super) fn settled(rest: &Range<usize>) -> Range<usize> {
    rest.start + rest.len() / 10..rest.end
}

/// Integrated autocorrelation (samples).
pub(super) fn correlation_at(log: &UniformLog, rests: &[Range<usize>]) -> f64 {
    longest(&log.force_n, rests, correlation)
}

/// A figure of the longest rest; 1 without one.
fn longest(force_n: &[f64], rests: &[Range<usize>], of: fn(&[f64]) -> f64) -> f64 {
    let longest = rests.iter().max_by_key(|rest| rest.len());
    longest.map_or(1.0, |rest| of(&detrended(&force_n[settled(rest)])))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn twelve_times_the_differences_is_noise_if_it_is_normal_and_no_chirp() {
        let rests: Vec<Range<usize>> = (0..6).map(|at| 1000 * at..1000 * at + 600).collect();
        let decide = Floor::default();
        // Sums of 64 numbers of a congruential generator: slow, and normal.
        let mut state = 5_u64;
        let mut next = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let each: Vec<f64> = (0..6100).map(|_| next()).collect();
        let slow: Vec<f64> = each.windows(64).map(|w| w.iter().sum()).collect();
        let chirp: Vec<f64> = (0..6000)
            .map(|at| {
                let u = 1e-3 * at as f64 % 3.0 - 1.5;
                (TAU * (30.0 - 9.0 * u.abs()) * u).sin()
            })
            .collect();
        let is_noise = |force_n: &[f64], times: f64| {
            is_noise(times, kurtosis(force_n, &rests, &decide), &decide)
        };
        assert!(is_noise(&slow, 12.0) && !is_noise(&slow, 25.0));
        assert!(!is_noise(&chirp, 12.0));
        // THEN of a rest that is too short to tell the two apart it is not taken.
        let of_short =
            |force_n: &[f64]| kurtosis(force_n, std::slice::from_ref(&(0..150)), &decide);
        assert!(!super::is_noise(12.0, of_short(&slow), &decide));
    }
}
