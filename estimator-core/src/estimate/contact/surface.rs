//! Where the surface is, by the samples before a touch.

use crate::maths::scalar::Real;

/// Number of raw samples kept from before a touch: at 6σ gel is already 0.1 mm deep, some 10 samples.
pub(super) const PRE_TRIGGER: usize = 64;
/// Standard error of the mean of the kept samples, over the noise: 1/√64.
const MEAN_ERROR: f64 = 0.125;
/// Exponent of the contact of which a slow approach shows the tangent, with its standard deviation: most
/// contacts lie between a flat punch and a cone.
const EXPONENT: f64 = 1.4;
const EXPONENT_ERROR: f64 = 0.4;

/// Position of a surface with its standard error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SurfacePosition<T> {
    /// Position of the surface (m).
    pub position_m: T,
    /// Standard error of the position (m); 0 where the position is configured.
    pub std_error_m: T,
}

/// The straight line through the positions and forces before a touch.
pub(super) struct Tangent<T> {
    /// Mean position (m), with the standard deviation of the positions about it.
    position_m: T,
    spread_m: T,
    /// Mean force (N) and slope of the force over the position (N/m).
    pub(super) force_n: T,
    slope_n_per_m: T,
}

impl<T: Real> Tangent<T> {
    pub(super) fn of(samples: &[(T, T); PRE_TRIGGER]) -> Self {
        let share = T::from_f64(1.0 / PRE_TRIGGER as f64);
        let [mut position_m, mut force_n] = [T::zero(); 2];
        let (origin_m, _) = samples.first().copied().unwrap_or_default();
        for (position, force) in samples {
            position_m += (*position - origin_m) * share;
            force_n += *force * share;
        }
        let [mut square, mut product] = [T::zero(); 2];
        for (position, force) in samples {
            let from_mean = *position - origin_m - position_m;
            square += from_mean * from_mean * share;
            product += from_mean * *force * share;
        }
        Tangent {
            position_m: origin_m + position_m,
            spread_m: square.sqrt(),
            force_n,
            slope_n_per_m: product / square.max_of(T::from_f64(f64::from(f32::MIN_POSITIVE))),
        }
    }

    /// Number of samples that the motion needs for a way (m).
    pub(super) fn samples_for(&self, way_m: T) -> T {
        // A steady motion over n samples has the standard deviation of n/√12 steps.
        let step_m = self.spread_m * T::from_f64(3.464_101_6 / PRE_TRIGGER as f64);
        way_m.abs() / step_m.max_of(T::from_f64(f64::from(f32::MIN_POSITIVE)))
    }

    /// The surface where the tangent of F ∝ δⁿ puts it, δ = n·F/(dF/dδ) with n of 1.4 ± 0.4; `None` where
    /// the line begins in free air, so that it is no tangent.
    pub(super) fn surface(&self, noise_n: T) -> Option<SurfacePosition<T>> {
        // The line at its beginning, √3 standard deviations before its middle, known to two of the
        // standard errors of a mean.
        let mean_error_n = noise_n * T::from_f64(MEAN_ERROR);
        let reach = T::from_f64(1.732_050_8) * self.spread_m;
        let begins_n = self.force_n - reach * self.slope_n_per_m.abs();
        let rises = self.slope_n_per_m > T::zero() && self.spread_m > T::zero();
        let in_contact = begins_n > T::from_f64(4.0) * mean_error_n;
        if !(rises && in_contact) {
            return None;
        }
        let slope_error = mean_error_n / self.spread_m;
        let slope = self.slope_n_per_m.max_of(slope_error);
        let tangent_m = self.force_n / slope;
        let of_slope = T::from_f64(EXPONENT) * tangent_m * slope_error / slope;
        let of_exponent = T::from_f64(EXPONENT_ERROR) * tangent_m;
        Some(SurfacePosition {
            position_m: self.position_m - T::from_f64(EXPONENT) * tangent_m,
            std_error_m: (of_slope * of_slope + of_exponent * of_exponent).sqrt(),
        })
    }
}
