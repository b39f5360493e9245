//! The power of a force at rest, bin by bin: what of it is noise, what is lines, and how much of a noise
//! that rises towards low frequencies a window is too short to see.

use crate::gap::thresholds::Floor;
use crate::spectral;
use crate::stats::median;

/// Bins for each independent one: Hann's window makes neighbours of a bin repeat it.
const BINS_PER_INDEPENDENT: f64 = 35.0 / 18.0;

/// The power spectrum of one window.
pub(crate) struct Spectrum {
    /// Samples of the window.
    pub(crate) samples: usize,
    /// Power (N²) of each bin from the first above 0 on, without the lines.
    pub(crate) power: Vec<f64>,
    /// Power (N²) that was cut out as lines.
    pub(crate) lines_n2: f64,
}

impl Spectrum {
    /// The spectrum of a stretch without its trend and its long spikes. Other spikes are cut at so many
    /// times its robust standard deviation, or times `noise_n` where that is more: most samples of a noise
    /// below a converter's step are the same.
    pub(crate) fn of(force: &[f64], noise_n: f64, decide: &Floor) -> Spectrum {
        let most = decide.long_spike_sigmas;
        let without_spikes = without_spikes(force, noise_n, most);
        let power = periodogram(clipped(without_spikes, noise_n, decide.spike_sigmas));
        let without_lines: Vec<f64> = (0..power.len())
            .map(|at| without_line(&power, at, decide.line))
            .collect();
        Spectrum {
            samples: force.len(),
            lines_n2: power.iter().sum::<f64>() - without_lines.iter().sum::<f64>(),
            power: without_lines,
        }
    }

    /// Power (N²) from a frequency (cycles per sample) on, and the variance (N⁴) of that estimate.
    pub(crate) fn above(&self, lowest: f64) -> (f64, f64) {
        let first = (lowest * self.samples as f64).ceil().max(1.0) as usize;
        let bins = &self.power[(first - 1).min(self.power.len())..];
        let squares: f64 = bins.iter().map(|p| p * p).sum();
        (bins.iter().sum(), BINS_PER_INDEPENDENT * squares)
    }
}

/// The power of a bin, or the level of its neighbours where it is a line.
fn without_line(power: &[f64], at: usize, line: f64) -> f64 {
    let near = at.saturating_sub(12)..(at + 13).min(power.len());
    // The bins of a periodogram are exponentially distributed: their median is ln 2 of their mean.
    let level = median(power[near].iter().copied()) / std::f64::consts::LN_2;
    // A pure line leaks into two bins on either side; what is broader is noise in a band.
    let is_high = |bin: Option<usize>| {
        bin.and_then(|bin| power.get(bin))
            .is_some_and(|power| *power > line * level)
    };
    let is_broad = [3, 4, 5]
        .iter()
        .any(|offset| is_high(at.checked_sub(*offset)) || is_high(Some(at + offset)));
    if power[at] > line * level && !is_broad {
        level
    } else {
        power[at]
    }
}

/// The straight line through the logarithms of density and frequency over the lowest sixteenth of the
/// spectra of all windows, as much as that is at 1 kHz: noise that rises towards low frequencies as f^−a.
/// All windows share one line, because the slope of one short window scatters by 0.4, and the mean of
/// what that adds would be too much. Where the lowest bins rise less the noise has a corner, as behind a filter, and
/// their line is right: with a corner of 10 Hz the floor was 1.9 times the noise. Six rests of half a second tell that
/// only in part, so that both lines count by what speaks for them: with a corner of 14 Hz the floor is 1.25 times the
/// noise in the median of 200 logs, where a choice at three standard errors made it 1.43; pink noise stays as it is.
#[derive(Default)]
pub(crate) struct LowFrequencySlope {
    low: LogLine,
    lowest: LogLine,
}

/// Sums for a line through logarithms.
#[derive(Default)]
struct LogLine {
    sums: [f64; 5],
}

impl LogLine {
    fn add(&mut self, x: f64, y: f64) {
        let terms = [1.0, x, y, x * x, x * y];
        let each = self.sums.iter_mut().zip(terms);
        each.for_each(|(sum, term)| *sum += term);
    }

