//! When the samples were taken: period, jitter, gaps.

use super::record::Log;
use crate::stats::lowest;

/// An interval longer than this many base periods is a gap: at least one sample is missing.
pub(super) const GAP_PERIODS: f64 = 1.5;

/// A measured rate this near a round one is that one: 0.1 % is what a host's clock or stamps of
/// few digits are off by.
const SNAP: f64 = 1e-3;

/// How evenly a log is sampled.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Timing {
    /// Median interval between samples (s); of a log with two rates, that of the denser one.
    pub base_period_s: f64,
    /// Mean of the intervals that are no gap and at least half a base period (s): unlike the
    /// median it is free of the rounding of the stamps.
    pub mean_period_s: f64,
    /// Standard deviation of those intervals (s).
    pub jitter_s: f64,
    /// Shortest interval (s).
    pub shortest_s: f64,
    /// Longest interval (s).
    pub longest_s: f64,
    /// Intervals longer than 1.5 base periods.
    pub gaps: Vec<Gap>,
}

/// An interval in which samples are missing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// Index of the last sample before it.
    pub index: usize,
    /// Time of the last sample before it (s).
    pub from_s: f64,
    /// Time of the first sample after it (s).
    pub to_s: f64,
}

impl Log {
    /// Period statistics; all zero for fewer than two samples.
    pub fn timing(&self) -> Timing {
        let mut periods: Vec<f64> = self
            .time_s
            .windows(2)
            .map(|pair| pair[1] - pair[0])
            .collect();
        if periods.is_empty() {
            return Timing::default();
        }
        let base = base_period(&self.time_s, &mut periods);
        let ordinary = |period: &f64| (0.5 * base..=GAP_PERIODS * base).contains(period);
        let regular = || periods.iter().copied().filter(ordinary);
        let count = regular().count() as f64;
        let mean = regular().sum::<f64>() / count;
        let variance = regular().map(|period| (period - mean).powi(2)).sum::<f64>() / count;
        Timing {
            base_period_s: base,
            mean_period_s: mean,
            jitter_s: variance.sqrt(),
            shortest_s: lowest(periods.iter().copied()),
            longest_s: periods.iter().copied().fold(0.0, f64::max),
            gaps: gaps(&self.time_s, GAP_PERIODS * base),
        }
    }

    /// Samples per second (Hz), a round number if the log's is within 0.1 % of one; 0 for fewer
    /// than two samples.
    pub fn rate_hz(&self) -> f64 {
        self.timing().rate_hz()
    }
}

impl Timing {
    /// Samples per second (Hz), snapped to a round number within 0.1 %; 0 if there is no period.
    pub fn rate_hz(&self) -> f64 {
        if self.mean_period_s > 0.0 {
            snapped(1.0 / self.mean_period_s)
        } else {
            0.0
        }
    }
}

/// The median interval, unless a tenth of the intervals is denser than two thirds of it: then the
/// log has two rates (a ramp at 2048 Hz, a hold at 256 Hz), and the dense one is where things move.
/// Stamps that jitter have short intervals too, but no four in a row.
fn base_period(time_s: &[f64], periods: &mut [f64]) -> f64 {
    let at = |periods: &mut [f64], index: usize| {
        *periods.select_nth_unstable_by(index, f64::total_cmp).1
    };
    let tenth = |periods: &mut [f64]| at(periods, periods.len() / 10);
    let median = at(periods, periods.len() / 2);
    let dense = tenth(periods);
    let fours = time_s.windows(5).map(|w| (w[4] - w[0]) / 4.0);
    let mut fours: Vec<f64> = fours.collect();
    let lasts = fours.is_empty() || tenth(&mut fours) < median / 1.5;
    if dense < median / 1.5 && lasts {
        dense
    } else {
        median
    }
}

fn gaps(time_s: &[f64], longest_s: f64) -> Vec<Gap> {
    let intervals = time_s.windows(2).enumerate();
    intervals
        .filter(|(_, pair)| pair[1] - pair[0] > longest_s)
        .map(|(index, pair)| Gap {
            index,
            from_s: pair[0],
            to_s: pair[1],
        })
        .collect()
}

/// The roundest rate within 0.1 %: first one or two digits of the rate, then a power of two, then a
/// whole number of hertz; below 1 Hz of seconds.
pub(super) fn snapped(rate_hz: f64) -> f64 {
    let candidates = [
        digits(rate_hz, 1),
        digits(rate_hz, 2),
        rate_hz.log2().round().exp2(),
        rate_hz.round(),
        1.0 / (1.0 / rate_hz).round(),
    ];
    let near = |round: &f64| round.is_finite() && (round / rate_hz - 1.0).abs() <= SNAP;
    candidates.into_iter().find(near).unwrap_or(rate_hz)
}

/// `value` to that many significant decimal digits.
fn digits(value: f64, count: i32) -> f64 {
    let exponent = value.log10().floor() as i32 - (count - 1);
    // Through a power with a positive exponent: 10^-3 has no exact f64, 10^3 has.
    if exponent < 0 {
        let scale = 10f64.powi(-exponent);
        (value * scale).round() / scale
    } else {
        let scale = 10f64.powi(exponent);
        (value / scale).round() * scale
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn log(time_s: Vec<f64>) -> Log {
        let zeros = vec![0.0; time_s.len()];
        Log::from_channels(time_s, zeros.clone(), zeros)
    }

    #[test]
    fn a_rate_near_a_round_one_is_that_one() {
        for (measured, round) in [
            (999.2, 1000.0),
            (1000.0, 1000.0),
            (2040.0, 2040.0),
            (2047.9, 2048.0),
            (256.1, 256.0),
            (49.97, 50.0),
            (1.0 / 3.0001, 1.0 / 3.0),
            (4999.9, 5000.0),
            (1234.4, 1234.0),
            (7.3217, 7.3217),
        ] {
            assert_eq!(snapped(measured), round, "{measured}");
        }
    }

    #[test]
    fn rounded_stamps_do_not_change_the_rate() {
        // GIVEN 256 Hz with stamps of 10 µs: intervals of 3.90 and 3.91 ms, the median 3.91.
        let stamps = (0..2000)
            .map(|i| (f64::from(i) / 256.0 * 1e5).round() / 1e5)
            .collect();
        let log = log(stamps);
        assert!((log.timing().base_period_s - 0.00391).abs() < 1e-9);
        assert_eq!(log.rate_hz(), 256.0);
    }

    #[test]
    fn gaps_are_found_with_their_place_and_do_not_enter_the_jitter() {
        let stamps = (0..1000)
            .filter(|i| !(400..403).contains(i))
            .map(|i| f64::from(i) * 1e-3);
        let timing = log(stamps.collect()).timing();
        assert_eq!(timing.gaps.len(), 1);
        assert_eq!(timing.gaps[0].index, 399);
        assert!((timing.gaps[0].to_s - 0.403).abs() < 1e-12);
        assert!((timing.longest_s - 0.004).abs() < 1e-12);
        // The stamps are products rounded to 2^-53 of a second at most.
        assert!(timing.jitter_s < 1e-15);
    }

    #[test]
    fn too_few_samples_have_no_rate() {
        assert_eq!(log(vec![1.0]).rate_hz(), 0.0);
    }
}
