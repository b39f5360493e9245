//! The noise of a channel and its step, and those of its samples that were measured.

use crate::stats::{lowest, quantile, range, robust_deviation, rounding_deviation};

/// Standard deviation of the noise of a channel, from second differences: x(h) − 2x(h−1) + x(h−2)
/// has variance 6σ² for white noise, and slow signals drop out. The median keeps jumps at touches
/// out; a channel whose noise is below its step reads step/√12, the quantisation's own.
pub fn noise(channel: &[f64]) -> f64 {
    noise_beside(step(channel), channel)
}

pub(super) fn noise_beside(step: Option<f64>, channel: &[f64]) -> f64 {
    let sigma = sigma(channel.windows(3).map(second_difference));
    sigma.max(rounding_deviation(step.unwrap_or(0.0)))
}

/// Samples of the blocks of [`loud_noise`], and the share of them that do not exceed it.
const BLOCK: usize = 100;
const LOUD_BLOCKS: f64 = 0.9;

/// The noise of the louder parts of a channel: a load cell may be noisier under load, and a slower rate
/// looks quieter.
pub(crate) fn loud_noise(channel: &[f64]) -> f64 {
    let blocks = channel
        .chunks(BLOCK)
        .filter(|block| block.len() > BLOCK / 2);
    let loud = quantile(blocks.map(noise), LOUD_BLOCKS);
    loud.max(noise(channel))
}

/// Second differences of all but a twentieth of a channel, and how far beyond them a turn is none.
const SHARPEST: f64 = 0.95;
const SHARPER: f64 = 3.0;

/// How far the channel turns within a sample, with a margin.
pub(crate) fn sharpest(channel: &[f64]) -> f64 {
    let turns = channel.windows(3).map(|w| second_difference(w).abs());
    SHARPER * quantile(turns, SHARPEST)
}

/// The same of a channel in which some samples are invented: differences across one mean nothing.
pub(crate) fn noise_of_measured(channel: &[f64], invented: &[bool]) -> f64 {
    if !invented.contains(&true) {
        return noise(channel);
    }
    let sigma = sigma(second_differences_of_measured(channel, invented));
    sigma.max(rounding_deviation(
        step(&measured(channel, invented)).unwrap_or(0.0),
    ))
}

/// The samples of a channel that are not invented.
pub(crate) fn measured(channel: &[f64], invented: &[bool]) -> Vec<f64> {
    let each = channel.iter().zip(invented);
    each.filter(|(_, out)| !**out).map(|(x, _)| *x).collect()
}

/// Second differences between neighbours none of which is invented.
pub(crate) fn second_differences_of_measured<'a>(
    channel: &'a [f64],
    invented: &'a [bool],
) -> impl Iterator<Item = f64> {
    measured_windows(channel, invented, 3).map(second_difference)
}

/// Neighbours, so many at a time, none of which is invented.
pub(crate) fn measured_windows<'a>(
    channel: &'a [f64],
    invented: &'a [bool],
    size: usize,
) -> impl Iterator<Item = &'a [f64]> {
    let windows = channel.windows(size).zip(invented.windows(size));
    let measured = windows.filter(|(_, invented)| !invented.contains(&true));
    measured.map(|(window, _)| window)
}

fn second_difference(window: &[f64]) -> f64 {
    window[2] - 2.0 * window[1] + window[0]
}

/// The standard deviation of white noise with these second differences.
fn sigma(differences: impl Iterator<Item = f64>) -> f64 {
    robust_deviation(differences) / 6.0_f64.sqrt()
}

/// A step is no way at constant speed if it is at most this share of the span: an encoder of a thousand counts may move
/// by one count a sample.
const COARSE: f64 = 1e-3;

