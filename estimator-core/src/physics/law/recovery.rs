//! How the surface of a material that relaxes comes back where a probe has left it.

use super::{RelaxingLaw, relaxation::Decay};
use crate::maths::scalar::Scalar;

/// What the surface does between touches. Until the probe leaves it for the first time, and long after, both are the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Recovery {
    /// It follows the probe to where it was before the first touch, and the force is max(law, 0): the chapter's model.
    #[default]
    WithProbe,
    /// Nothing pulls it: a dent stays, which fills as fast as the material creeps without a force, and a
    /// probe that comes back meets it deeper. A Zener material's dent halves in ln 2·λ/κ₂.
    ByCreep,
}

impl Recovery {
    /// Name in files.
    pub const fn name(self) -> &'static str {
        match self {
            Recovery::WithProbe => "with_probe",
            Recovery::ByCreep => "creep",
        }
    }

    /// The one with this name.
    pub fn from_name(name: &str) -> Option<Recovery> {
        let both = [Recovery::WithProbe, Recovery::ByCreep];
        both.into_iter().find(|own| own.name() == name)
    }

    /// One step of a law with this surface; see [`RelaxingLaw::step`].
    pub fn step<S: Scalar, L: RelaxingLaw<S>>(
        self,
        law: &L,
        state: &mut L::State,
        depth_m: S,
        speed_mps: S,
        period_s: S,
    ) -> S {
        match self {
            Recovery::WithProbe => law.step(state, depth_m, speed_mps, period_s),
            Recovery::ByCreep => law.step_creeping(state, depth_m, speed_mps, period_s),
        }
    }
}

/// The elastic force E (N) of a dent one period (s) later if nothing presses: that with which
/// E − Σcᵢ(E − wᵢ) = 0, (9), where wᵢ follows E from `elastic_n` on; of each mode cᵢ, what the period does to it, and wᵢ.
/// Linear in E, whatever its form; of a law that is linear in the depth all of them may be depths (m).
pub(crate) fn dent_n<S: Scalar>(modes: impl Iterator<Item = (S, Decay<S>, S)>, elastic_n: S) -> S {
    let (mut held_n, mut slope) = (S::zero(), S::one());
    for (fraction, decay, w) in modes {
        held_n = held_n + fraction * decay.high_passed(w, -elastic_n);
        slope = slope - fraction * (S::one() - decay.mean);
    }
    // Σcᵢ < 1, so that the slope is above 0.
    S::zero().max_of(-held_n / slope)
}

#[cfg(test)]
mod tests {
    use super::super::{Elastic, QuasiLinear, RelaxationMode, Zener};
    use super::*;

    const MATERIAL: Zener<f64> = Zener {
        stiffness_n_per_m: 1400.0,
        second_stiffness_n_per_m: 1867.0,
        damping_ns_per_m: 980.0,
    };

    /// Pressed 2 mm deep for a second, and left.
    fn pressed<L: RelaxingLaw<f64>>(law: &L) -> L::State {
        let mut state = law.at_rest();
        for _ in 0..1000 {
            law.step_creeping(&mut state, 2e-3, 0.0, 1e-3);
        }
        state
    }

    /// The depth (m) at which a probe that comes back at once meets the material.
    fn met_m<L: RelaxingLaw<f64>>(law: &L, state: &L::State) -> f64 {
        let (mut inside, mut outside) = (2e-3, 0.0);
        for _ in 0..50 {
            let middle = 0.5 * (inside + outside);
            match law.step_creeping(&mut state.clone(), middle, 0.0, 1e-9) > 0.0 {
                true => inside = middle,
                false => outside = middle,
            }
        }
        inside
    }

    #[test]
    fn a_dent_of_a_standard_solid_fills_at_its_retardation_time() {
        // The depth that the damper has followed, κ₁δ = κ₂(...): what is left once the spring in series lets go.
        let mode = MATERIAL.mode();
        let followed_m = 2e-3 * mode.fraction * (1.0 - (-mode.rate_per_s).exp());
        let retardation_s = MATERIAL.damping_ns_per_m / MATERIAL.second_stiffness_n_per_m;
        for samples in [1, 100, 500, 2000] {
            let mut state = pressed(&MATERIAL);
            for _ in 0..samples {
                MATERIAL.step_creeping(&mut state, -1e-3, 0.0, 1e-3);
            }
            let left_m = followed_m * (-1e-3 * f64::from(samples) / retardation_s).exp();
            let error_m = met_m(&MATERIAL, &state) - left_m;
            // The probe leaves within the first sample: a thousandth of the retardation time.
            assert!(error_m.abs() < 2e-3 * left_m, "{samples}: {error_m}");
        }
    }

    #[test]
    fn what_a_zener_material_does_its_quasi_linear_form_does() {
        let other = MATERIAL.quasi_linear(1e-3);
        let (mut one, mut two) = (MATERIAL.at_rest(), other.at_rest());
        for i in 0..3000 {
            let depth_m = 1e-3 + 2e-3 * (6e-3 * f64::from(i)).sin();
            let own = MATERIAL.step_creeping(&mut one, depth_m, 0.0, 1e-3);
            let same = other.step_creeping(&mut two, depth_m, 0.0, 1e-3);
            assert!((own - same).abs() < 1e-12, "{i}: {own} {same}");
        }
    }

    #[test]
    fn a_first_touch_is_the_chapters_until_it_lets_go() {
        let law = QuasiLinear::<f64, 2> {
            elastic: Elastic::Power {
                stiffness_n_per_m: 1800.0,
                exponent: 1.6,
                reference_depth_m: 1e-3,
            },
            modes: [(0.2, 3.0), (0.3, 0.5)].map(|(fraction, rate_per_s)| RelaxationMode {
                fraction,
                rate_per_s,
            }),
        };
        let (mut held, mut creeping) = (law.at_rest(), law.at_rest());
        let mut let_go = false;
        for i in 0..2000 {
            let depth_m = 2e-3 * (2e-3 * f64::from(i)).sin();
            let chapter = law.step(&mut held, depth_m, 0.0, 1e-3);
            let own = law.step_creeping(&mut creeping, depth_m, 0.0, 1e-3);
            let_go |= chapter < 0.0;
            assert!(
                own >= 0.0 && (let_go || own == chapter),
                "{i}: {own} {chapter}"
            );
        }
        // Deep after 1.5 s: by then something had crept, and the chapter's law pulls where this one lets go.
        assert!(let_go && law.step(&mut held, 1e-4, 0.0, 1e-3) < 0.0);
    }
}
