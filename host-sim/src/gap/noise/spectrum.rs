//! The power of a force at rest, bin by bin: what is noise in it, what are lines, and how much of a
//! noise that rises towards low frequencies a window is too short to see.

use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

use crate::signal;

/// A bin this many times the median of its neighbours is a line; noise alone reaches it in e⁻⁸ of
/// the bins of one window.
const LINE: f64 = 8.0;
/// A slope of the logarithms that is no scatter, and the steepest: 1/f is what electronics do, what
/// is steeper drifts.
const LEAST_RISE: f64 = 0.3;
const MOST_RISE: f64 = 1.0;
/// Hann's window makes neighbours of a bin repeat it: so many bins to an independent one.
const BINS: f64 = 35.0 / 18.0;

/// One window's power (N²) per bin from the first above 0 on.
pub(in crate::gap) struct Spectrum {
    pub(in crate::gap) samples: usize,
    pub(in crate::gap) power: Vec<f64>,
    /// What was cut out as lines (N²).
    pub(in crate::gap) lines_n2: f64,
}

impl Spectrum {
    /// Of a stretch without its trend and its long spikes; others are cut at four times its robust
    /// standard deviation, or `noise_n` where that is more (most samples of a noise below a converter's
    /// step are the same).
    pub(in crate::gap) fn of(force: &[f64], noise_n: f64) -> Spectrum {
        let power = periodogram(clipped(without_spikes(force, noise_n), noise_n));
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
        Spectrum {
            samples: force.len(),
            lines_n2: power.iter().sum::<f64>() - kept.iter().sum::<f64>(),
            power: kept,
        }
    }

    /// Power (N²) from a frequency (per sample) on, and the variance (N⁴) of that estimate.
    pub(in crate::gap) fn above(&self, lowest: f64) -> (f64, f64) {
        let first = (lowest * self.samples as f64).ceil().max(1.0) as usize;
        let bins = &self.power[(first - 1).min(self.power.len())..];
        let squares: f64 = bins.iter().map(|p| p * p).sum();
        (bins.iter().sum(), BINS * squares)
    }
}

/// How the spectra of all windows rise towards low frequencies, as f^−a: one line through the
/// logarithms of density and frequency over the lowest sixteenth of each. One for all: the scatter of
/// one short window's own slope (0.4) would on the average of what it adds make too much of it.
#[derive(Default)]
pub(in crate::gap) struct Rise {
    sums: [f64; 5],
}

impl Rise {
    pub(in crate::gap) fn add(&mut self, own: &Spectrum) {
        let (power, n) = (&own.power, own.samples as f64);
        let low = &power[..(power.len() / 16).max(8).min(power.len())];
        for (at, p) in low.iter().enumerate().filter(|(_, p)| **p > 0.0) {
            let (x, y) = (((at + 1) as f64 / n).ln(), (p * n).ln());
            let terms = [1.0, x, y, x * x, x * y];
            let each = self.sums.iter_mut().zip(terms);
            each.for_each(|(sum, term)| *sum += term);
        }
    }

    /// Power (N²) below the lowest bin of a window, down to one period in the log.
    pub(in crate::gap) fn below(&self, window: usize, log: usize) -> f64 {
        let [n, sx, sy, sxx, sxy] = self.sums;
        let spread = n * sxx - sx * sx;
        if spread <= 0.0 || log <= window {
            return 0.0;
        }
        let slope = (n * sxy - sx * sy) / spread;
        let rise = (-slope).min(MOST_RISE);
        if rise < LEAST_RISE {
            return 0.0;
        }
        // The line's level at the lowest bin; the mean of an exponential is 1.78 of its median logarithm.
        let lowest = 1.0 / window as f64;
        let density = ((sy + slope * (n * lowest.ln() - sx)) / n).exp() * 1.78;
        // ∫ of u^−a from window/log to 1, in bins.
        let from = window as f64 / log as f64;
        let integral = if (rise - 1.0).abs() < 1e-3 {
            -from.ln()
        } else {
            (1.0 - from.powf(1.0 - rise)) / (1.0 - rise)
        };
        density * lowest * integral
    }
}

