//! What is touched, in the parts that effects act on: elastic force, relaxation, damping.

use crate::maths::scalar::Scalar;
use crate::physics::law::{Elastic, HuntCrossley, KelvinVoigt, QuasiLinear, RelaxationMode, Zener};

/// Most relaxation modes of an environment; effects may add more.
pub const MOST_MODES: usize = 4;

/// λ(δ/δ₀)^q δ̇
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Damping<S> {
    /// λ (N s/m) at δ₀.
    pub coefficient_ns_per_m: S,
    /// q; 0 is a damper that does not know the depth.
    pub exponent: S,
    /// δ₀ (m)
    pub reference_depth_m: S,
}

/// A contact law in parts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Environment<S> {
    /// F⁽ᵉ⁾(δ); none: there is nothing to touch.
    pub elastic: Option<Elastic<S>>,
    /// Damping beside it.
    pub damping: Option<Damping<S>>,
    /// Relaxation of the elastic force. Unused modes have fraction 0.
    pub modes: [RelaxationMode<S>; MOST_MODES],
    /// Position of the surface (m).
    pub surface_m: S,
}

impl<S: Scalar> Damping<S> {
    /// Its force (N); 0 outside the material.
    pub fn force_n(&self, depth_m: S, speed_mps: S) -> S {
        if depth_m <= S::zero() {
            return S::zero();
        }
        let linear = self.coefficient_ns_per_m * speed_mps;
        if self.exponent == S::zero() {
            return linear;
        }
        linear * (depth_m / self.reference_depth_m).pow_positive(self.exponent)
    }
}

impl<S: Scalar> Environment<S> {
    /// Free air.
    pub fn free() -> Environment<S> {
        let none = RelaxationMode {
            fraction: S::zero(),
            rate_per_s: S::zero(),
        };
        Environment {
            elastic: None,
            damping: None,
            modes: [none; MOST_MODES],
            surface_m: S::zero(),
        }
    }

    /// The same material somewhere else (m).
    #[must_use]
    pub fn at(self, surface_m: S) -> Environment<S> {
        Environment { surface_m, ..self }
    }

    /// About dF/dδ (N/m) where the speed follows the depth at `rate_per_s`: what Newton's method needs.
    pub(super) fn slope(&self, depth_m: S, speed_mps: S, rate_per_s: S) -> S {
        if depth_m <= S::zero() {
            return S::zero();
        }
        // A share of a thousandth of the depth, at least a nanometre: for a slope, not for a value.
        let step_m = S::from_f64(1e-9).max_of(depth_m * S::from_f64(1e-3));
        let force = |depth_m: S, speed_mps: S| {
            let elastic = self.elastic.map_or(S::zero(), |own| own.force_n(depth_m));
            elastic
                + self
                    .damping
                    .map_or(S::zero(), |own| own.force_n(depth_m, speed_mps))
        };
        let further = force(depth_m + step_m, speed_mps + rate_per_s * step_m);
        S::zero().max_of((further - force(depth_m, speed_mps)) / step_m)
    }
}

impl<S: Scalar> From<KelvinVoigt<S>> for Environment<S> {
    fn from(law: KelvinVoigt<S>) -> Environment<S> {
        Environment {
            elastic: Some(spring(law.stiffness_n_per_m, S::one(), S::from_f64(1e-3))),
            damping: Some(Damping {
                coefficient_ns_per_m: law.damping_ns_per_m,
                exponent: S::zero(),
                reference_depth_m: S::from_f64(1e-3),
            }),
            ..Environment::free()
        }
    }
}

impl<S: Scalar> From<HuntCrossley<S>> for Environment<S> {
    fn from(law: HuntCrossley<S>) -> Environment<S> {
        let reference = law.reference_depth_m;
        Environment {
            elastic: Some(spring(law.stiffness_n_per_m, law.exponent, reference)),
            damping: Some(Damping {
                coefficient_ns_per_m: law.damping_ns_per_m,
                exponent: law.damping_exponent,
                reference_depth_m: reference,
            }),
            ..Environment::free()
        }
    }
}

/// κ₁ that relaxes by κ₁/(κ₁+κ₂) at the rate (κ₁+κ₂)/λ: (2) is (9) with one mode and n = 1.
impl<S: Scalar> From<Zener<S>> for Environment<S> {
    fn from(law: Zener<S>) -> Environment<S> {
        let both = law.stiffness_n_per_m + law.second_stiffness_n_per_m;
        let mut environment = Environment {
            elastic: Some(spring(law.stiffness_n_per_m, S::one(), S::from_f64(1e-3))),
            ..Environment::free()
        };
        if let Some(first) = environment.modes.first_mut() {
            *first = RelaxationMode {
                fraction: law.stiffness_n_per_m / both,
                rate_per_s: both / law.damping_ns_per_m,
            };
        }
        environment
    }
}

impl<S: Scalar, const R: usize> From<QuasiLinear<S, R>> for Environment<S> {
    fn from(law: QuasiLinear<S, R>) -> Environment<S> {
        let mut environment = Environment {
            elastic: Some(law.elastic),
            ..Environment::free()
        };
        for (own, mode) in environment.modes.iter_mut().zip(law.modes) {
            *own = mode;
        }
        environment
    }
}

fn spring<S: Scalar>(stiffness_n_per_m: S, exponent: S, reference_depth_m: S) -> Elastic<S> {
    Elastic::Power {
        stiffness_n_per_m,
        exponent,
        reference_depth_m,
    }
}
