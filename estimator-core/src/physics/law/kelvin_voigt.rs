//! Spring and damper in parallel, equation (1).

use super::contact_law::{ContactLaw, RelaxingLaw, remembers_nothing};
use super::elastic::Elastic;
use super::environment::{Damping, Environment};
use super::row::{DAMPING, LawInfo, LawRow, STIFFNESS};
use crate::maths::scalar::Scalar;

/// F = Kδ + λδ̇ for δ > 0, (1).
///
/// Its two faults on real materials (experiment E2): a force λδ̇ jumps in at zero depth, and while
/// unloading the contact pulls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KelvinVoigt<S> {
    /// K (N/m)
    pub stiffness_n_per_m: S,
    /// λ (N s/m)
    pub damping_ns_per_m: S,
}

remembers_nothing!(KelvinVoigt);

impl<S: Scalar> ContactLaw<S> for KelvinVoigt<S> {
    fn force_n(&self, depth_m: S, speed_mps: S) -> S {
        if depth_m > S::zero() {
            self.stiffness_n_per_m * depth_m + self.damping_ns_per_m * speed_mps
        } else {
            S::zero()
        }
    }
}

impl<S: Scalar> LawRow<S> for KelvinVoigt<S> {
    const INFO: LawInfo = LawInfo {
        name: "kelvin_voigt",
        alias: None,
        title: "Kelvin–Voigt",
        relaxes: false,
        summary: "F = Kδ + λδ̇",
        parameters: &[STIFFNESS, DAMPING],
        optional: &[],
        most_modes: 0,
    };

    fn from_values(
        _modes: usize,
        value: &impl Fn(&str) -> Option<S>,
        _reference_depth_m: S,
    ) -> Option<Self> {
        Some(KelvinVoigt {
            stiffness_n_per_m: value(STIFFNESS.name)?,
            damping_ns_per_m: value(DAMPING.name)?,
        })
    }

    fn parts(&self, reference_depth_m: S) -> Environment<S> {
        Environment {
            elastic: Some(Elastic::Power {
                stiffness_n_per_m: self.stiffness_n_per_m,
                exponent: S::one(),
                reference_depth_m,
            }),
            damping: Some(Damping {
                coefficient_ns_per_m: self.damping_ns_per_m,
                exponent: S::zero(),
                reference_depth_m,
            }),
            ..Environment::free()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GEL: KelvinVoigt<f64> = KelvinVoigt {
        stiffness_n_per_m: 2260.0,
        damping_ns_per_m: 123.0,
    };

    #[test]
    fn outside_the_material_nothing_happens_however_fast() {
        assert_eq!(GEL.force_n(-1e-9, 1.0), 0.0);
    }

    #[test]
    fn it_pulls_while_unloading_fast() {
        assert!((GEL.force_n(0.001, -0.03) - (2.26 - 3.69)).abs() < 1e-12);
    }
}
