//! Spring and damper in parallel, equation (1).

use super::ContactLaw;
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

impl<S: Scalar> ContactLaw<S> for KelvinVoigt<S> {
    fn force_n(&self, depth_m: S, speed_mps: S) -> S {
        if depth_m > S::zero() {
            self.stiffness_n_per_m * depth_m + self.damping_ns_per_m * speed_mps
        } else {
            S::zero()
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
