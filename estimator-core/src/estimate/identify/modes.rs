//! Conversion between the coefficients of a sampled filter and relaxation modes, (38) and (10).

use super::ForceNoise;
use super::params::IdentifyParams;
use crate::estimate::rls::Excitation;
use crate::maths::scalar::{Real, Scalar, seconds};
use crate::physics::law::RelaxationMode;

/// The sampling period of an ARX model: half of the filter's memory. Samples that are closer share
/// their noise and add no information.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ModelPeriod<T> {
    /// Time between two samples of the sensors (s).
    pub(super) sample_s: T,
    /// The same (µs).
    sample_us: u32,
    /// Number of samples of the sensors in one period of the model.
    pub(super) samples: u32,
}

impl<T: Real> ModelPeriod<T> {
    pub(super) fn new(params: &IdentifyParams<T>) -> Self {
        ModelPeriod {
            sample_s: seconds(params.period_us),
            sample_us: u32::try_from(params.period_us).unwrap_or(u32::MAX),
            samples: (params.memory_samples / 2).max(1),
        }
    }

    /// A period that is `times` as long.
    pub(super) fn slower(self, times: u32) -> Self {
        ModelPeriod {
            samples: self.samples.saturating_mul(times),
            ..self
        }
    }

    /// The period T of the model (s).
    pub(super) fn seconds(&self) -> T {
        self.sample_s * T::from_u32(self.samples)
    }

    /// How many whole periods a time (µs) has.
    fn number_in(&self, time_us: u32) -> u32 {
        let period_us = self.sample_us.saturating_mul(self.samples);
        time_us.checked_div(period_us).unwrap_or(0)
    }

    /// Variance of white noise that is, at the frequencies of a palpation, what the filter leaves of
    /// the raw noise: filtering and picking every M-th sample is worth no more than the mean of M.
    pub(super) fn variance(&self, noise: &ForceNoise<T>) -> T {
        noise.raw * noise.raw / T::from_u32(self.samples)
    }
}

/// Decides when an equation with past forces is learned from: where depth and force have moved by the
/// configured step, with forgetting, and where the force alone still relaxes, without.
///
/// A force that has come to rest is noise around one value. As a regressor it would pull every pole
/// towards that of the noise: nine minutes of it moved a rate of 0.12/s to 0.133/s.
#[derive(Clone, Copy, Debug)]
pub(super) struct RelaxationExcitation<T: Real> {
    motion: Excitation<T, 3>,
    /// The force (scaled) when it last moved.
    from: T,
    /// Number of periods since then.
    still: u32,
    /// Number of periods after which a force that has not moved is at rest.
    patience: u32,
}

/// The force relaxes when it has moved by this many standard deviations of its mean over a period:
/// noise alone does not reach it in years.
const MOVES_SIGMAS: f64 = 10.0;
/// Time (µs) within which a relaxing force moves so far: at 20 mN of noise, 6 mN/s is still a
/// relaxation.
const PATIENCE_US: u32 = 10_000_000;

impl<T: Real> RelaxationExcitation<T> {
    pub(super) fn new(period: ModelPeriod<T>) -> Self {
        RelaxationExcitation {
            motion: Excitation::default(),
            from: T::zero(),
            still: 0,
            patience: period.number_in(PATIENCE_US).max(1),
        }
    }

    /// The forgetting factor to learn with, `beta` or 1; `None` if there is nothing to learn.
    pub(super) fn admits(
        &mut self,
        regressor: [T; 3],
        force: T,
        step: T,
        sigma: T,
        beta: T,
    ) -> Option<T> {
        let moving = self.motion.admits(&regressor.into(), step);
        self.still = self.still.saturating_add(1);
        if (force - self.from).abs() > T::from_f64(MOVES_SIGMAS) * sigma {
            self.from = force;
            self.still = 0;
        }
        match (moving, self.still < self.patience) {
            (true, _) => Some(beta),
            (false, true) => Some(T::one()),
            (false, false) => None,
        }
    }
}

/// The effect of one period on a mode of rate ν.
pub(super) struct PerPeriod<S> {
    /// 1 − e^{−νT}
    pub(super) decayed: S,
    /// 1 − (1 − e^{−νT})/νT, the share of a uniform change over the period that has relaxed by its
    /// end.
    pub(super) lag: S,
}

impl<S: Scalar> PerPeriod<S> {
    pub(super) fn of(rate_per_s: S, period_s: S) -> Self {
        let x = rate_per_s * period_s;
        let mean = (-x).exprel();
        PerPeriod {
            decayed: x * mean,
            lag: S::one() - mean,
        }
    }
}

/// The rate ν (1/s) of a pole p = 1 − αT, which is −ln(1 − αT)/T for 0 < αT < 1.
pub(super) fn rate_of<S: Scalar>(alpha: S, period_s: S) -> S {
    /// Below this the series −ln(1 − x)/x = 1 + x/2 + x²/3 + … is used: the logarithm of a number
    /// near 1 would leave three digits of a slow mode in single precision. 0.05¹¹/12 = 4·10⁻¹⁶.
    const SERIES_BELOW: f64 = 0.05;
    const TERMS: u32 = 11;
    let x = alpha * period_s;
    if x >= S::from_f64(SERIES_BELOW) {
        return -((S::one() - x).ln()) / period_s;
    }
    let mut sum = S::zero();
    for k in (1..=TERMS).rev() {
        sum = sum * x + S::one() / S::from_u32(k);
    }
    alpha * sum
}

