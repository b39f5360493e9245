//! The line through the stamps: t = start + number·period, with a number for every sample that is
//! there.

use crate::log::timing::{Gap, Timing};

/// A stamp this far beyond its place (periods) may follow a dropped sample,
const LATE_PERIODS: f64 = 0.5;
/// and does so if the median of so many stamps from it on is as late: jitter does not last.
const LASTING: usize = 9;
/// Share of a stamp's deviation by which the line is shifted while numbering: it follows a clock that is
/// off by 0.1 % two hundredths of a period behind.
const FOLLOW: f64 = 0.05;
/// Stamps whose deviations have a larger rms than this (periods) lie on no line: numbers that mean
/// nothing leave 1/√12 = 0.29.
const LOOSEST_PERIODS: f64 = 0.25;

/// Scatter of all samples over that of those with neighbours, beyond which the others have instants of
/// their own.
const SLOWER_SCATTER: f64 = 2.0;

/// The line through the stamps of a log.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::log) struct Line {
    /// Time of number 0 (s).
    pub(in crate::log) start_s: f64,
    /// Time between numbers (s).
    pub(in crate::log) period_s: f64,
    /// The number of each sample, increasing; those in between are missing.
    pub(in crate::log) numbers: Vec<u64>,
    worst_s: f64,
}

impl Line {
    /// The least-squares line; `None` if the stamps lie on none.
    pub(in crate::log) fn through(time_s: &[f64], timing: &Timing) -> Option<Line> {
        let period_s = timing.mean_period_s;
        if time_s.len() < 3 || period_s <= 0.0 {
            return None;
        }
        let numbers = numbered(time_s, period_s)?;
        let count = numbers.len() as f64;
        let middle = numbers.iter().map(|n| *n as f64).sum::<f64>() / count;
        let middle_s = time_s.iter().map(|t| t - time_s[0]).sum::<f64>() / count;
        let (mut cross, mut square) = (0.0, 0.0);
        for (number, stamp) in numbers.iter().zip(time_s) {
            let from_middle = *number as f64 - middle;
            cross += from_middle * (stamp - time_s[0] - middle_s);
            square += from_middle * from_middle;
        }
        let period_s = cross / square;
        let mut line = Line {
            start_s: time_s[0] + middle_s - middle * period_s,
            period_s,
            numbers,
            worst_s: 0.0,
        };
        let worst_s = line.residuals(time_s).map(f64::abs).fold(0.0, f64::max);
        line.worst_s = worst_s;
        let loose = crate::stats::rms(line.residuals(time_s)) > LOOSEST_PERIODS * period_s;
        (!loose).then_some(line)
    }

    /// The stamps' deviations from the line (s).
    pub(in crate::log) fn residuals<'a>(
        &'a self,
        time_s: &'a [f64],
    ) -> impl Iterator<Item = f64> + 'a {
        let each = time_s.iter().zip(&self.numbers);
        each.map(|(stamp, number)| stamp - self.time_s(*number))
    }

    /// The time of a number (s).
    pub(in crate::log) fn time_s(&self, number: u64) -> f64 {
        self.start_s + number as f64 * self.period_s
    }

    /// How many samples are missing after the sample at an index.
    pub(in crate::log) fn missing_after(&self, index: usize) -> usize {
        (self.numbers[index + 1] - self.numbers[index]) as usize - 1
    }

    /// Where samples are missing. A stamp that is only late leaves no gap.
    pub(in crate::log) fn gaps(&self, time_s: &[f64]) -> Vec<Gap> {
        let gap = |index: usize| Gap {
            index,
            from_s: time_s[index],
            to_s: time_s[index + 1],
        };
        let before = 0..self.numbers.len() - 1;
        let missing = before.filter(|index| self.missing_after(*index) > 0);
        missing.map(gap).collect()
    }

    /// Whether the samples with neighbours on either side scatter much less than all do: then another, slower
    /// rate has instants of its own, which are not late.
    pub(in crate::log) fn has_other_instants(&self, time_s: &[f64]) -> bool {
        let dense = |at: &usize| self.numbers[at + 1] - self.numbers[at - 1] == 2;
        let residual = |at: usize| time_s[at] - self.time_s(self.numbers[at]);
        let inner = (1..self.numbers.len() - 1).filter(dense);
        let all = crate::stats::rms(self.residuals(time_s));
        all > SLOWER_SCATTER * crate::stats::rms(inner.map(residual))
    }

    /// The largest deviation (s).
    pub(in crate::log) fn worst_s(&self) -> f64 {
        self.worst_s
    }
}

/// The numbers of the samples; `None` if they do not fit any (a clock that runs away).
fn numbered(time_s: &[f64], period_s: f64) -> Option<Vec<u64>> {
    let mut numbers = Vec::with_capacity(time_s.len());
    let (mut number, mut origin_s) = (0u64, time_s[0]);
    numbers.push(number);
    for at in 1..time_s.len() {
        let late = |offset: usize| {
            let next = number + 1 + offset as u64;
            (time_s[at + offset] - origin_s) / period_s - next as f64
        };
        let mut deviation = late(0);
        number += 1;
        if deviation > LATE_PERIODS {
            let ahead = LASTING.min(time_s.len() - at);
            let before = number - 1;
            let lasting = (0..ahead).map(|offset| {
                let next = before + 1 + offset as u64;
                (time_s[at + offset] - origin_s) / period_s - next as f64
            });
            if crate::stats::median(lasting) > LATE_PERIODS {
                let missing = deviation.round().max(1.0);
                number += missing as u64;
                deviation -= missing;
            }
        }
        if deviation.abs() > 2.0 {
            return None;
        }
        origin_s += FOLLOW * deviation.clamp(-1.0, 1.0) * period_s;
        numbers.push(number);
    }
    Some(numbers)
}
