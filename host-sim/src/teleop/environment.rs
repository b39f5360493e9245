//! What the slave touches: materials one after the other, and the same at the master's depth for comparison.

use estimator_core::physics::effect::{Effect, EffectId, Motion};
use estimator_core::physics::law::{
    Elastic, Environment as Parts, Law, QuasiLinear, RelaxationMode,
};
use estimator_core::physics::rig::{Reading, Rig, RigState};

use crate::plant::{Contact, GEL, PLASTIC};

/// A material with a name.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// The name in tables.
    pub name: String,
    /// Its law and effects.
    pub rig: Rig<f64>,
}

/// What is under the slave.
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    /// The material at the start.
    pub first: Material,
    /// The material that takes its place; `None`: nothing does.
    pub second: Option<Material>,
    /// The time from which it may (s).
    pub change_s: f64,
    /// Whether it does while the slave touches; otherwise as soon as the slave is in the air.
    pub while_touching: bool,
}

/// A contact over time.
#[derive(Clone, Debug)]
pub struct Touching {
    rig: Rig<f64>,
    state: RigState<f64>,
}

impl Touching {
    /// The material at rest.
    pub fn at_rest(material: &Material) -> Touching {
        Touching {
            rig: material.rig,
            state: material.rig.at_rest(),
        }
    }

    /// Another material, at rest.
    pub fn meet(&mut self, material: &Material) {
        self.rig = material.rig;
        self.state = self.state.renewed();
    }

    /// The contact one period (s) later.
    pub fn step(&mut self, moved: Motion<f64>, period_s: f64) -> Reading<f64> {
        self.rig.step(&mut self.state, moved, period_s)
    }

    /// The energy that is stored in the elastic part at a depth (J), from its force in 32 steps.
    pub fn stored_j(&self, depth_m: f64) -> f64 {
        const STEPS: u32 = 32;
        let Some(elastic) = self.rig.environment.elastic.filter(|_| depth_m > 0.0) else {
            return 0.0;
        };
        let width_m = depth_m / f64::from(STEPS);
        let middles = (0..STEPS).map(|step| (f64::from(step) + 0.5) * width_m);
        width_m * middles.map(|at_m| elastic.force_n(at_m)).sum::<f64>()
    }
}

impl Material {
    /// A material without effects, its surface at 0 m.
    pub fn bare(name: &str, environment: Parts<f64>) -> Material {
        Material {
            name: name.into(),
            rig: Rig::bare(environment),
        }
    }

    /// Stiffness (N/m), damping (N s/m) and exponent at 1 mm, where a board would report them: of a material that is
    /// of its law, and without effects.
    pub fn of_a_board(&self) -> [Option<f64>; 3] {
        let none = [None; 3];
        let Parts {
            elastic, damping, ..
        } = &self.rig.environment;
        let (
            Some(Elastic::Power {
                stiffness_n_per_m,
                exponent,
                reference_depth_m,
            }),
            Some(damping),
        ) = (elastic, damping)
        else {
            return none;
        };
        let of_its_law = self.rig == Rig::bare(self.rig.environment)
            && self
                .rig
                .environment
                .modes
                .iter()
                .all(|mode| mode.fraction == 0.0)
            && damping.exponent == *exponent
            && [*reference_depth_m, damping.reference_depth_m] == [1e-3; 2];
        match of_its_law {
            true => [*stiffness_n_per_m, damping.coefficient_ns_per_m, *exponent].map(Some),
            false => none,
        }
    }

    /// The secant of the elastic force at 1 mm (N/m), which is the stiffness of a law that reports there; 0 without one.
    pub fn secant_n_per_m(&self) -> f64 {
        let elastic = self.rig.environment.elastic;
        elastic.map_or(0.0, |elastic| elastic.force_n(1e-3) / 1e-3)
    }

    /// The same with its surface at 0 m, where the operator expects it.
    #[must_use]
    pub fn at_zero(mut self) -> Material {
        self.rig.environment.surface_m = 0.0;
        self
    }

