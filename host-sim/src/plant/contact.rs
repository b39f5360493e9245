//! A material under the probe: one of the core's laws, from a surface on, that only pushes.

use estimator_core::physics::law::{
    HuntCrossley, KelvinVoigt, QuasiLinear, QuasiLinearState, RelaxingLaw, Zener, ZenerState,
    unilateral,
};
use estimator_core::physics::rig::{Environment, MOST_MODES};

/// Most relaxation modes of a quasi-linear material; modes that are not used have fraction 0.
pub const MODES: usize = MOST_MODES;

/// The laws that the rig simulates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    /// Nothing to touch.
    Free,
    /// F = Kδ + λδ̇, (1)
    KelvinVoigt(KelvinVoigt<f64>),
    /// F = (Kδ₀ + λδ̇)(δ/δ₀)ⁿ, (3)
    HuntCrossley(HuntCrossley<f64>),
    /// The standard linear solid, (2)
    Zener(Zener<f64>),
    /// An elastic response that relaxes, (9)–(17)
    QuasiLinear(QuasiLinear<f64, MODES>),
}

/// What a material remembers of the touches so far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Memory {
    /// Nothing: the law has none.
    None,
    /// Of a Zener material.
    Zener(ZenerState<f64>),
    /// Of a quasi-linear material.
    QuasiLinear(QuasiLinearState<f64, MODES>),
}

impl Law {
    /// Before the first touch.
    pub fn at_rest(&self) -> Memory {
        match self {
            Law::Free | Law::KelvinVoigt(_) | Law::HuntCrossley(_) => Memory::None,
            Law::Zener(law) => Memory::Zener(law.at_rest()),
            Law::QuasiLinear(law) => Memory::QuasiLinear(law.at_rest()),
        }
    }

    /// Force (N) one period after the last step, see [`RelaxingLaw::step`]. A memory of another law
    /// is one of a material at rest.
    pub fn step(&self, memory: &mut Memory, depth_m: f64, speed_mps: f64, period_s: f64) -> f64 {
        match (self, &mut *memory) {
            (Law::Free, _) => 0.0,
            (Law::KelvinVoigt(law), _) => law.step(&mut (), depth_m, speed_mps, period_s),
            (Law::HuntCrossley(law), _) => law.step(&mut (), depth_m, speed_mps, period_s),
            (Law::Zener(law), Memory::Zener(state)) => {
                law.step(state, depth_m, speed_mps, period_s)
            }
            (Law::QuasiLinear(law), Memory::QuasiLinear(state)) => {
                law.step(state, depth_m, speed_mps, period_s)
            }
            _ => {
                *memory = self.at_rest();
                self.step(memory, depth_m, speed_mps, period_s)
            }
        }
    }

    /// Force (N) of a material that was at rest until now.
    pub fn force_n(&self, depth_m: f64, speed_mps: f64) -> f64 {
        self.step(&mut self.at_rest(), depth_m, speed_mps, 0.0)
    }

    /// Force at once (N), before anything relaxes: F⁽ᵉ⁾(δ).
    pub fn elastic_n(&self, depth_m: f64) -> f64 {
        match self {
            Law::Free => 0.0,
            Law::KelvinVoigt(law) => law.elastic_n(depth_m),
            Law::HuntCrossley(law) => law.elastic_n(depth_m),
            Law::Zener(law) => law.elastic_n(depth_m),
            Law::QuasiLinear(law) => law.elastic_n(depth_m),
        }
    }
}

/// A law and where its material begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// The law.
    pub law: Law,
    /// Position of the surface (m).
    pub surface_m: f64,
}

impl Contact {
    /// Free air.
    pub const FREE: Contact = Contact {
        law: Law::Free,
        surface_m: 0.0,
    };

    /// The same in the parts that effects act on.
    pub fn environment(&self) -> Environment<f64> {
        let environment = match self.law {
            Law::Free => Environment::free(),
            Law::KelvinVoigt(law) => law.into(),
            Law::HuntCrossley(law) => law.into(),
            Law::Zener(law) => law.into(),
            Law::QuasiLinear(law) => law.into(),
        };
        environment.at(self.surface_m)
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

    #[test]
    fn kelvin_voigt_under_a_prescribed_sine_is_the_closed_form() {
        let contact = Contact {
            law: Law::KelvinVoigt(KelvinVoigt {
                stiffness_n_per_m: 2260.0,
                damping_ns_per_m: 123.0,
            }),
            surface_m: 0.4e-3,
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