/// Power (N²) of a whole log above a frequency (per sample), motion or not: in every bin the median
/// over windows of so many samples, since touches and reversals are in few of them. `None` with fewer
/// than eight.
pub(in crate::gap) fn whole(
    force: &[f64],
    in_gap: &[bool],
    window: usize,
    lowest: f64,
) -> Option<f64> {
    let first = (lowest * window as f64).ceil() as usize;
    let spectra: Vec<Vec<f64>> = (0..force.len().saturating_sub(window - 1))
        .step_by(window / 2)
        .map(|from| from..from + window)
        .filter(|own| !in_gap[own.clone()].contains(&true))
        .map(|own| periodogram(detrended(&force[own])))
        .collect();
    let median = |bin: usize| signal::median(spectra.iter().map(|own| own[bin]).collect());
    let bins = first - 1..window / 2 - 1;
    (spectra.len() >= 8).then(|| bins.map(median).sum::<f64>() / std::f64::consts::LN_2)
}

/// Power (N²) per bin, from the first above 0 to the last below half the rate.
fn periodogram(wave: Vec<f64>) -> Vec<f64> {
    let n = wave.len();
    let hann = |(at, value): (usize, f64)| {
        // A line leaks into two bins on either side and no further.
        let phase = std::f64::consts::TAU * (at as f64 + 0.5) / n as f64;
        Complex::new(value * (1.0 - phase.cos()) * (2.0_f64 / 3.0).sqrt(), 0.0)
    };
    let mut bins: Vec<Complex<f64>> = wave.into_iter().enumerate().map(hann).collect();
    FftPlanner::new().plan_fft_forward(n).process(&mut bins);
    let scale = 2.0 / (n as f64).powi(2);
    let power = bins[1..n / 2].iter().map(|bin| scale * bin.norm_sqr());
    power.collect()
}

/// Standard deviation of normal deviations by the median of their sizes, or `noise_n` where that is more.
fn robust(sizes: impl Iterator<Item = f64>, noise_n: f64) -> f64 {
    (1.4826 * signal::median(sizes.collect())).max(noise_n)
}

/// Without what stands out by more than noise does: spikes are no noise, and a floor that counts them
/// would hide them. A line or a coloured noise has no such tails.
fn clipped(mut detrended: Vec<f64>, noise_n: f64) -> Vec<f64> {
    let most = 4.0 * robust(detrended.iter().map(|own| own.abs()), noise_n);
    if most > 0.0 {
        detrended
            .iter_mut()
            .for_each(|own| *own = own.clamp(-most, most));
    }
    detrended
}

/// Without its trend, and without spikes that are so many and so long that they would be the trend: a
/// quarter of a rest at 35 standard deviations. What is further than six from the line through the medians of
/// its first and last third counts for nothing.
fn without_spikes(force: &[f64], noise_n: f64) -> Vec<f64> {
    let third = force.len() / 3;
    let (first, last) = (&force[..third], &force[force.len() - third..]);
    let median = |own: &[f64]| signal::median(own.to_vec());
    let slope = (median(last) - median(first)) / (force.len() - third).max(1) as f64;
    let each = force.iter().enumerate();
    let flat: Vec<f64> = each.map(|(at, own)| own - slope * at as f64).collect();
    let middle = median(&flat);
    let sizes: Vec<f64> = flat.iter().map(|own| (own - middle).abs()).collect();
    let most = 6.0 * robust(sizes.iter().copied(), noise_n);
    let calm: Vec<bool> = sizes.iter().map(|own| *own <= most).collect();
    let mut left = detrended_by(force, &calm);
    let spikes = left.iter_mut().zip(&calm).filter(|own| !own.1);
    spikes.for_each(|(own, _)| *own = 0.0);
    left
}

pub(in crate::gap) fn detrended(force: &[f64]) -> Vec<f64> {
    detrended_by(force, &vec![true; force.len()])
}

/// Without the straight line through those samples that count.
fn detrended_by(force: &[f64], counts: &[bool]) -> Vec<f64> {
    let each = || {
        let samples = force.iter().zip(counts).enumerate();
        let counted = samples.filter(|(_, own)| *own.1);
        counted.map(|(at, own)| (at as f64, *own.0))
    };
    let n = each().count().max(1) as f64;
    let middle = each().map(|own| own.0).sum::<f64>() / n;
    let mean = each().map(|own| own.1).sum::<f64>() / n;
    let along: f64 = each().map(|(u, f)| (u - middle) * (f - mean)).sum();
    let square: f64 = each().map(|(u, _)| (u - middle).powi(2)).sum();
    let slope = if square > 0.0 { along / square } else { 0.0 };
    let each = force.iter().enumerate();
    each.map(|(at, value)| value - mean - slope * (at as f64 - middle))
        .collect()
}
