//! A material under the probe: one of the core's laws, from a surface on, that only pushes.

use estimator_core::physics::law::{DEFAULT_REFERENCE_DEPTH_M, Law, Recovery, unilateral};
use estimator_core::physics::rig::Environment;

/// A law and where its material begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// The law.
    pub law: Law<f64>,
    /// Position of the surface (m).
    pub surface_m: f64,
    /// How it comes back after a touch, where the law relaxes.
    pub recovery: Recovery,
}

impl Contact {
    /// Free air.
    pub const FREE: Contact = Contact {
        law: Law::Free,
        surface_m: 0.0,
        recovery: Recovery::WithProbe,
    };

    /// The material in the parts that effects act on.
    pub fn environment(&self) -> Environment<f64> {
        let parts = self.law.parts(DEFAULT_REFERENCE_DEPTH_M);
        parts.at(self.surface_m).recovering(self.recovery)
    }

    /// Force on the probe (N) at `position_m` (m), moving at `speed_mps` (m/s), of a material that
    /// was at rest until now: max(law, 0), for a surface that does not stick.
    pub fn force_n(&self, position_m: f64, speed_mps: f64) -> f64 {
        unilateral(self.law.force_n(position_m - self.surface_m, speed_mps))
    }

    /// Whether a probe at `position_m` (m) is in the material.
    pub fn touches(&self, position_m: f64) -> bool {
        self.law != Law::Free && position_m > self.surface_m
    }
}

#[cfg(test)]
mod tests {
    use super::super::{GEL, PLASTIC};
    use super::*;
    use estimator_core::physics::law::KelvinVoigt;

    #[test]
    fn kelvin_voigt_under_a_prescribed_sine_is_the_closed_form() {
        let contact = Contact {
            law: Law::KelvinVoigt(KelvinVoigt {
                stiffness_n_per_m: 2260.0,
                damping_ns_per_m: 123.0,
            }),
            surface_m: 0.4e-3,
            ..Contact::FREE
        };
        // δ = A(1 − cos ωt) ≥ 0: F = KA(1 − cos ωt) + λAω sin ωt where that is positive.
        let (amplitude, omega) = (2e-3_f64, 12.0_f64);
        let (mut pushed, mut let_go) = (0, 0);
        for step in 1..1000 {
            let phase: f64 = omega * f64::from(step) * 1e-3;
            let depth = amplitude * (1.0 - phase.cos());
            let speed = amplitude * omega * phase.sin();
            let closed = 2260.0 * depth + 123.0 * speed;
            let force = contact.force_n(0.4e-3 + depth, speed);
            // The surface is added and taken away again: 1e-16 of a position, times K and λ.
            assert!((force - closed.max(0.0)).abs() < 1e-11, "{force} {closed}");
            if closed > 0.0 {
                pushed += 1
            } else {
                let_go += 1
            }
        }
        assert!(pushed > 500 && let_go > 100, "{pushed} {let_go}");
    }

    #[test]
    fn a_material_never_pulls_and_free_air_never_pushes() {
        assert_eq!(GEL.at(0.0).force_n(1e-3, -1.0), 0.0);
        assert_eq!(Contact::FREE.force_n(1.0, 1.0), 0.0);
        assert!(!Contact::FREE.touches(1.0));
    }

    #[test]
    fn the_chapters_materials_reach_its_forces() {
        for (material, low, high) in [(GEL, 9.0, 12.0), (PLASTIC, 11.0, 14.0)] {
            let force = material.at(0.0).force_n(material.peak_depth_m, 0.0);
            assert!((low..high).contains(&force), "{}: {force} N", material.name);
        }
    }
}
