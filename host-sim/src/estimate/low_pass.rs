//! A force that went through a low-pass before it was logged, or was interpolated: its noise ends at a corner.
//!
//! From sample to sample such a force hardly scatters (0.1 mN of 1 mN behind 20 Hz at 1 kHz), and every law left many times
//! that. Its noise is what it does at rest. What the filter does to the contact a fit of the whole log knows
//! (`batch`, `behind`); of a recursion one with a delay takes stiffness times delay off a damping.

use std::f64::consts::TAU;

use super::setup::outside;
use crate::log::UniformLog;
use crate::number::quantity;
use crate::spectral::{hann, power};
use crate::stats::{median, robust_deviation};

/// Samples of a segment whose spectrum is taken; half of them are the fewest of free air.
const SEGMENT: usize = 256;
/// Bins of an octave at least.
const FEWEST_BINS: usize = 8;
/// The noise falls by this (a ratio of powers, 10 dB) within two octaves: 1/f noise by 6 dB, an element of first order by 12.
const FALLS: f64 = 10.0;
/// The power of white noise behind a low-pass of second order, of what is below its corner.
const ABOVE: f64 = 1.11;
/// Turns of the search for where the noise ends: what is lowest is half of that.
const TURNS: usize = 8;
/// It counts where the force rests by so many times its scatter from sample to sample.
const LARGER: f64 = 1.3;
/// A mode that is faster than this share of the filter's rate may be the filter itself.
const OF_THE_FILTER: f64 = 0.5;

/// A log whose force was low-passed with that said, and the noise that it has at rest; `None` of another.
pub fn low_passed(log: &UniformLog) -> Option<UniformLog> {
    if log.compensated.noise_n.is_some() || log.taken.is_some() {
        return None;
    }
    let rests = rests(log)?;
    let corner_hz = corner(&rests)? * log.rate_hz;
    let noise_n = median(rests.iter().map(|own| scatter(own)));
    if noise_n < LARGER * log.force_noise_n() {
        return None;
    }
    let mut log = log.clone();
    log.compensated.noise_n = Some(noise_n);
    log.low_pass_hz = Some(corner_hz);
    log.notes.push(format!(
        "the noise of the force ends at about {}: it was low-passed or interpolated before it was logged. It scatters by {} \
         at rest, and what is faster is rounded off; a filter with a delay (of about {}) takes stiffness times delay off \
         the damping of a law that is not fitted behind it, and its standard error includes that where the motion does \
         not tell. Log the force as it is measured",
        quantity(corner_hz, 2, "Hz"),
        quantity(noise_n, 2, "N"),
        quantity(1.0 / (TAU * corner_hz), 2, "s"),
    ));
    Some(log)
}

/// By how much (s) a low-pass may delay a force of this log.
pub(crate) fn delay_s(log: &UniformLog) -> Option<f64> {
    log.low_pass_hz.map(|corner_hz| 1.0 / (TAU * corner_hz))
}

/// Whether a relaxation of this rate (1/s) may be that of a low-pass.
pub(crate) fn may_be_the_filter(log: &UniformLog, rate_per_s: f64) -> bool {
    log.low_pass_hz
        .is_some_and(|corner_hz| rate_per_s > OF_THE_FILTER * TAU * corner_hz)
}

/// Segments of the force in free air.
fn rests(log: &UniformLog) -> Option<Vec<Vec<f64>>> {
    let stretches = outside(log)?;
    let segments = stretches.iter().flat_map(|own| own.chunks(SEGMENT));
    let segments = segments.filter(|own| own.len() >= SEGMENT / 2);
    let forces = segments.map(|own| own.iter().map(|at| log.force_n[*at]).collect());
    Some(forces.collect())
}

fn scatter(force_n: &[f64]) -> f64 {
    let middle_n = median(force_n.iter().copied());
    robust_deviation(force_n.iter().map(|force| force - middle_n))
}

/// Where the noise of segments ends (of the rate), if it does.
fn corner(segments: &[Vec<f64>]) -> Option<f64> {
    if segments.is_empty() {
        return None;
    }
    let mut spectrum = vec![0.0; SEGMENT / 2 + 1];
    for own in segments {
        let mean = own.iter().sum::<f64>() / own.len() as f64;
        let windowed = own.iter().enumerate();
        let windowed = windowed.map(|(at, force)| (force - mean) * hann(at, own.len()));
        let each = power(windowed, SEGMENT);
        let norm = 1.0 / own.len() as f64;
        spectrum
            .iter_mut()
            .zip(each)
            .for_each(|(sum, one)| *sum += norm * one);
    }
    // From the highest octave down; medians leave lines of hum out.
    let mut octaves = Vec::new();
    let mut end = SEGMENT / 2;
    while end / 2 >= FEWEST_BINS {
        octaves.push(median(spectrum[end / 2..end].iter().copied()));
        end /= 2;
    }
    let plateau = median(spectrum[2..2 * FEWEST_BINS].iter().copied());
    octaves.push(plateau);
    let falls = octaves
        .windows(3)
        .map(|own| own[2] / own[0])
        .fold(0.0, f64::max);
    if falls < FALLS {
        return None;
    }
    Some(bandwidth(&spectrum) / SEGMENT as f64)
}

/// Up to which bin a noise as large as the lowest would have the power of all, less what a low-pass of second order lets
/// through above its corner.
fn bandwidth(spectrum: &[f64]) -> f64 {
    // Medians leave lines of hum out.
    let smooth: Vec<f64> = spectrum
        .windows(3)
        .map(|own| median(own.iter().copied()))
        .collect();
    let all: f64 = smooth.iter().sum();
    let mut end = 2 * FEWEST_BINS;
    let mut found = end as f64;
    for _ in 0..TURNS {
        let lowest = &smooth[..end];
        found = all * lowest.len() as f64 / lowest.iter().sum::<f64>();
        end = ((0.5 * found) as usize).clamp(3, smooth.len());
    }
    found / ABOVE
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    const SEED: u64 = 17;

    /// Four segments of noise behind two low-passes of first order that keep so much of a sample.
    fn noise(keeps: f64) -> Vec<Vec<f64>> {
        let mut rng = rand_pcg::Pcg64::seed_from_u64(SEED);
        let (mut one, mut two) = (0.0, 0.0);
        let mut next = || {
            let own: f64 = StandardNormal.sample(&mut rng);
            one = keeps * one + (1.0 - keeps) * own;
            two = keeps * two + (1.0 - keeps) * one;
            two
        };
        (0..4)
            .map(|_| (0..SEGMENT).map(|_| next()).collect())
            .collect()
    }

    #[test]
    fn a_noise_that_ends_shows_its_corner_and_a_white_one_has_none() {
        // Twice −1.5 dB at 32 Hz, and −20 dB at 150 Hz.
        let found = corner(&noise(0.73)).expect("it ends");
        assert!((0.02..0.08).contains(&found), "{found}");
        assert_eq!(corner(&noise(0.0)), None);
    }

    #[test]
    fn a_noise_that_flickers_ends_nowhere() {
        let mut sum = noise(0.0);
        for octave in 1..8 {
            let slower = noise((-TAU * 0.2 / f64::from(1 << octave)).exp());
            for (own, more) in sum.iter_mut().flatten().zip(slower.into_iter().flatten()) {
                *own += more * f64::from(1 << octave).sqrt();
            }
        }
        assert_eq!(corner(&sum), None);
    }
}
