//! Spectral densities of the residuals, by Welch's method.

use super::bins::LogCurves;
use crate::gap::Finding;
use crate::report::{Figure, plot::Axis, plot::Chart, plot::Ink, plot::Series, plot::Stroke};
use crate::spectral;

/// The longest segment. At 500 Hz it gives eight bins below 1 Hz.
const LONGEST: usize = 4096;
/// Points of a curve, equally spaced on the logarithmic axis.
const POINTS: f64 = 160.0;

/// The densities of the residuals before and after, compared with that of the noise floor.
pub(super) fn figure(log: &LogCurves<'_>, finding: &Finding) -> Figure {
    let time = &log.curves.time_s;
    let period_s = match time.len() {
        0 | 1 => 1.0,
        count => (time[count - 1] - time[0]) / (count - 1) as f64,
    };
    let most_hz = finding
        .bandwidth_hz
        .unwrap_or(f64::INFINITY)
        .min(0.5 / period_s);
    let curve = |name, ink, residuals: &[f64]| {
        let (hz, density) = density(residuals, period_s, most_hz);
        Series::new(name, ink, Stroke::Solid, hz, density)
    };
    let before = log
        .changed
        .then(|| curve("before", Ink::Second, &log.before_n));
    let name = if log.changed { "after" } else { "base model" };
    let after = curve(name, Ink::First, &log.after_n);
    // White noise of this standard deviation, all of it below the highest frequency.
    let floor = finding.noise_floor_n / most_hz.sqrt();
    let ends = vec![
        1.0 / (LONGEST.min(time.len()).max(2) as f64 * period_s),
        most_hz,
    ];
    let chart = Chart::new(
        Axis::new("Frequency", "Hz").log(),
        Axis::new("Density of the residual", "N/√Hz").log(),
    )
    .series(Series::new(
        "floor",
        Ink::Muted,
        Stroke::Dashed,
        ends,
        vec![floor; 2],
    ));
    let chart = before.into_iter().chain([after]).fold(chart, Chart::series);
    Figure::new("Spectrum of the residual", &chart).caption(
        "Amplitude density over frequency; dashed: the noise floor as white noise. Where the last \
         model's residual stands above the floor it is unexplained, or an error of the motion. A peak is a line of \
         the spectrum: hum, or cogging at a constant speed.",
    )
}

/// Frequencies (Hz) and densities (N/√Hz) up to a highest frequency. The densities are means over equal
/// steps of the logarithm of the frequency.
fn density(residuals: &[f64], period_s: f64, most_hz: f64) -> (Vec<f64>, Vec<f64>) {
    let length = LONGEST.min(residuals.len());
    if length < 16 {
        return (Vec::new(), Vec::new());
    }
    let power = welch(residuals, length);
    let step_hz = 1.0 / (length as f64 * period_s);
    let decades = ((length / 2) as f64).ln();
    let (mut hz, mut out) = (Vec::new(), Vec::new());
    let mut at = 1;
    while at < power.len() {
        // The next point is at least one bin further.
        let next = ((at as f64) * (decades / POINTS).exp()).ceil() as usize;
        let next = next.clamp(at + 1, power.len());
        let middle_hz = 0.5 * (at + next - 1) as f64 * step_hz;
        let mean = power[at..next].iter().sum::<f64>() / (next - at) as f64;
        if mean > 0.0 && middle_hz <= most_hz {
            hz.push(middle_hz);
            out.push((mean * 2.0 * period_s).sqrt());
        }
        at = next;
    }
    (hz, out)
}

/// Mean power of the bins of half-overlapping segments under Hann's window: 1 for white noise of unit
/// variance. A sample that is not finite counts as 0.
fn welch(residuals: &[f64], length: usize) -> Vec<f64> {
    let window: Vec<f64> = (0..length)
        .map(|at| spectral::hann(at, length) * (2.0_f64 / 3.0).sqrt())
        .collect();
    let mut power = vec![0.0; length / 2];
    let mut segments = 0.0;
    for from in (0..=residuals.len() - length).step_by((length / 2).max(1)) {
        let segment = &residuals[from..from + length];
        let finite = segment.iter().filter(|r| r.is_finite());
        let mean = finite.clone().sum::<f64>() / (finite.count() as f64).max(1.0);
        let each = segment.iter().zip(&window);
        let windowed = each.map(|(r, w)| if r.is_finite() { (r - mean) * w } else { 0.0 });
        for (sum, bin) in power.iter_mut().zip(spectral::power(windowed, length)) {
            *sum += bin / length as f64;
        }
        segments += 1.0;
    }
    power.iter().map(|sum| sum / segments).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tone_stands_at_its_frequency_and_its_power_comes_back() {
        let period_s = 1e-3;
        let tone: Vec<f64> = (0..20_000)
            .map(|at| 0.3 * (std::f64::consts::TAU * 50.0 * f64::from(at) * period_s).sin())
            .collect();
        let power = welch(&tone, LONGEST);
        let total: f64 = power.iter().sum::<f64>() * 2.0 / LONGEST as f64;
        // Mean square of a sine of 0.3: 0.045. The window's mean square differs from segment to
        // segment by the phase of the tone, below 1 %.
        assert!((total - 0.045).abs() < 5e-4, "{total}");
        let (hz, density) = density(&tone, period_s, 500.0);
        let peak = (0..hz.len())
            .max_by(|a, b| density[*a].total_cmp(&density[*b]))
            .unwrap();
        // Points are 5 % apart.
        assert!((hz[peak] - 50.0).abs() < 2.5, "{}", hz[peak]);
    }

    #[test]
    fn a_log_of_a_few_samples_has_no_spectrum() {
        assert_eq!(density(&[1.0; 10], 1e-3, 500.0), (Vec::new(), Vec::new()));
    }
}
