//! What laws with memory share: relaxation modes, and their exact course from sample to sample.

use crate::maths::scalar::Scalar;

/// Most relaxation modes of a law; effects may add more.
pub const MOST_MODES: usize = 4;

/// One term cᵢe^{−νᵢt} of the reduced relaxation function g(t), (10).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelaxationMode<S> {
    /// cᵢ: the share of the elastic force that it takes away in time; all together less than 1.
    pub fraction: S,
    /// νᵢ (1/s): how fast.
    pub rate_per_s: S,
}

impl<S: Scalar> RelaxationMode<S> {
    /// A mode that takes nothing away.
    pub fn unused() -> Self {
        RelaxationMode {
            fraction: S::zero(),
            rate_per_s: S::zero(),
        }
    }

    /// What a period (s) does to it.
    pub(crate) fn decay(&self, period_s: S) -> Decay<S> {
        Decay::over(self.rate_per_s, period_s)
    }
}

/// What one period of a length does to a mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Decay<S> {
    /// e^{−νT}: what is kept of what there was.
    kept: S,
    /// Its mean over the period: what is kept of what comes evenly.
    pub(crate) mean: S,
}

impl<S: Scalar> Decay<S> {
    /// Nothing is lost in no time.
    pub(crate) fn none() -> Decay<S> {
        Decay {
            kept: S::one(),
            mean: S::one(),
        }
    }

    // A board without relaxing methods has it for rendering alone: 300 bytes each time.
    #[cfg_attr(not(feature = "relaxing"), inline(never))]
    pub(crate) fn over(rate_per_s: S, period_s: S) -> Decay<S> {
        let x = -(rate_per_s * period_s);
        Decay {
            kept: x.exp(),
            mean: x.exprel(),
        }
    }

    /// The course of ẇ = u̇ − νw over the period, in which u changes by `change`, evenly: exact, however long.
    pub(crate) fn high_passed(&self, w: S, change: S) -> S {
        w * self.kept + change * self.mean
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_series_and_the_exponential_meet() {
        for x in [-0.1, -0.099_999_999, 0.099_999_999, 0.1, 1e-9, -3.0, 0.0] {
            let exact = if x == 0.0 { 1.0 } else { libm::expm1(x) / x };
            // 10⁻¹⁶ over 0.1 on the side of the exponential.
            assert!((x.exprel() - exact).abs() < 2e-15 * exact, "{x}");
        }
    }

    #[test]
    fn single_precision_keeps_its_digits_at_slow_rates() {
        let x = -1.3e-4_f64;
        let error = f64::from((x as f32).exprel()) / (libm::expm1(x) / x) - 1.0;
        assert!(error.abs() < 1.2e-7, "{error}");
    }
}