/// The resolution of a channel: the smallest change between neighbours, if nine tenths of the
/// changes are whole multiples of it. `None` for a channel that is not quantised, and for a command that goes on by the
/// same step in sample after sample: 5 mm at 0.5 mm/s and 10 Hz are a hundred times 50 µm, and no count.
pub fn step(channel: &[f64]) -> Option<f64> {
    let span = range(channel);
    // Walked through twice rather than kept: of an hour they are 29 MB.
    let changes = || {
        let changes = channel.windows(2).map(|w| (w[1] - w[0]).abs());
        changes.filter(|change| *change > 1e-9 * span)
    };
    let smallest = lowest(changes());
    let is_whole = |change: f64| {
        let codes = change / smallest;
        // Both are positive: to an integer and back is the nearest one, at a tenth of what a call of `round` costs.
        codes < 1e4 && (codes - (codes + 0.5) as u32 as f64).abs() < 0.02
    };
    let (count, whole) = changes().fold((0, 0), |(count, whole), change| {
        (count + 1, whole + usize::from(is_whole(change)))
    });
    let is_on_a_way =
        smallest > COARSE * span && 50 * steady_changes(channel, smallest) >= 49 * count;
    (count >= 10 && 10 * whole >= 9 * count && !is_on_a_way).then_some(smallest)
}

/// How many changes by a step follow one by the same: all but one in fifty on a way, where an encoder at 0.95 counts a
/// sample stands still at one in twenty.
fn steady_changes(channel: &[f64], step: f64) -> usize {
    let is_steady = |w: &&[f64]| {
        let (before, now) = (w[1] - w[0], w[2] - w[1]);
        (before - now).abs() < 0.02 * step && (now.abs() - step).abs() < 0.02 * step
    };
    channel.windows(3).filter(is_steady).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, Normal};

    const SEED_NOISE: u64 = 11;

    fn noisy(sigma: f64, step: f64) -> Vec<f64> {
        let mut rng = rand_pcg::Pcg64::seed_from_u64(SEED_NOISE);
        let normal = Normal::new(0.0, sigma).unwrap();
        (0..4000)
            .map(|i| 5.0 * (f64::from(i) * 2e-3).sin() + normal.sample(&mut rng))
            .map(|value: f64| (value / step).round() * step)
            .collect()
    }

    #[test]
    fn noise_is_found_under_a_slow_signal_of_hundreds_of_its_size() {
        let sigma = noise(&noisy(0.02, 1e-9));
        // 4000 second differences: the median is good to 2 %.
        assert!((0.019..0.021).contains(&sigma), "{sigma}");
    }

    #[test]
    fn a_step_is_found_and_a_channel_without_one_has_none() {
        assert!((step(&noisy(0.02, 5e-3)).unwrap() - 5e-3).abs() < 1e-12);
        assert_eq!(step(&noisy(0.02, 1e-12)), None);
        assert_eq!(step(&[1.0; 100]), None);
        // Steps of a command at constant speed are none, and those of an encoder at half a count a sample are.
        let ramp = |per_sample: f64| -> Vec<f64> {
            let way = (0..200).map(|i| (per_sample * f64::from(i.clamp(20, 120))).floor());
            way.map(|count| 5e-5 * count).collect()
        };
        assert_eq!(step(&ramp(1.0)), None);
        assert!((step(&ramp(0.5)).unwrap() - 5e-5).abs() < 1e-12);
    }

    #[test]
    fn noise_is_that_of_what_was_measured() {
        // GIVEN one sample of five invented half-way between their neighbours
        let mut channel = noisy(0.02, 1e-12);
        let invented: Vec<bool> = (0..channel.len()).map(|at| at % 5 == 3).collect();
        for at in (3..channel.len() - 1).step_by(5) {
            channel[at] = 0.5 * (channel[at - 1] + channel[at + 1]);
        }
        // THEN the noise is that of the others: a median of 1 600 differences is good to 3 %.
        let measured = noise_of_measured(&channel, &invented);
        assert!((measured / 0.02 - 1.0).abs() < 0.1, "{measured}");
        let all = noise(&channel);
        assert!(all < 0.9 * measured, "{all} with the invented ones");
    }

    #[test]
    fn without_noise_the_step_is_the_noise() {
        let ramp: Vec<f64> = (0..1000).map(|i| f64::from(i / 4) * 0.01).collect();
        assert!((noise(&ramp) - rounding_deviation(0.01)).abs() < 1e-12);
    }
}
