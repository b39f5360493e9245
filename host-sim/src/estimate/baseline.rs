//! A zero of the force that wanders slowly: a load cell that warms up, an amplifier that drifts.
//!
//! Free air before, between and after the touches shows it. Where it is a line or an exponential there, it is one in the
//! touches as well, and is taken off before anything is estimated, whatever the method: of 25 logs that drifted by 5 to
//! 50 mN/s, or warmed up by 0.05 to 0.4 N in 2 to 10 s, a fit of the whole log with one resting force was right in four,
//! and `converged` and wrong in two.

use super::setup::outside;
use crate::log::UniformLog;
use crate::lsq::dense;
use crate::number::quantity;
use crate::stats::{median, range, rms, robust_deviation};

/// Time of a mean (s), and its fewest samples.
const MEAN_S: f64 = 0.02;
const FEWEST_SAMPLES: usize = 4;
/// Means of a stretch of free air at least; and the share of its means at either end in which a contact may still pull or
/// already push.
const FEWEST_MEANS: usize = 3;
const MARGIN: f64 = 0.1;
/// Stretches of free air that a line is told from, and an exponential: one more than their numbers.
const FEWEST_FOR_LINE: usize = 3;
const FEWEST_FOR_EXPONENTIAL: usize = 4;
/// A log that goes on for longer than this share after its last free air is not known there.
const MOST_AFTER: f64 = 1.0 / 3.0;
/// It is a drift if it goes over so many times the scatter of the means about it. 50 logs that drift: 13.7 times and more;
/// 30 with 1/f noise, which looks like a drift: 4.0 times at most; 100 without either: 0.9 times at most; 40 whose zero steps by
/// 0.5 N in the middle: 5.6 to 8.8 times.
const OVER_SCATTER: f64 = 10.0;
/// Means so many deviations off are none of the baseline (a pull, a late release); it has no more of them than this share.
const OUTLIER: f64 = 4.0;
const MOST_OUTLIERS: f64 = 0.2;
/// An exponential leaves less than this share of what a line leaves.
const BENT: f64 = 0.8;
/// Time constants (of the log's length) that are tried: a shorter one than a stroke is none of a warm-up.
const TIME_CONSTANTS: [f64; 8] = [0.06, 0.1, 0.15, 0.22, 0.33, 0.5, 0.75, 1.2];

/// A log without the drift of its resting force, and a note that says so; `None` where free air shows none, or none that is
/// a line or an exponential.
pub fn undrifted(log: &UniformLog) -> Option<UniformLog> {
    let rests = rests(log)?;
    let end_s = *log.time_s.last()?;
    let begin_s = *log.time_s.first()?;
    let duration_s = end_s - begin_s;
    let last_s = rests.last()?.last()?.0;
    if rests.len() < FEWEST_FOR_LINE || end_s - last_s > MOST_AFTER * duration_s {
        return None;
    }
    let means: Vec<(f64, f64)> = rests.concat();
    let line = Baseline::fitted(&means, begin_s, duration_s, None)?;
    let bent = TIME_CONSTANTS.map(|share| {
        let enough = rests.len() >= FEWEST_FOR_EXPONENTIAL;
        enough.then_some(share)?;
        Baseline::fitted(&means, begin_s, duration_s, Some(share))
    });
    let bent = bent.into_iter().flatten();
    let bent = bent.min_by(|a, b| a.scatter_n.total_cmp(&b.scatter_n));
    let best = match bent {
        Some(bent) if bent.scatter_n < BENT * line.scatter_n => bent,
        _ => line,
    };
    let course: Vec<f64> = log.time_s.iter().map(|t| best.force_n(*t)).collect();
    let over_n = range(&course);
    if over_n <= OVER_SCATTER * best.scatter_n {
        return None;
    }
    Some(best.taken_off(log, over_n))
}