    /// The chapter's gel.
    pub fn gel() -> Material {
        Material::bare(GEL.name, GEL.at(0.0).environment())
    }

    /// The chapter's plastic.
    pub fn plastic() -> Material {
        Material::bare(PLASTIC.name, PLASTIC.at(0.0).environment())
    }

    /// A foam that relaxes by a quarter, within a third of a second.
    pub fn foam() -> Material {
        let elastic = Elastic::Power {
            stiffness_n_per_m: 1800.0,
            exponent: 1.6,
            reference_depth_m: 1e-3,
        };
        let mut modes = [RelaxationMode::unused(); 4];
        modes[0] = RelaxationMode {
            fraction: 0.25,
            rate_per_s: 3.0,
        };
        let law = Law::QuasiLinear(QuasiLinear { elastic, modes });
        let contact = Contact {
            law,
            surface_m: 0.0,
            ..Contact::FREE
        };
        Material::bare("foam", contact.environment())
    }

    /// The gel with a stiffer layer 1.5 mm below its surface.
    pub fn layered() -> Material {
        let gel = Material::gel();
        let layer = Effect::new(EffectId::BuriedLayer, &[3000.0, 1.5e-3, 0.0, 0.0, 0.0]);
        Material {
            name: "layered".into(),
            rig: gel.rig.with(layer),
        }
    }

    /// A spring and a damper, for what theory is about.
    pub fn linear(stiffness_n_per_m: f64, damping_ns_per_m: f64) -> Material {
        let law = Law::KelvinVoigt(estimator_core::physics::law::KelvinVoigt {
            stiffness_n_per_m,
            damping_ns_per_m,
        });
        let contact = Contact {
            law,
            surface_m: 0.0,
            ..Contact::FREE
        };
        Material::bare("linear", contact.environment())
    }
}

impl Environment {
    /// A material that stays.
    pub fn throughout(first: Material) -> Environment {
        Environment {
            first,
            second: None,
            change_s: f64::INFINITY,
            while_touching: false,
        }
    }

    /// A material, and another one when the operator has slid off and the slave is in the air.
    pub fn changing(first: Material, second: Material) -> Environment {
        Environment {
            second: Some(second),
            ..Environment::throughout(first)
        }
    }

    /// The environments of the comparison: each begins with the material that it is named after, and
    /// goes over to another one halfway.
    pub fn compared() -> Vec<Environment> {
        vec![
            Environment::changing(Material::gel(), Material::plastic()),
            Environment::changing(Material::plastic(), Material::gel()),
            Environment::changing(Material::foam(), Material::gel()),
            Environment::changing(Material::layered(), Material::gel()),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stored_energy_is_the_integral_of_the_elastic_force() {
        let gel = Touching::at_rest(&Material::gel());
        // Kδ₀²(δ/δ₀)^(n+1)/(n + 1)
        let exact = 1350.0 * 1e-6 * 4.0_f64.powf(2.35) / 2.35;
        assert!((gel.stored_j(4e-3) / exact - 1.0).abs() < 1e-3);
        assert_eq!(gel.stored_j(-1e-3), 0.0);
    }

    #[test]
    fn every_material_of_the_comparison_pushes_and_the_foam_relaxes() {
        for environment in Environment::compared() {
            let mut touching = Touching::at_rest(&environment.first);
            let at = |time_s: f64| Motion {
                time_s,
                position_m: 1.5e-3,
                speed_mps: 0.0,
                acceleration_mps2: 0.0,
            };
            let first_n = touching.step(at(0.0), 1e-3).touch.force_n;
            let last_n =
                (1..3000).map(|ms| touching.step(at(f64::from(ms) * 1e-3), 1e-3).touch.force_n);
            let last_n = last_n.last().unwrap();
            assert!(first_n > 1.0, "{}", environment.first.name);
            assert_eq!(last_n < 0.99 * first_n, environment.first.name == "foam");
        }
    }
}
