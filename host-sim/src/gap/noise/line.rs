//! A spectral line that runs through all of a log's free air in one phase: a disturbance from outside, the
//! same at rest and in motion. It is not noise, and no noise floor may count it.

use std::f64::consts::TAU;

use crate::spectral;

/// Bins of the padded spectrum for each bin of the log.
const PADDING: usize = 4;
/// Steps on either side of the highest bin, and in a bin, in which the frequency is refined.
const REFINEMENT: i32 = 8;
/// Distances (bins of the log) from the line between which its surroundings lie.
const SURROUNDINGS: [usize; 2] = [2, 16];

/// A sine wave in the force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Line {
    /// Frequency (cycles per sample).
    frequency: f64,
    /// Amplitude of the sine (N).
    sine_n: f64,
    /// Amplitude of the cosine (N).
    cosine_n: f64,
}

impl Line {
    /// Takes the line out of forces (N).
    pub(super) fn take_out_of(&self, force_n: &mut [f64]) {
        let each = force_n.iter_mut().enumerate();
        each.for_each(|(at, force)| *force -= self.at(at as f64));
    }

    /// Finds the strongest line in the samples that are used, if its power is `prominence` times
    /// the mean of what is left around it.
    pub(crate) fn strongest(force: &[f64], is_used: &[bool], prominence: f64) -> Option<Line> {
        let used: Vec<usize> = (0..force.len()).filter(|at| is_used[*at]).collect();
        let mean = used.iter().map(|at| force[*at]).sum::<f64>() / used.len().max(1) as f64;
        let mut deviation = vec![0.0; force.len()];
        used.iter()
            .for_each(|at| deviation[*at] = force[*at] - mean);
        let power = padded_power(&deviation);
        // The log holds at least two cycles of a line.
        let first = 2 * PADDING;
        let peak = (first..power.len()).max_by(|a, b| power[*a].total_cmp(&power[*b]))?;
        let bin = 1.0 / (2 * power.len()) as f64;
        let candidates = (-REFINEMENT..=REFINEMENT)
            .map(|step| bin * (peak as f64 + f64::from(step) / f64::from(REFINEMENT)))
            .filter_map(|frequency| Line::fitted(&deviation, &used, frequency));
        let (line, _) = candidates.max_by(|a, b| a.1.total_cmp(&b.1))?;
        used.iter()
            .for_each(|at| deviation[*at] -= line.at(*at as f64));
        let remainder = padded_power(&deviation);
        let around = (SURROUNDINGS[0] * PADDING..SURROUNDINGS[1] * PADDING)
            .flat_map(|offset| [peak.checked_sub(offset), Some(peak + offset)])
            .flatten()
            .filter_map(|at| remainder.get(at));
        let (sum, count) = around.fold((0.0, 0.0), |(sum, n), power| (sum + power, n + 1.0));
        (power[peak] * count > prominence * sum).then_some(line)
    }

    /// The least-squares line of a frequency (cycles per sample), and what it takes off the sum of squares.
    fn fitted(deviation: &[f64], used: &[usize], frequency: f64) -> Option<(Line, f64)> {
        let (mut ss, mut sc, mut cc, mut s, mut c) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for at in used {
            let (sin, cos) = (TAU * frequency * *at as f64).sin_cos();
            (ss, sc, cc) = (ss + sin * sin, sc + sin * cos, cc + cos * cos);
            (s, c) = (s + sin * deviation[*at], c + cos * deviation[*at]);
        }
        let determinant = ss * cc - sc * sc;
        let (sine_n, cosine_n) = (
            (s * cc - c * sc) / determinant,
            (c * ss - s * sc) / determinant,
        );
        let line = Line {
            frequency,
            sine_n,
            cosine_n,
        };
        (determinant > 1e-6 * ss * cc).then_some((line, sine_n * s + cosine_n * c))
    }

    /// The line that has this one as its second differences.
    pub(crate) fn undifferenced(self) -> Line {
        let factor = 2.0 * (TAU * self.frequency).cos() - 2.0;
        Line {
            sine_n: self.sine_n / factor,
            cosine_n: self.cosine_n / factor,
            ..self
        }
    }

    /// Its root mean square (N).
    pub(crate) fn rms_n(&self) -> f64 {
        self.sine_n.hypot(self.cosine_n) / 2.0_f64.sqrt()
    }

    /// The force (N) of the line at a place (samples).
    pub(crate) fn at(&self, at: f64) -> f64 {
        let (sin, cos) = (TAU * self.frequency * at).sin_cos();
        self.sine_n * sin + self.cosine_n * cos
    }
}

/// The power spectrum below half the rate, of a series padded with zeros to `PADDING` times its length.
fn padded_power(series: &[f64]) -> Vec<f64> {
    let padded = (PADDING * series.len()).next_power_of_two();
    let mut power = spectral::power(series.iter().copied(), padded);
    power.truncate(padded / 2);
    power
}
