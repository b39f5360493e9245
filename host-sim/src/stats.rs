//! Statistics that several rooms need.

/// Integrated autocorrelation 1 + 2Σρ(l), up to the first lag that is below its own noise 2/√N.
pub(crate) fn correlation(residuals: &[f64]) -> f64 {
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
        sum += 2.0 * rho;
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
