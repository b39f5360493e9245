//! Non-linear spring with depth-dependent damping, equation (3).

use super::contact_law::{ContactLaw, RelaxingLaw, remembers_nothing};
use super::elastic::Elastic;
use super::environment::{Damping, Environment};
use super::row::{DAMPING, DAMPING_EXPONENT, EXPONENT, LawInfo, LawRow, STIFFNESS};
use crate::maths::scalar::Scalar;

/// F = Kδ₀(δ/δ₀)ⁿ + λδ̇(δ/δ₀)^q for δ > 0: (3) with the depth in units of δ₀.
///
/// **Units.** K (N/m) is the secant stiffness at δ₀, comparable with Kelvin–Voigt's, and λ (N s/m)
/// the damping there. In the raw form of (3): κ = K·δ₀^(1−n) (N/mⁿ), λ_raw = λ·δ₀^(−q). The numbers
/// printed in the chapter are in this form with δ₀ = 1 mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HuntCrossley<S> {
    /// K (N/m) at the reference depth.
    pub stiffness_n_per_m: S,
    /// λ (N s/m) at the reference depth.
    pub damping_ns_per_m: S,
    /// n: near 1, 3/2 for a Hertzian sphere.
    pub exponent: S,
    /// q: n unless a model says otherwise.
    pub damping_exponent: S,
    /// δ₀ (m)
    pub reference_depth_m: S,
}

impl<S: Scalar> HuntCrossley<S> {
    /// The law with q = n.
    pub fn new(
        stiffness_n_per_m: S,
        damping_ns_per_m: S,
        exponent: S,
        reference_depth_m: S,
    ) -> Self {
        HuntCrossley {
            stiffness_n_per_m,
            damping_ns_per_m,
            exponent,
            damping_exponent: exponent,
            reference_depth_m,
        }
    }

    /// κ (N/mⁿ) and λ_raw (N s/m^(q+1)) of the raw form κδⁿ + λδ^q δ̇.
    pub fn raw(&self) -> (S, S) {
        let scale = self.reference_depth_m;
        (
            self.stiffness_n_per_m * scale.pow_positive(S::one() - self.exponent),
            self.damping_ns_per_m * scale.pow_positive(-self.damping_exponent),
        )
    }
}

remembers_nothing!(HuntCrossley);

impl<S: Scalar> ContactLaw<S> for HuntCrossley<S> {
    fn force_n(&self, depth_m: S, speed_mps: S) -> S {
        let depth = depth_m / self.reference_depth_m;
        self.stiffness_n_per_m * self.reference_depth_m * depth.pow_positive(self.exponent)
            + self.damping_ns_per_m * speed_mps * depth.pow_positive(self.damping_exponent)
    }
}

impl<S: Scalar> LawRow<S> for HuntCrossley<S> {
    const INFO: LawInfo = LawInfo {
        name: "hunt_crossley",
        alias: None,
        title: "Hunt–Crossley",
        relaxes: false,
        summary: "F = (Kδ₀ + λδ̇)(δ/δ₀)ⁿ",
        parameters: &[STIFFNESS, DAMPING, EXPONENT],
        // It is n unless a model gives it.
        optional: &[DAMPING_EXPONENT],
        most_modes: 0,
    };

    fn from_values(
        _modes: usize,
        value: &impl Fn(&str) -> Option<S>,
        reference_depth_m: S,
    ) -> Option<Self> {
        let exponent = value(EXPONENT.name)?;
        Some(HuntCrossley {
            stiffness_n_per_m: value(STIFFNESS.name)?,
            damping_ns_per_m: value(DAMPING.name)?,
            exponent,
            damping_exponent: value(DAMPING_EXPONENT.name).unwrap_or(exponent),
            reference_depth_m,
        })
    }

    fn parts(&self, _reference_depth_m: S) -> Environment<S> {
        let reference_depth_m = self.reference_depth_m;
        Environment {
            elastic: Some(Elastic::Power {
                stiffness_n_per_m: self.stiffness_n_per_m,
                exponent: self.exponent,
                reference_depth_m,
            }),
            damping: Some(Damping {
                coefficient_ns_per_m: self.damping_ns_per_m,
                exponent: self.damping_exponent,
                reference_depth_m,
            }),
            ..Environment::free()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::Dual;

    #[test]
    fn the_printed_values_give_the_forces_of_the_figures() {
        // The chapter's figures: gel ≈ 10–12 N at 4.5 mm, plastic ≈ 12 N at 1 mm.
        let gel = HuntCrossley::new(1350.0, 36.0, 1.35, 1e-3);
        let plastic = HuntCrossley::new(11_500.0, 70.0, 1.2, 1e-3);
        assert!((gel.force_n(4.5e-3_f64, 0.0) - 10.29).abs() < 0.01);
        assert!((plastic.force_n(1e-3_f64, 0.0) - 11.5).abs() < 1e-9);
    }

    #[test]
    fn the_raw_form_is_the_same_law() {
        let gel = HuntCrossley::new(1350.0_f64, 36.0, 1.35, 1e-3);
        let (kappa, lambda) = gel.raw();
        let (depth, speed) = (2.7e-3_f64, 0.011);
        let raw = libm::pow(depth, 1.35) * (kappa + lambda * speed);
        assert!((gel.force_n(depth, speed) - raw).abs() < 1e-9 * raw);
    }

    #[test]
    fn no_force_at_zero_depth_and_no_gradient_that_is_not_a_number() {
        type D = Dual<f64, 3>;
        let law = HuntCrossley::new(
            D::parameter(1350.0, 0),
            D::parameter(36.0, 1),
            D::parameter(1.35, 2),
            D::constant(1e-3),
        );
        for depth in [-1e-3, 0.0] {
            let force = law.force_n(D::constant(depth), D::constant(0.1));
            assert_eq!(force.value, 0.0);
            assert_eq!(force.gradient, [0.0; 3]);
        }
    }

    #[test]
    fn the_gradient_by_stiffness_is_the_force_of_a_unit_spring() {
        type D = Dual<f64, 1>;
        let law = HuntCrossley::new(
            D::parameter(1350.0, 0),
            D::constant(0.0),
            D::constant(1.35),
            D::constant(1e-3),
        );
        let force = law.force_n(D::constant(2e-3), D::constant(0.0));
        assert!((force.gradient[0] - force.value / 1350.0).abs() < 1e-15);
    }
}