    /// The slope and its standard error: the logarithm of an exponential number has the variance π²/6.
    fn slope(&self) -> Option<(f64, f64)> {
        let [n, sx, sy, sxx, sxy] = self.sums;
        let determinant = n * sxx - sx * sx;
        (determinant > 0.0).then(|| {
            let error = (BINS_PER_INDEPENDENT * std::f64::consts::PI.powi(2) / 6.0 * n
                / determinant)
                .sqrt();
            ((n * sxy - sx * sy) / determinant, error)
        })
    }

    /// The power below the lowest bin of a window where the density goes on with this slope.
    fn power_below(&self, slope: f64, (window, log): (usize, usize), decide: &Floor) -> f64 {
        let [n, sx, sy, ..] = self.sums;
        let exponent = (-slope).min(decide.largest_slope);
        if exponent < decide.least_slope {
            return 0.0;
        }
        // The line's level at the lowest bin. The mean of an exponential distribution is 1.78 times the
        // exponential of its mean logarithm.
        let lowest = 1.0 / window as f64;
        let density = ((sy + slope * (n * lowest.ln() - sx)) / n).exp() * 1.78;
        // ∫ of u^−a from window/log to 1, in bins.
        let from = window as f64 / log as f64;
        let integral = if (exponent - 1.0).abs() < 1e-3 {
            -from.ln()
        } else {
            (1.0 - from.powf(1.0 - exponent)) / (1.0 - exponent)
        };
        density * lowest * integral
    }
}

/// Lowest bins of a window that say whether noise has a corner.
const LOWEST: usize = 8;

impl LowFrequencySlope {
    /// Adds the spectrum of a window of a log that is so many `times` as fast as 1 kHz. Below 300 Hz first-order
    /// noise with a corner of 40 Hz seemed to rise on and on: 1.6 times what it was.
    pub(crate) fn add(&mut self, spectrum: &Spectrum, times: f64) {
        let (power, n) = (&spectrum.power, spectrum.samples as f64);
        let lowest = (power.len() as f64 / (16.0 * times)) as usize;
        let low = &power[..lowest.max(LOWEST).min(power.len())];
        for (at, p) in low.iter().enumerate().filter(|(_, p)| **p > 0.0) {
            let (x, y) = (((at + 1) as f64 / n).ln(), (p * n).ln());
            self.low.add(x, y);
            if at < LOWEST {
                self.lowest.add(x, y);
            }
        }
    }

    /// Power (N²) below the lowest bin of a window, down to one period in the log; both lengths in samples.
    pub(crate) fn power_below(&self, window: usize, log: usize, decide: &Floor) -> f64 {
        let (Some((all, _)), Some((end, error))) = (self.low.slope(), self.lowest.slope()) else {
            return 0.0;
        };
        if log <= window {
            return 0.0;
        }
        let [n, ..] = self.lowest.sums;
        // A slope of its own is a parameter more (Schwarz 1978), and only one that rises less is a corner.
        let bend = ((end - all) / error).max(0.0);
        let worth = (n / BINS_PER_INDEPENDENT).ln();
        let bent = 1.0 / (1.0 + (0.5 * (worth - bend * bend)).exp());
        let below = |line: &LogLine, slope| line.power_below(slope, (window, log), decide);
        bent * below(&self.lowest, end) + (1.0 - bent) * below(&self.low, all)
    }
}

/// Power (N²) of a whole log above a frequency (cycles per sample), motion or not: the median over
/// windows in each bin, since touches and reversals are in few windows. `None` with fewer than eight
/// windows.
pub(crate) fn median_power(
    force: &[f64],
    in_gap: &[bool],
    window: usize,
    lowest: f64,
) -> Option<f64> {
    let first = (lowest * window as f64).ceil() as usize;
    let spectra: Vec<Vec<f64>> = (0..force.len().saturating_sub(window - 1))
        .step_by(window / 2)
        .map(|from| from..from + window)
        .filter(|samples| !in_gap[samples.clone()].contains(&true))
        .map(|samples| periodogram(detrended(&force[samples])))
        .collect();
    let middle = |bin: usize| median(spectra.iter().map(|power| power[bin]));
    let bins = first - 1..window / 2 - 1;
    (spectra.len() >= 8).then(|| bins.map(middle).sum::<f64>() / std::f64::consts::LN_2)
}

