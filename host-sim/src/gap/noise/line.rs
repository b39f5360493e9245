//! A line that runs through all of a log's free air, in one phase: a disturbance from outside, which
//! is at rest what it is in motion. It is no noise, and no floor may count it.

use std::f64::consts::TAU;

use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

/// A line's power over what is left about it: noise alone reaches it in e⁻³⁰ of the bins.
const CLEAR: f64 = 30.0;
/// Bins of the padded spectrum to one of the log's own; and finer steps for the frequency.
const PADDED: usize = 4;
const FINER: i32 = 8;
/// What is about it: so many of the log's own bins off.
const ABOUT: [usize; 2] = [2, 16];

/// A line, sample by sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::gap) struct Line {
    /// Cycles per sample.
    frequency: f64,
    /// Amplitudes (N).
    sine_n: f64,
    cosine_n: f64,
}

impl Line {
    /// The strongest in the samples that count, if it stands clear of what is left there.
    pub(in crate::gap) fn strongest(force: &[f64], counts: &[bool]) -> Option<Line> {
        let used: Vec<usize> = (0..force.len()).filter(|at| counts[*at]).collect();
        let mean = used.iter().map(|at| force[*at]).sum::<f64>() / used.len().max(1) as f64;
        let mut own = vec![0.0; force.len()];
        used.iter().for_each(|at| own[*at] = force[*at] - mean);
        let power = power(&own);
        // Two cycles at least.
        let first = 2 * PADDED;
        let peak = (first..power.len()).max_by(|a, b| power[*a].total_cmp(&power[*b]))?;
        let bin = 1.0 / (2 * power.len()) as f64;
        let near = (-FINER..=FINER)
            .map(|step| bin * (peak as f64 + f64::from(step) / f64::from(FINER)))
            .filter_map(|frequency| Line::fitted(&own, &used, frequency));
        let (line, _) = near.max_by(|a, b| a.1.total_cmp(&b.1))?;
        used.iter().for_each(|at| own[*at] -= line.at(*at));
        let left = self::power(&own);
        let about = (ABOUT[0] * PADDED..ABOUT[1] * PADDED)
            .flat_map(|off| [peak.checked_sub(off), Some(peak + off)])
            .flatten()
            .filter_map(|at| left.get(at));
        let (sum, count) = about.fold((0.0, 0.0), |(sum, n), own| (sum + own, n + 1.0));
        (power[peak] * count > CLEAR * sum).then_some(line)
    }

    /// The best of a frequency (cycles per sample), and what it takes off the sum of squares.
    fn fitted(own: &[f64], used: &[usize], frequency: f64) -> Option<(Line, f64)> {
        let (mut ss, mut sc, mut cc, mut s, mut c) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for at in used {
            let (sin, cos) = (TAU * frequency * *at as f64).sin_cos();
            (ss, sc, cc) = (ss + sin * sin, sc + sin * cos, cc + cos * cos);
            (s, c) = (s + sin * own[*at], c + cos * own[*at]);
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

    /// Its force (N) at a sample.
    pub(in crate::gap) fn at(&self, at: usize) -> f64 {
        let (sin, cos) = (TAU * self.frequency * at as f64).sin_cos();
        self.sine_n * sin + self.cosine_n * cos
    }
}

fn power(own: &[f64]) -> Vec<f64> {
    let padded = (PADDED * own.len()).next_power_of_two();
    let mut bins: Vec<Complex<f64>> = own.iter().map(|r| Complex::new(*r, 0.0)).collect();
    bins.resize(padded, Complex::new(0.0, 0.0));
    FftPlanner::new()
        .plan_fft_forward(padded)
        .process(&mut bins);
    let half = &bins[..padded / 2];
    half.iter().map(|bin| bin.norm_sqr()).collect()
}
