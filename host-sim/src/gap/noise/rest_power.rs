//! How large what is there at rest in free air is, from its spectra: without lines, with what is slower than they show.

use std::ops::Range;

use crate::gap::noise::rest;
use crate::gap::noise::spectrum::{LowFrequencySlope, Spectrum, median_power};
use crate::gap::thresholds::Floor;
use crate::log::UniformLog;

/// Longest window of the spectrum at rest (samples), at 1 kHz and below; it is as long at any rate.
const LONGEST_WINDOW: usize = 2048;
/// Windows of the whole log (samples).
const WINDOW: usize = 256;
/// Noise is fast from this frequency on (cycles per sample).
const FAST: f64 = 1.0 / 16.0;
/// The rate (Hz) at which noise is said to be coloured, and how much: second differences of a faster log see less of
/// the same noise. First-order noise with a corner of 38 Hz at 10 kHz was eight times what they said, and no noise.
pub(super) const COLOUR_HZ: f64 = 1000.0;

/// The noise at rest.
pub(super) struct RestNoise {
    /// Power of the noise (N²).
    pub(super) noise_n2: f64,
    /// What of it is not slower than the rests show (N²).
    pub(super) seen_n2: f64,
    /// Power of the lines (N²).
    pub(super) lines_n2: f64,
    /// Standard error of `noise_n2` (N²).
    pub(super) error_n2: f64,
}

impl RestNoise {
    pub(super) fn of(
        log: &UniformLog,
        rests: &[Range<usize>],
        noise_n: f64,
        decide: &Floor,
    ) -> Option<RestNoise> {
        let times = (log.rate_hz / COLOUR_HZ).max(1.0);
        let longest = (times * LONGEST_WINDOW as f64) as usize;
        let spectra: Vec<Spectrum> = rests
            .iter()
            .flat_map(|rest| log.force_n[rest::settled(rest)].chunks(longest))
            .filter(|window| 2.0 * window.len() as f64 >= decide.shortest_rest)
            .map(|window| Spectrum::of(window, noise_n, decide))
            .collect();
        if spectra.is_empty() {
            return None;
        }
        let mut slope = LowFrequencySlope::default();
        spectra
            .iter()
            .for_each(|spectrum| slope.add(spectrum, times));
        let weight: f64 = spectra.iter().map(|spectrum| spectrum.samples as f64).sum();
        let mean = |of: &dyn Fn(&Spectrum) -> f64| {
            let each = spectra.iter();
            let sum: f64 = each.map(|one| one.samples as f64 * of(one)).sum();
            sum / weight
        };
        // The standard error of a mean of estimates that are as good as their windows are long.
        let error_n2 = |lowest: f64| {
            let each = spectra.iter();
            let squares = each.map(|one| one.samples.pow(2) as f64 * one.above(lowest).1);
            squares.sum::<f64>().sqrt() / weight
        };
        let (all, fast) = (
            mean(&|one| one.above(0.0).0),
            mean(&|one| one.above(FAST).0),
        );
        let below = mean(&|one| slope.power_below(one.samples, log.len(), decide));
        // Fast noise is the same in motion, of which there is more; what a motion adds to it is not noise.
        let fast_of_log = median_power(&log.force_n, &log.in_gap, WINDOW, FAST)
            .filter(|power| *power < fast + decide.sigmas * error_n2(FAST));
        let correction = fast_of_log.map_or(0.0, |power| power - fast);
        Some(RestNoise {
            noise_n2: (all + below + correction).max(0.0),
            seen_n2: all + correction,
            lines_n2: mean(&|one| one.lines_n2),
            // The power below the windows is extrapolated, and good to half of it.
            error_n2: error_n2(0.0).hypot(0.5 * below),
        })
    }

    /// Standard deviation (N) of the noise.
    pub(super) fn noise_n(&self) -> f64 {
        self.noise_n2.sqrt()
    }

    /// Power (N²) with the lines.
    pub(super) fn power_n2(&self) -> f64 {
        self.noise_n2 + self.lines_n2
    }

    /// Standard error of the standard deviation, as a share of it.
    pub(super) fn error(&self) -> f64 {
        0.5 * self.error_n2 / self.noise_n2.max(f64::MIN_POSITIVE)
    }
}
