//! Impedance shaping (Colgate): the reflected impedance is changed before it is rendered, by a gain or as a
//! function of itself.
//!
//! K′ = g·K₀(K/K₀)^p, and λ changes by the same factor: p < 1 compresses the range of materials to what a
//! master can render, p > 1 spreads materials that feel alike, p = 1 is a plain gain.

use estimator_core::Estimate;
use estimator_core::physics::law::LawKind;

/// How the reflected impedance is changed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    /// g
    pub gain: f64,
    /// p
    pub power: f64,
    /// K₀ (N/m)
    pub reference_n_per_m: f64,
}

impl Default for Shape {
    /// No change.
    fn default() -> Self {
        Shape {
            gain: 1.0,
            power: 1.0,
            reference_n_per_m: 3000.0,
        }
    }
}

/// Names of the parameters that a gain multiplies; exponents, rates and the surface stay.
const SHAPED: [&str; 3] = ["stiffness", "second_stiffness", "damping"];

impl Shape {
    /// The factor on an impedance of a stiffness (N/m).
    pub fn factor(&self, stiffness_n_per_m: f64) -> f64 {
        if stiffness_n_per_m <= 0.0 {
            return self.gain;
        }
        self.gain * (stiffness_n_per_m / self.reference_n_per_m).powf(self.power - 1.0)
    }

    /// Changes what the slave's board has identified, before it is sent. A plain gain is left to the
    /// renderer's own setting.
    pub fn apply(&self, estimate: &mut Estimate<f32>) {
        if self.power == 1.0 {
            return;
        }
        let Some(stiffness) = estimate.parameters[0] else {
            return;
        };
        let factor = (self.factor(f64::from(stiffness.value)) / self.gain) as f32;
        let names = LawKind::parameters(estimate.law);
        for (slot, info) in estimate.parameters.iter_mut().zip(names) {
            if let (Some(known), true) = (slot, SHAPED.contains(&info.name)) {
                known.value *= factor;
                known.std_error *= factor;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_below_one_brings_materials_together_and_one_is_a_gain() {
        let shape = Shape {
            gain: 0.5,
            power: 0.5,
            reference_n_per_m: 2000.0,
        };
        let felt = |stiffness: f64| stiffness * shape.factor(stiffness);
        assert!((felt(2000.0) - 1000.0).abs() < 1e-9);
        assert!((felt(8000.0) / felt(2000.0) - 2.0).abs() < 1e-12);
        let gain = Shape {
            gain: 0.7,
            ..Shape::default()
        };
        assert_eq!(gain.factor(123.0), 0.7);
    }
}
