//! The discrete Fourier transform.

use std::cell::RefCell;
use std::f64::consts::TAU;

use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

thread_local! {
    /// Keeps its plans: that of a new length takes as many sines as the length, longer than the transform.
    static PLANNER: RefCell<FftPlanner<f64>> = RefCell::new(FftPlanner::new());
}

/// |Σ x(h)·e^(−2πihk/n)|² from k = 0 to n/2, of a series that is padded with zeros to n = `length` values.
pub(crate) fn power(series: impl IntoIterator<Item = f64>, length: usize) -> Vec<f64> {
    let mut bins: Vec<Complex<f64>> = series.into_iter().map(Complex::from).collect();
    bins.resize(length, Complex::default());
    let plan = PLANNER.with_borrow_mut(|planner| planner.plan_fft_forward(length));
    plan.process(&mut bins);
    let half = bins.iter().take(length / 2 + 1);
    half.map(|bin| bin.norm_sqr()).collect()
}

/// Hann's window at sample `at` of `length`, with the mean 1 and the mean square 3/2: a line leaks into two
/// bins on either side and no further.
pub(crate) fn hann(at: usize, length: usize) -> f64 {
    1.0 - (TAU * (at as f64 + 0.5) / length as f64).cos()
}