/// The mode of ż = −αz + βF⁽ᵉ⁾ in differences, z = F − F⁽ᵉ⁾: α = (1 − e^{−νT})/T, β = −cα.
/// `None` where pole or fraction is not within (0, 1), and the mode is not observable.
pub(super) fn one_mode<S: Scalar>(alpha: S, beta: S, period_s: S) -> Option<RelaxationMode<S>> {
    let stable = alpha > S::zero() && alpha * period_s < S::one();
    let relaxes = beta < S::zero() && -beta < alpha;
    (stable && relaxes).then(|| RelaxationMode {
        fraction: -beta / alpha,
        rate_per_s: rate_of(alpha, period_s),
    })
}

/// The two modes, fast before slow, of z̈ = −α₁ż − α₀z + β₁Ḟ⁽ᵉ⁾ + β₀F⁽ᵉ⁾ in differences.
///
/// With poles αf > αs, αf + αs = α₁, αf·αs = α₀: β₀ = −α₀(cf + cs), β₁ = −(cf·αf + cs·αs). `None`
/// where the poles are not real, distinct and within (0, 1), or a fraction is out of range.
pub(super) fn two_modes<S: Scalar>(
    [alpha_1, alpha_0]: [S; 2],
    [beta_1, beta_0]: [S; 2],
    period_s: S,
) -> Option<[RelaxationMode<S>; 2]> {
    let half = alpha_1 / S::from_f64(2.0);
    let discriminant = half * half - alpha_0;
    if !(alpha_0 > S::zero() && half > S::zero() && discriminant > S::zero()) {
        return None;
    }
    let fast = half + discriminant.pow_positive(S::from_f64(0.5));
    // Not half − √discriminant, which cancels when the rates lie far apart.
    let slow = alpha_0 / fast;
    if fast * period_s >= S::one() {
        return None;
    }
    let sum = -beta_0 / alpha_0;
    let of_fast = (-beta_1 - sum * slow) / (fast - slow);
    let of_slow = sum - of_fast;
    let share = |c: S| c > S::zero() && c < S::one();
    (share(of_fast) && share(of_slow) && share(sum)).then(|| {
        [(of_fast, fast), (of_slow, slow)].map(|(fraction, alpha)| RelaxationMode {
            fraction,
            rate_per_s: rate_of(alpha, period_s),
        })
    })
}

/// The coefficients a₁ and b₁ of (38) for one mode at a period T (s): F(h) = −a₁F(h−1) + F⁽ᵉ⁾(h) +
/// b₁F⁽ᵉ⁾(h−1), b₀ = 1.
pub fn hammerstein_coefficients<S: Scalar>(mode: RelaxationMode<S>, period_s: S) -> (S, S) {
    let decayed = PerPeriod::of(mode.rate_per_s, period_s).decayed;
    let pole = S::one() - decayed;
    (-pole, -(pole + mode.fraction * decayed))
}

#[cfg(test)]
mod tests {
    use super::*;

    const FAST: RelaxationMode<f64> = RelaxationMode {
        fraction: 0.2,
        rate_per_s: 3.0,
    };
    const SLOW: RelaxationMode<f64> = RelaxationMode {
        fraction: 0.15,
        rate_per_s: 0.1,
    };

    fn alpha(mode: RelaxationMode<f64>, period_s: f64) -> f64 {
        PerPeriod::of(mode.rate_per_s, period_s).decayed / period_s
    }

    #[test]
    fn one_mode_comes_back() {
        for period_s in [1e-3, 1e-2, 0.1] {
            for mode in [FAST, SLOW] {
                let a = alpha(mode, period_s);
                let back = one_mode(a, -mode.fraction * a, period_s).unwrap();
                assert!((back.fraction - mode.fraction).abs() < 1e-12);
                assert!((back.rate_per_s / mode.rate_per_s - 1.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn two_modes_come_back_fast_before_slow() {
        let period_s = 0.05;
        let (f, s) = (alpha(FAST, period_s), alpha(SLOW, period_s));
        let beta_1 = -(FAST.fraction * f + SLOW.fraction * s);
        let beta_0 = -f * s * (FAST.fraction + SLOW.fraction);
        let back = two_modes([f + s, f * s], [beta_1, beta_0], period_s).unwrap();
        for (got, truth) in back.iter().zip([FAST, SLOW]) {
            assert!((got.fraction - truth.fraction).abs() < 1e-12, "{got:?}");
            assert!((got.rate_per_s / truth.rate_per_s - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn what_no_material_does_is_not_observable() {
        // Growing, faster than a period, gaining force, relaxing to nothing.
        for (a, b) in [(-1.0, 0.1), (200.0, -1.0), (1.0, 0.2), (1.0, -1.1)] {
            assert_eq!(one_mode(a, b, 1e-2), None, "{a} {b}");
        }
        assert_eq!(one_mode(f64::NAN, -1.0, 1e-2), None);
        // Complex poles; equal poles; a negative fraction.
        for (a, b) in [
            ([2.0, 5.0], [-0.5, -1.0]),
            ([2.0, 1.0], [-0.5, -0.3]),
            ([3.1, 0.3], [1.0, -0.1]),
        ] {
            assert_eq!(two_modes(a, b, 1e-2), None, "{a:?} {b:?}");
        }
    }

    #[test]
    fn the_chapters_coefficients_have_its_gains() {
        let (a, b) = hammerstein_coefficients(FAST, 1e-3);
        // G(1) = 1 − c, the pole at e^{−νT}.
        assert!(((1.0 + b) / (1.0 + a) - 0.8).abs() < 1e-12);
        assert!((a + libm::exp(-3e-3)).abs() < 1e-15);
    }

    #[test]
    fn a_slow_rate_keeps_its_digits_in_single_precision() {
        let a = alpha(SLOW, 1e-2);
        let error = rate_of(a as f32, 1e-2_f32) / 0.1 - 1.0;
        assert!(error.abs() < 3e-7, "{error}");
    }
}