/// Power (N²) per bin, from the first above 0 to the last below half the rate.
fn periodogram(wave: Vec<f64>) -> Vec<f64> {
    let n = wave.len();
    let each = wave.into_iter().enumerate();
    let windowed = each.map(|(at, value)| value * spectral::hann(at, n) * (2.0_f64 / 3.0).sqrt());
    let scale = 2.0 / (n as f64).powi(2);
    let power = &spectral::power(windowed, n)[1..n / 2];
    power.iter().map(|power| scale * power).collect()
}

/// The standard deviation of normal deviations from the median of their magnitudes, or `noise_n` where that
/// is more.
fn deviation_of(magnitudes: impl Iterator<Item = f64>, noise_n: f64) -> f64 {
    (1.4826 * median(magnitudes)).max(noise_n)
}

/// Clips what stands out by more than noise does: spikes are no noise, and a floor that counts them would
/// hide them. A line or a coloured noise has no such tails.
fn clipped(mut detrended: Vec<f64>, noise_n: f64, sigmas: f64) -> Vec<f64> {
    let most = sigmas * deviation_of(detrended.iter().map(|value| value.abs()), noise_n);
    if most > 0.0 {
        detrended
            .iter_mut()
            .for_each(|value| *value = value.clamp(-most, most));
    }
    detrended
}

/// Takes off the trend, and sets spikes to 0 that are so many and so long that they would be the trend: a
/// quarter of a rest at 35 standard deviations. A sample counts as a spike if it is more than `sigmas` standard
/// deviations from the line through the medians of the first and the last third.
fn without_spikes(force: &[f64], noise_n: f64, sigmas: f64) -> Vec<f64> {
    let third = force.len() / 3;
    let (first, last) = (&force[..third], &force[force.len() - third..]);
    let middle = |values: &[f64]| median(values.iter().copied());
    let slope = (middle(last) - middle(first)) / (force.len() - third).max(1) as f64;
    let each = force.iter().enumerate();
    let flat: Vec<f64> = each.map(|(at, force)| force - slope * at as f64).collect();
    let level = middle(&flat);
    let magnitudes: Vec<f64> = flat.iter().map(|force| (force - level).abs()).collect();
    let most = sigmas * deviation_of(magnitudes.iter().copied(), noise_n);
    let is_calm: Vec<bool> = magnitudes
        .iter()
        .map(|magnitude| *magnitude <= most)
        .collect();
    let mut detrended = detrended_by(force, &is_calm);
    let spikes = detrended
        .iter_mut()
        .zip(&is_calm)
        .filter(|(_, calm)| !**calm);
    spikes.for_each(|(value, _)| *value = 0.0);
    detrended
}

/// Takes the least-squares straight line off.
pub(crate) fn detrended(force: &[f64]) -> Vec<f64> {
    detrended_by(force, &vec![true; force.len()])
}

/// Takes the straight line through the samples that are used off all samples.
fn detrended_by(force: &[f64], is_used: &[bool]) -> Vec<f64> {
    let used = || {
        let samples = force.iter().zip(is_used).enumerate();
        let used = samples.filter(|(_, (_, used))| **used);
        used.map(|(at, (force, _))| (at as f64, *force))
    };
    let n = used().count().max(1) as f64;
    let middle = used().map(|(u, _)| u).sum::<f64>() / n;
    let mean = used().map(|(_, f)| f).sum::<f64>() / n;
    let along: f64 = used().map(|(u, f)| (u - middle) * (f - mean)).sum();
    let square: f64 = used().map(|(u, _)| (u - middle).powi(2)).sum();
    let slope = if square > 0.0 { along / square } else { 0.0 };
    let each = force.iter().enumerate();
    each.map(|(at, value)| value - mean - slope * (at as f64 - middle))
        .collect()
}
