//! Statistics that several rooms need.

/// The smallest value; ∞ if there is none.
pub(crate) fn lowest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(f64::INFINITY, f64::min)
}

/// The largest value; −∞ if there is none.
pub(crate) fn highest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(f64::NEG_INFINITY, f64::max)
}

/// The smallest and the largest value.
pub(crate) fn extent(values: &[f64]) -> (f64, f64) {
    let values = values.iter().copied();
    (lowest(values.clone()), highest(values))
}

/// The largest minus the smallest value; 0 if there is none.
pub(crate) fn range(values: &[f64]) -> f64 {
    let (lowest, highest) = extent(values);
    (highest - lowest).max(0.0)
}

/// The value below which this share of the values lies; 0 if there are none.
pub(crate) fn quantile(values: impl IntoIterator<Item = f64>, share: f64) -> f64 {
    let mut values: Vec<f64> = values.into_iter().collect();
    if values.is_empty() {
        return 0.0;
    }
    let at = (share * (values.len() - 1) as f64).round() as usize;
    *values.select_nth_unstable_by(at, f64::total_cmp).1
}

/// The median, the upper one of an even number of values; 0 if there are none.
pub(crate) fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    quantile(values, 0.5)
}

/// The standard deviation of normal numbers around 0, from the median of their magnitudes: outliers hardly move it.
pub(crate) fn robust_deviation(values: impl IntoIterator<Item = f64>) -> f64 {
    // The median of |normal| is 0.6745 σ.
    median(values.into_iter().map(f64::abs)) / 0.6745
}

/// The standard deviation of an error that is spread evenly over a step, such as what rounding leaves.
pub(crate) fn rounding_deviation(step: f64) -> f64 {
    step / 12.0_f64.sqrt()
}

/// The step that rounds with this standard deviation.
pub(crate) fn rounding_step(deviation: f64) -> f64 {
    deviation * 12.0_f64.sqrt()
}

/// The standard deviation from the mean; NaN of fewer than two.
pub(crate) fn deviation(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares = values.iter().map(|value| (value - mean).powi(2));
    (squares.sum::<f64>() / (count - 1.0)).sqrt()
}

/// The root of the mean square; 0 if there are no values.
pub(crate) fn rms(values: impl IntoIterator<Item = f64>) -> f64 {
    let (sum, count) = values.into_iter().fold((0.0, 0), |(sum, count), value| {
        (sum + value * value, count + 1)
    });
    if count == 0 {
        0.0
    } else {
        (sum / f64::from(count)).sqrt()
    }
}

/// Integrated autocorrelation 1 + 2Σρ(l), up to the first lag that is below its own noise 2/√N.
pub(crate) fn correlation(residuals: &[f64]) -> f64 {
    correlation_of_powers(residuals, 1)
}

/// The same of ρ⁴: samples for each independent one in a fourth moment of normal noise.
pub(crate) fn correlation_of_fourths(residuals: &[f64]) -> f64 {
    correlation_of_powers(residuals, 4)
}

fn correlation_of_powers(residuals: &[f64], power: i32) -> f64 {
    let count = residuals.len();
    let square: f64 = residuals.iter().map(|r| r * r).sum();
    if count < 10 || square <= 0.0 {
        return 1.0;
    }
    let noise = 2.0 / (count as f64).sqrt();
    let mut sum = 1.0;
    for lag in 1..count / 4 {
        let pairs = residuals.iter().zip(&residuals[lag..]);
        let rho = pairs.map(|(a, b)| a * b).sum::<f64>() / square;
        if rho < noise {
            break;
        }
        sum += 2.0 * rho.powi(power);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, Normal};

    const SEED_CORRELATION: u64 = 41;

    #[test]
    fn the_correlation_time_of_a_first_order_process_is_found() {
        let mut rng = rand_pcg::Pcg64::seed_from_u64(SEED_CORRELATION);
        let normal = Normal::new(0.0, 1.0).unwrap();
        for (pole, exact) in [(0.0, 1.0), (0.8, 9.0)] {
            let mut value = 0.0;
            let process: Vec<f64> = (0..40_000)
                .map(|_| {
                    value = pole * value + normal.sample(&mut rng);
                    value
                })
                .collect();
            // (1 + p)/(1 − p), less what lies beyond the lag where ρ drowns in noise.
            let found = correlation(&process);
            assert!((found / exact - 1.0).abs() < 0.1, "{pole}: {found}");
        }
    }
}
