//! The load cell's scale and zero from known weights: a line by least squares, and its quality.
//!
//! F = s·(c − z): force F (N), code c, scale s (N per code), zero z (code). With two weights the line
//! passes through both points, and nothing checks it. A third weight shows whether the cell is linear,
//! and a second zero at the end whether it drifts.

/// One known weight.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point {
    /// Mean code while the weight lay still.
    pub code: f64,
    /// Standard deviation of single samples around the mean (codes).
    pub noise_codes: f64,
    /// Force of the weight (N), positive when it pushes the probe out.
    pub force_n: f64,
}

/// The calibration line with its errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Calibration {
    /// Scale s (N per code).
    pub n_per_code: f64,
    /// Zero z (code).
    pub zero_code: f64,
    /// Relative standard error of s, from the residuals or from the noise, whichever is larger.
    pub scale_error: f64,
    /// Residual standard deviation: rms over the degrees of freedom (N); `None` with two weights.
    pub residual_n: Option<f64>,
    /// Largest deviation of a point from the line (N), and the index of that point.
    pub worst: (f64, usize),
    /// Noise of single samples (N rms).
    pub noise_n: f64,
    /// Largest absolute force of a point (N).
    pub span_n: f64,
}

/// The reason why there is no calibration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CalibrationError {
    /// There are fewer than two points, or a number is not finite.
    TooFew,
    /// All weights are the same.
    SameForce,
    /// The code moves with the weight by less than five times its noise.
    NoResponse,
}

impl core::fmt::Display for CalibrationError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            CalibrationError::TooFew => "a calibration needs at least two weights",
            CalibrationError::SameForce => "all weights are the same; no weight (0) is one of them",
            CalibrationError::NoResponse => {
                "the code does not move with the weight; is the cell connected?"
            }
        })
    }
}

impl core::error::Error for CalibrationError {}

/// The quality of a calibration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quality {
    /// The worst deviation is within 0.5 % of the span.
    Good,
    /// The worst deviation is within 2 % of the span.
    Usable,
    /// The worst deviation is beyond 2 % of the span.
    Poor,
    /// There are two weights, and nothing checks the line.
    Unchecked,
}

impl Calibration {
    /// Fits the line through the points by least squares.
    ///
    /// Codes are regressed on forces, since the weights are known and the codes are measured, and
    /// the line is inverted. The fit is exact for points on a line and has no bias from the noise of the codes.
    ///
    /// # Errors
    /// [`CalibrationError`].
    pub fn fit(points: &[Point]) -> Result<Calibration, CalibrationError> {
        let finite =
            |p: &Point| p.code.is_finite() && p.force_n.is_finite() && p.noise_codes >= 0.0;
        if points.len() < 2 || !points.iter().all(finite) {
            return Err(CalibrationError::TooFew);
        }
        let count = points.len() as f64;
        let mean = |of: fn(&Point) -> f64| points.iter().map(of).sum::<f64>() / count;
        let (mean_n, mean_code) = (mean(|p| p.force_n), mean(|p| p.code));
        let moment = |of: &dyn Fn(f64, f64) -> f64| -> f64 {
            let centred = points
                .iter()
                .map(|p| of(p.force_n - mean_n, p.code - mean_code));
            centred.sum()
        };
        let force_variation = moment(&|force, _| force * force);
        if force_variation <= 0.0 {
            return Err(CalibrationError::SameForce);
        }
        let codes_per_n = moment(&|force, code| force * code) / force_variation;
        let noise_codes = libm::sqrt(mean(|p| p.noise_codes * p.noise_codes));
        let moved = codes_per_n.abs() * libm::sqrt(force_variation / count);
        if moved <= 5.0 * noise_codes || codes_per_n == 0.0 {
            return Err(CalibrationError::NoResponse);
        }
        let n_per_code = 1.0 / codes_per_n;
        let zero_code = mean_code - codes_per_n * mean_n;
        Ok(estimates(
            points,
            n_per_code,
            zero_code,
            noise_codes,
            force_variation,
        ))
    }

    /// Returns the quality in one word.
    pub fn quality(&self) -> Quality {
        let worst = self.worst.0 / self.span_n;
        match self.residual_n {
            None => Quality::Unchecked,
            Some(_) if worst <= 0.005 => Quality::Good,
            Some(_) if worst <= 0.02 => Quality::Usable,
            Some(_) => Quality::Poor,
        }
    }

    /// Returns how far the zero has moved (N) if the unloaded cell now reads `code`.
    pub fn drift_n(&self, code: f64) -> f64 {
        (code - self.zero_code) * self.n_per_code
    }
}

