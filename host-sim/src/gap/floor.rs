//! The noise floor of the force, without a model.
//!
//! Two opinions. The high-pass one (second differences) sees white noise only. The one at rest, in
//! free air, sees the whole spectrum of what is there when nothing moves; sharp lines in it (a pump, a
//! disturbance) are no noise and are cut to their neighbours' level. Where the two differ the noise is
//! coloured, and rest is right.

use std::ops::Range;

use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

use crate::batch::error::correlation;
use crate::log::UniformLog;
use crate::signal;

/// Shortest rest that counts (samples), and the longest window of its spectrum.
const SHORTEST: usize = 128;
const LONGEST: usize = 2048;
/// A bin this many times the median of its neighbours is a line; noise alone reaches it in e⁻⁸ of
/// the bins of one window.
const LINE: f64 = 8.0;
/// From this ratio on it is not white.
const COLOURED: f64 = 1.06;

/// What the force does when nothing happens.
#[derive(Clone, Debug, PartialEq)]
pub struct Floor {
    /// Standard deviation (N) from second differences.
    pub high_pass_n: f64,
    /// Standard deviation (N) at rest in free air, lines left out; `None` without such a rest.
    pub rest_n: Option<f64>,
    /// Root mean square (N) of the lines that were cut out of the rest.
    pub lines_n: f64,
    /// The one to trust (N).
    pub used_n: f64,
    /// Whether it is not white.
    pub coloured: bool,
    /// Samples per independent one.
    pub correlation: f64,
    /// Which one it is, in words.
    pub why: String,
}

impl Floor {
    /// The floor of a log.
    pub fn of(log: &UniformLog) -> Floor {
        let high_pass_n = high_pass(log);
        let rests = rests(log);
        let (rest_n, lines_n) =
            rest(log, &rests).map_or((None, 0.0), |(own, lines)| (Some(own), lines));
        let (used_n, why) = match rest_n {
            None => (
                high_pass_n,
                "from second differences: there is no rest in free air",
            ),
            Some(rest) if rest > COLOURED * high_pass_n => {
                (rest, "from rest in free air: the noise is coloured")
            }
            // Both see the same; the one from all samples is the better one.
            Some(_) => (
                high_pass_n,
                "from second differences, and rest in free air agrees",
            ),
        };
        let coloured = used_n > COLOURED * high_pass_n;
        Floor {
            coloured,
            correlation: if coloured {
                resting_correlation(log, &rests)
            } else {
                1.0
            },
            high_pass_n,
            rest_n,
            lines_n,
            used_n,
            why: why.into(),
        }
    }
}

/// Stretches in which the position stays within two counts, in the quarter of the travel that is
/// furthest out.
pub(super) fn rests(log: &UniformLog) -> Vec<Range<usize>> {
    let position = &log.position_m;
    let lowest = position.iter().copied().fold(f64::INFINITY, f64::min);
    let out_m = lowest + 0.25 * signal::range(position);
    let still_m = 2.5 * signal::step(position).unwrap_or(signal::noise(position) * 4.0);
    let mut rests = Vec::new();
    let mut from = 0;
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for (at, x) in position.iter().copied().enumerate() {
        let (lower, higher) = (low.min(x), high.max(x));
        if higher - lower > still_m || x > out_m || log.in_gap[at] {
            if at - from >= SHORTEST {
                rests.push(from..at);
            }
            from = at + 1;
            (low, high) = (f64::INFINITY, f64::NEG_INFINITY);
        } else {
            (low, high) = (lower, higher);
        }
    }
    if position.len() - from.min(position.len()) >= SHORTEST {
        rests.push(from..position.len());
    }
    rests
}

/// Second differences again, but their mean square within four of [`signal::noise`]'s sigmas: the
/// median of a channel with coarse steps is good to half a step only.
fn high_pass(log: &UniformLog) -> f64 {
    let coarse = log.force_noise_n();
    let limit = 4.0 * coarse * 6.0_f64.sqrt();
    let differences = log.force_n.windows(3).zip(log.in_gap.windows(3));
    let kept = differences
        .filter(|(_, gap)| !gap.contains(&true))
        .map(|(w, _)| w[2] - 2.0 * w[1] + w[0])
        .filter(|d| d.abs() <= limit);
    let fine = signal::rms(kept) / 6.0_f64.sqrt();
    if fine > 0.0 { fine } else { coarse }
}

fn rest(log: &UniformLog, rests: &[Range<usize>]) -> Option<(f64, f64)> {
    let mut total = [0.0; 3];
    for rest in rests {
        // What the motion leaves behind has gone after a tenth of the rest.
        let settled = rest.start + rest.len() / 10..rest.end;
        let force = &log.force_n[settled];
        for window in force
            .chunks(LONGEST)
            .filter(|own| own.len() >= SHORTEST / 2)
        {
            let weight = window.len() as f64;
            let (noise, lines) = variance(window, log.len());
            for (sum, own) in total.iter_mut().zip([noise, lines, 1.0]) {
                *sum += weight * own;
            }
        }
    }
    let [noise, lines, weight] = total;
    (weight > 0.0).then(|| ((noise / weight).sqrt(), (lines / weight).sqrt()))
}