/// Means (s, N) of each stretch of free air.
fn rests(log: &UniformLog) -> Option<Vec<Vec<(f64, f64)>>> {
    let samples = ((MEAN_S * log.rate_hz) as usize).max(FEWEST_SAMPLES);
    let stretches = outside(log)?;
    let each = stretches.iter().map(|stretch| {
        let means = stretch.chunks_exact(samples).map(|own| {
            let force_n = own.iter().map(|at| log.force_n[*at]).sum::<f64>() / samples as f64;
            (log.time_s[own[samples / 2]], force_n)
        });
        let means: Vec<(f64, f64)> = means.collect();
        let margin = (MARGIN * means.len() as f64).ceil() as usize;
        means[margin..(means.len() - margin.min(means.len())).max(margin)].to_vec()
    });
    Some(each.filter(|own| own.len() >= FEWEST_MEANS).collect())
}

/// a + b·s + c·e^(−s/τ), s the time in lengths of the log.
struct Baseline {
    begin_s: f64,
    duration_s: f64,
    numbers: Vec<f64>,
    time_constant: Option<f64>,
    /// Of the means about it (N rms).
    scatter_n: f64,
}

impl Baseline {
    /// The best one by least squares, without outliers; `None` if there are many.
    fn fitted(
        means: &[(f64, f64)],
        begin_s: f64,
        duration_s: f64,
        time_constant: Option<f64>,
    ) -> Option<Baseline> {
        let mut own = Baseline {
            begin_s,
            duration_s,
            numbers: Vec::new(),
            time_constant,
            scatter_n: 0.0,
        };
        let mut kept = means.to_vec();
        for _ in 0..2 {
            own.numbers = own.least_squares(&kept)?;
            let left = |(at_s, force_n): &(f64, f64)| force_n - own.force_n(*at_s);
            let middle_n = median(means.iter().map(left));
            let within_n = OUTLIER * robust_deviation(means.iter().map(|at| left(at) - middle_n));
            let near = means
                .iter()
                .filter(|at| (left(at) - middle_n).abs() <= within_n);
            kept = near.copied().collect();
        }
        own.scatter_n = rms(kept
            .iter()
            .map(|(at_s, force_n)| force_n - own.force_n(*at_s)));
        let is_most = kept.len() as f64 >= (1.0 - MOST_OUTLIERS) * means.len() as f64;
        is_most.then_some(own)
    }

    fn terms(&self, at_s: f64) -> Vec<f64> {
        let along = (at_s - self.begin_s) / self.duration_s;
        let bend = self.time_constant.map(|own| (-along / own).exp());
        [1.0, along].into_iter().chain(bend).collect()
    }

    fn least_squares(&self, means: &[(f64, f64)]) -> Option<Vec<f64>> {
        let count = self.terms(0.0).len();
        let (mut matrix, mut right) = (vec![0.0; count * count], vec![0.0; count]);
        for (at_s, force_n) in means {
            let terms = self.terms(*at_s);
            for (row, own) in terms.iter().enumerate() {
                right[row] += own * force_n;
                for (column, other) in terms.iter().enumerate() {
                    matrix[row * count + column] += own * other;
                }
            }
        }
        Some(dense::solve(
            &dense::cholesky(&matrix, count)?,
            count,
            &right,
        ))
    }

    fn force_n(&self, at_s: f64) -> f64 {
        let terms = self.terms(at_s).into_iter();
        terms.zip(&self.numbers).map(|(a, b)| a * b).sum()
    }

    /// The log without what it goes from its beginning on (N).
    fn taken_off(&self, log: &UniformLog, over_n: f64) -> UniformLog {
        let mut log = log.clone();
        let begins_n = self.force_n(self.begin_s);
        let taken = log.taken.iter_mut();
        let taken = taken.map(|own| (&own.time_s, &mut own.force_n));
        for (time_s, channel) in taken.chain([(&log.time_s, &mut log.force_n)]) {
            for (at_s, force_n) in time_s.iter().zip(channel) {
                *force_n -= self.force_n(*at_s) - begins_n;
            }
        }
        log.untouched = false;
        let shape = match self.time_constant {
            None => format!(
                "{} evenly",
                quantity(self.numbers[1] / self.duration_s, 2, "N/s")
            ),
            Some(own) => format!(
                "{} with a time constant of {}",
                quantity(over_n, 2, "N"),
                quantity(own * self.duration_s, 1, "s")
            ),
        };
        log.notes.push(format!(
            "the resting force drifts by {shape}, {} over the log, as free air before, between and after the touches shows: \
             that is taken off",
            quantity(over_n, 2, "N")
        ));
        log
    }
}