/// Returns the line with its errors.
fn estimates(
    points: &[Point],
    n_per_code: f64,
    zero_code: f64,
    noise_codes: f64,
    force_variation: f64,
) -> Calibration {
    let mut worst = (0.0, 0);
    let (mut squares, mut span_n) = (0.0, 0.0_f64);
    for (index, point) in points.iter().enumerate() {
        let deviation = (point.code - zero_code) * n_per_code - point.force_n;
        squares += deviation * deviation;
        span_n = span_n.max(point.force_n.abs());
        if deviation.abs() > worst.0 {
            worst = (deviation.abs(), index);
        }
    }
    let freedom = points.len() as f64 - 2.0;
    let residual_n = (freedom > 0.0).then(|| libm::sqrt(squares / freedom));
    let noise_n = noise_codes * n_per_code.abs();
    Calibration {
        n_per_code,
        zero_code,
        scale_error: residual_n.unwrap_or(0.0).max(noise_n) / libm::sqrt(force_variation),
        residual_n,
        worst,
        noise_n,
        span_n,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    extern crate std;
    use std::vec::Vec;

    /// Points of a cell of `n_per_code` with its zero at 65 000, which deviates by `curvature` codes at 20 N.
    fn points(forces: &[f64], n_per_code: f64, curvature: f64) -> Vec<Point> {
        let point = |force_n: &f64| Point {
            code: 65_000.0 + force_n / n_per_code + curvature * (force_n / 20.0) * (force_n / 20.0),
            noise_codes: 8.0,
            force_n: *force_n,
        };
        forces.iter().map(point).collect()
    }

    #[test]
    fn a_straight_cell_of_either_sign_gives_its_scale_and_zero_exactly() {
        for scale in [7.6e-4, -7.6e-4] {
            let fit = Calibration::fit(&points(&[0.0, 4.905, 9.81, 19.62], scale, 0.0)).unwrap();
            // Rounding of f64 at 1e5 codes: 1e-11 codes.
            assert!((fit.n_per_code / scale - 1.0).abs() < 1e-9);
            assert!((fit.zero_code - 65_000.0).abs() < 1e-6);
            assert!((fit.noise_n - 8.0 * 7.6e-4).abs() < 1e-12);
            assert_eq!(fit.quality(), Quality::Good);
            // A zero that is 100 codes off has moved by 76 mN.
            assert!((fit.drift_n(65_100.0) - 100.0 * scale).abs() < 1e-9);
        }
    }

    #[test]
    fn a_curved_cell_shows_in_the_residuals() {
        // 20 N are 26 316 codes; a sagitta of b codes leaves b/8 at the middle of the line.
        for (curvature, quality) in [
            (500.0, Quality::Good),
            (2000.0, Quality::Usable),
            (8000.0, Quality::Poor),
        ] {
            let fit = Calibration::fit(&points(&[0.0, 5.0, 10.0, 15.0, 20.0], 7.6e-4, curvature));
            let fit = fit.unwrap();
            assert_eq!(fit.quality(), quality, "{curvature}: {fit:?}");
            assert!(fit.residual_n.unwrap() > 0.0);
        }
    }

    #[test]
    fn one_wrong_weight_is_named() {
        let mut all = points(&[0.0, 5.0, 10.0, 15.0, 20.0], 7.6e-4, 0.0);
        all[3].force_n = 12.0;
        assert_eq!(Calibration::fit(&all).unwrap().worst.1, 3);
    }

    #[test]
    fn two_weights_fit_but_nothing_checks_them() {
        let fit = Calibration::fit(&points(&[0.0, 9.81], 7.6e-4, 300.0)).unwrap();
        assert_eq!(fit.quality(), Quality::Unchecked);
        assert_eq!(fit.residual_n, None);
        assert!(fit.worst.0 < 1e-9);
    }

    #[test]
    fn what_cannot_be_a_calibration_is_refused_for_its_reason() {
        let error = |points: &[Point]| Calibration::fit(points).unwrap_err();
        assert_eq!(error(&points(&[1.0], 1e-3, 0.0)), CalibrationError::TooFew);
        assert_eq!(
            error(&points(&[2.0, 2.0, 2.0], 1e-3, 0.0)),
            CalibrationError::SameForce
        );
        // 20 N move it by 2 codes, and its noise is 8.
        assert_eq!(
            error(&points(&[0.0, 20.0], 10.0, 0.0)),
            CalibrationError::NoResponse
        );
        let mut nan = points(&[0.0, 20.0], 1e-3, 0.0);
        nan[1].code = f64::NAN;
        assert_eq!(error(&nan), CalibrationError::TooFew);
    }
}