/// Without what stands out by more than noise does: spikes are no noise, and a floor that counts them
/// would hide them. Four robust standard deviations; a line or a coloured noise has no such tails.
fn clipped(mut detrended: Vec<f64>) -> Vec<f64> {
    let sizes = detrended.iter().map(|own| own.abs()).collect();
    let most = 4.0 * 1.4826 * signal::median(sizes);
    if most > 0.0 {
        detrended
            .iter_mut()
            .for_each(|own| *own = own.clamp(-most, most));
    }
    detrended
}

/// Integrated autocorrelation of the longest rest (samples).
fn resting_correlation(log: &UniformLog, rests: &[Range<usize>]) -> f64 {
    let longest = rests.iter().max_by_key(|rest| rest.len());
    longest.map_or(1.0, |rest| {
        let settled = rest.start + rest.len() / 10..rest.end;
        correlation(&detrended(&log.force_n[settled]))
    })
}

/// Variance of a stretch without its trend and without lines, and that of the lines.
fn variance(force: &[f64], log_samples: usize) -> (f64, f64) {
    let n = force.len();
    let mut bins: Vec<Complex<f64>> = clipped(detrended(force))
        .into_iter()
        .enumerate()
        .map(|(at, value)| {
            // Hann's window: a line leaks into two bins on either side and no further.
            let phase = std::f64::consts::TAU * (at as f64 + 0.5) / n as f64;
            Complex::new(value * (1.0 - phase.cos()) * (2.0_f64 / 3.0).sqrt(), 0.0)
        })
        .collect();
    FftPlanner::new().plan_fft_forward(n).process(&mut bins);
    let half = n / 2;
    let power: Vec<f64> = bins[1..half].iter().map(|bin| bin.norm_sqr()).collect();
    // A periodogram's bins are exponential: their median is ln 2 of their mean.
    let kept = (0..power.len()).map(|at| {
        let near = at.saturating_sub(12)..(at + 13).min(power.len());
        let level = signal::median(power[near].to_vec()) / std::f64::consts::LN_2;
        // A pure line leaks into two bins on either side; what is broader is noise in a band.
        let high = |k: Option<usize>| {
            k.and_then(|k| power.get(k))
                .is_some_and(|p| *p > LINE * level)
        };
        let broad = [3, 4, 5]
            .iter()
            .any(|d| high(at.checked_sub(*d)) || high(Some(at + d)));
        if power[at] > LINE * level && !broad {
            level
        } else {
            power[at]
        }
    });
    let kept: Vec<f64> = kept.collect();
    let scale = 2.0 / (n as f64).powi(2);
    let (all, own) = (power.iter().sum::<f64>(), kept.iter().sum::<f64>());
    let noise = own + below(&kept, log_samples as f64 / n as f64);
    (scale * noise, scale * (all - own))
}

/// Power below the lowest bin, down to one period in the log, if the spectrum rises towards it as
/// f^−a: the slope of the logarithms over the lowest sixteenth, where a > 0.3 is no scatter.
fn below(power: &[f64], lengths: f64) -> f64 {
    let low = &power[..(power.len() / 16).max(8).min(power.len())];
    let (mut n, mut sx, mut sy, mut sxx, mut sxy) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (at, p) in low.iter().enumerate().filter(|(_, p)| **p > 0.0) {
        let (x, y) = (((at + 1) as f64).ln(), p.ln());
        (n, sx, sy, sxx, sxy) = (n + 1.0, sx + x, sy + y, sxx + x * x, sxy + x * y);
    }
    let spread = n * sxx - sx * sx;
    if spread <= 0.0 || lengths <= 1.0 {
        return 0.0;
    }
    let slope = (n * sxy - sx * sy) / spread;
    let rise = (-slope).clamp(0.0, 1.3);
    if rise < 0.3 {
        return 0.0;
    }
    // The line's level at the lowest bin; the mean of an exponential is 1.78 of its median logarithm.
    let level = ((sy - slope * sx) / n).exp() * 1.78;
    // ∫ of u^−a from 1/lengths to 1, in bins.
    let from = 1.0 / lengths;
    let integral = if (rise - 1.0).abs() < 1e-3 {
        -from.ln()
    } else {
        (1.0 - from.powf(1.0 - rise)) / (1.0 - rise)
    };
    level * integral
}

fn detrended(force: &[f64]) -> Vec<f64> {
    let n = force.len() as f64;
    let middle = (n - 1.0) / 2.0;
    let mean = force.iter().sum::<f64>() / n;
    let (mut along, mut square) = (0.0, 0.0);
    for (at, value) in force.iter().enumerate() {
        let u = at as f64 - middle;
        along += u * (value - mean);
        square += u * u;
    }
    let slope = if square > 0.0 { along / square } else { 0.0 };
    let each = force.iter().enumerate();
    each.map(|(at, value)| value - mean - slope * (at as f64 - middle))
        .collect()
}
