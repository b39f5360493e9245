//! Fung's quasi-linear law in its Hammerstein form: a static elastic response, then a linear filter,
//! equations (9)–(17).

use super::contact_law::RelaxingLaw;
use super::elastic::Elastic;
use super::environment::Environment;
use super::recovery::dent_n;
use super::relaxation::{Decay, MOST_MODES, RelaxationMode};
use super::row::{EXPONENT, LawInfo, LawRow, RELAXATION, STIFFENING_RATE, STIFFNESS};
use crate::maths::scalar::Scalar;

/// F = F⁽ᵉ⁾ − Σcᵢ(F⁽ᵉ⁾ − wᵢ), ẇᵢ = Ḟ⁽ᵉ⁾ − νᵢwᵢ, `R` modes: (9) with the relaxation function (10),
/// c₀ = 1 − Σcᵢ.
///
/// Sampled exactly for an elastic force that is linear between samples (the first-order hold): no
/// bias at any rate, and none at all in holds. Unused modes have fraction 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuasiLinear<S, const R: usize> {
    /// F⁽ᵉ⁾(δ)
    pub elastic: Elastic<S>,
    /// cᵢ and νᵢ, fast to slow.
    pub modes: [RelaxationMode<S>; R],
}

/// What a quasi-linear contact remembers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuasiLinearState<S, const R: usize> {
    /// F⁽ᵉ⁾ (N) at the last sample.
    elastic_n: S,
    /// wᵢ (N)
    unrelaxed_n: [S; R],
}

impl<S: Scalar, const R: usize> QuasiLinear<S, R> {
    /// What a period (s) does to each mode.
    fn decays(&self, period_s: S) -> [Decay<S>; R] {
        self.modes.map(|mode| mode.decay(period_s))
    }

    /// Force (N) after a period that does this to the modes, in which the elastic force went evenly to `elastic_n`.
    fn relaxed(
        &self,
        state: &mut QuasiLinearState<S, R>,
        elastic_n: S,
        decays: &[Decay<S>; R],
    ) -> S {
        let change_n = elastic_n - state.elastic_n;
        state.elastic_n = elastic_n;
        let mut force_n = elastic_n;
        let modes = self.modes.iter().zip(decays);
        for ((mode, decay), w) in modes.zip(&mut state.unrelaxed_n) {
            *w = decay.high_passed(*w, change_n);
            force_n = force_n - mode.fraction * (elastic_n - *w);
        }
        force_n
    }
}

impl<S: Scalar, const R: usize> RelaxingLaw<S> for QuasiLinear<S, R> {
    type State = QuasiLinearState<S, R>;

    fn at_rest(&self) -> Self::State {
        QuasiLinearState {
            elastic_n: S::zero(),
            unrelaxed_n: [S::zero(); R],
        }
    }

    fn step(&self, state: &mut Self::State, depth_m: S, _speed_mps: S, period_s: S) -> S {
        let force_n = self.relaxed(state, self.elastic.force_n(depth_m), &self.decays(period_s));
        if depth_m > S::zero() {
            force_n
        } else {
            S::zero()
        }
    }

    fn step_creeping(&self, state: &mut Self::State, depth_m: S, _speed_mps: S, period_s: S) -> S {
        let elastic_n = self.elastic.force_n(depth_m);
        let decays = self.decays(period_s);
        let each = self.modes.iter().zip(decays).zip(state.unrelaxed_n);
        let modes = each.map(|((mode, decay), w)| (mode.fraction, decay, w));
        let dent_n = dent_n(modes, state.elastic_n);
        let force_n = self.relaxed(state, elastic_n.max_of(dent_n), &decays);
        if elastic_n > dent_n {
            force_n
        } else {
            S::zero()
        }
    }

    fn elastic_n(&self, depth_m: S) -> S {
        self.elastic.force_n(depth_m)
    }
}

impl<S: Scalar, const R: usize> LawRow<S> for QuasiLinear<S, R> {
    const INFO: LawInfo = LawInfo {
        name: "quasi_linear",
        alias: Some("hammerstein"),
        title: "quasi-linear",
        relaxes: true,
        summary: "Kδ₀(δ/δ₀)ⁿ that relaxes in one or two modes, in up to four by batch",
        parameters: &[STIFFNESS, EXPONENT],
        optional: &[STIFFENING_RATE],
        most_modes: MOST_MODES,
    };

    fn from_values(
        modes: usize,
        value: &impl Fn(&str) -> Option<S>,
        reference_depth_m: S,
    ) -> Option<Self> {
        if modes > R.min(MOST_MODES) {
            return None;
        }
        let stiffness_n_per_m = value(STIFFNESS.name)?;
        let elastic = match value(STIFFENING_RATE.name) {
            Some(stiffening_rate_per_m) => Elastic::Exponential {
                stiffness_n_per_m,
                stiffening_rate_per_m,
            },
            None => Elastic::Power {
                stiffness_n_per_m,
                exponent: value(EXPONENT.name)?,
                reference_depth_m,
            },
        };
        let mut law = QuasiLinear {
            elastic,
            modes: [RelaxationMode::unused(); R],
        };
        for (mode, [fraction, rate]) in law.modes.iter_mut().zip(RELAXATION).take(modes) {
            mode.fraction = value(fraction.name)?;
            mode.rate_per_s = value(rate.name)?;
        }
        Some(law)
    }

    fn parts(&self, _reference_depth_m: S) -> Environment<S> {
        let mut environment = Environment {
            elastic: Some(self.elastic),
            ..Environment::free()
        };
        for (part, mode) in environment.modes.iter_mut().zip(self.modes) {
            *part = mode;
        }
        environment
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::Dual;

    const POLYURETHANE: QuasiLinear<f64, 2> = QuasiLinear {
        elastic: Elastic::Power {
            stiffness_n_per_m: 1800.0,
            exponent: 1.6,
            reference_depth_m: 1e-3,
        },
        modes: [
            RelaxationMode {
                fraction: 0.2,
                rate_per_s: 3.0,
            },
            RelaxationMode {
                fraction: 0.15,
                rate_per_s: 0.1,
            },
        ],
    };

    /// n = 1, so that the elastic force is as linear in time as the depth.
    fn linear() -> QuasiLinear<f64, 2> {
        QuasiLinear {
            elastic: Elastic::Power {
                stiffness_n_per_m: 1800.0,
                exponent: 1.0,
                reference_depth_m: 1e-3,
            },
            ..POLYURETHANE
        }
    }

    #[test]
    fn a_step_relaxes_by_the_reduced_relaxation_function() {
        let mut state = POLYURETHANE.at_rest();
        let elastic = POLYURETHANE.elastic_n(2e-3);
        // The step itself in a nanosecond.
        POLYURETHANE.step(&mut state, 2e-3, 0.0, 1e-9);
        for i in 1..20_000 {
            let t = f64::from(i) * 1e-3;
            let force = POLYURETHANE.step(&mut state, 2e-3, 0.0, 1e-3);
            let g = 0.65 + 0.2 * libm::exp(-3.0 * t) + 0.15 * libm::exp(-0.1 * t);
            // 1.5e-9 of the fast mode in the nanosecond, and rounding.
            assert!((force - elastic * g).abs() < 1e-8, "{t}: {force}");
        }
    }

    #[test]
    fn a_ramp_is_answered_by_the_integral_9() {
        // F = Kv∫g = Kv[c₀t + Σ cᵢ(1 − e^{−νᵢt})/νᵢ] for n = 1.
        let law = linear();
        let mut state = law.at_rest();
        let speed = 0.03;
        for i in 1..100 {
            let t = f64::from(i) * 1e-3;
            let force = law.step(&mut state, speed * t, speed, 1e-3);
            let slow = -0.2 * libm::expm1(-3.0 * t) / 3.0 - 0.15 * libm::expm1(-0.1 * t) / 0.1;
            let exact = 1800.0 * speed * (0.65 * t + slow);
            assert!((force - exact).abs() < 1e-12, "{force} {exact}");
        }
    }

    #[test]
    fn a_sine_in_steady_state_is_that_of_the_transfer_function() {
        // G(jω) = s·Σcᵢ/(s + νᵢ), (16), on the fundamental of K(3 mm + 1 mm sin ωt).
        let law = linear();
        let (omega, period) = (6.0, 1e-3);
        let mut state = law.at_rest();
        let (mut re, mut im) = (0.65, 0.0);
        for mode in law.modes {
            let norm = omega * omega + mode.rate_per_s * mode.rate_per_s;
            re += mode.fraction * omega * omega / norm;
            im += mode.fraction * omega * mode.rate_per_s / norm;
        }
        for i in 0..150_000 {
            let angle = omega * f64::from(i) * period;
            let force = law.step(&mut state, 3e-3 + 1e-3 * libm::sin(angle), 0.0, period);
            let steady = 5.4 * 0.65 + 1.8 * (re * libm::sin(angle) + im * libm::cos(angle));
            // 150 s = 15 time constants: 3e-7. A sine that is linear between samples: (ωT)²/12.
            if f64::from(i) * period > 149.0 {
                assert!((force - steady).abs() < 6e-6, "{force} {steady}");
            }
        }
    }

    #[test]
    fn halving_the_period_changes_nothing_for_a_piecewise_linear_elastic_force() {
        let law = linear();
        let (mut coarse, mut fine) = (law.at_rest(), law.at_rest());
        let corners = [0.0, 1e-3, 2.5e-3, 2.5e-3, 0.0, 1e-4, 3e-3];
        let mut before = 0.0;
        for depth in corners {
            let once = law.step(&mut coarse, depth, 0.0, 0.2);
            law.step(&mut fine, 0.5 * (before + depth), 0.0, 0.1);
            let twice = law.step(&mut fine, depth, 0.0, 0.1);
            assert!((once - twice).abs() < 1e-14, "{once} {twice}");
            before = depth;
        }
    }

    #[test]
    fn out_of_contact_there_is_no_force_but_the_states_decay() {
        let mut state = POLYURETHANE.at_rest();
        for _ in 0..30_000 {
            POLYURETHANE.step(&mut state, 3e-3, 0.0, 1e-3);
        }
        assert_eq!(POLYURETHANE.step(&mut state, -1e-3, 0.0, 1e-3), 0.0);
        let left = state.unrelaxed_n;
        // What relaxed in the hold is what is missing after it.
        assert!(left.iter().all(|w| *w < -1.0), "{left:?}");
        POLYURETHANE.step(&mut state, -1e-3, 0.0, 0.5);
        for ((now, then), mode) in state.unrelaxed_n.iter().zip(left).zip(POLYURETHANE.modes) {
            let decayed = then * libm::exp(-0.5 * mode.rate_per_s);
            assert!((now - decayed).abs() < 1e-14);
        }
    }

    #[test]
    fn the_exponential_response_stiffens_from_a_spring() {
        let elastic = |rate| Elastic::Exponential {
            stiffness_n_per_m: 800.0,
            stiffening_rate_per_m: rate,
        };
        assert!((elastic(0.0).force_n(3e-3_f64) - 2.4).abs() < 1e-15);
        let exact = 800.0 / 300.0 * libm::expm1(0.9);
        assert!((elastic(300.0).force_n(3e-3_f64) - exact).abs() < 1e-14);
        assert_eq!(elastic(300.0).force_n(-1e-3_f64), 0.0);
    }

    /// A stroke in and out of the material; the sum of forces weighted by time, so that every
    /// parameter counts.
    fn stroke<S: Scalar>(p: [S; 4], exponential: bool) -> S {
        let constant = S::from_f64;
        let elastic = if exponential {
            Elastic::Exponential {
                stiffness_n_per_m: p[0],
                stiffening_rate_per_m: p[1],
            }
        } else {
            Elastic::Power {
                stiffness_n_per_m: p[0],
                exponent: p[1],
                reference_depth_m: constant(1e-3),
            }
        };
        let modes = [RelaxationMode {
            fraction: p[2],
            rate_per_s: p[3],
        }];
        let law = QuasiLinear { elastic, modes };
        let mut state = law.at_rest();
        let mut sum = S::zero();
        for i in 0..600 {
            let angle = 0.02 * f64::from(i);
            let depth = constant(2e-3 * libm::sin(angle) + 1e-3);
            let force = law.step(&mut state, depth, S::zero(), constant(1e-2));
            sum = sum + force * constant(1e-3 * (1.0 + f64::from(i)));
        }
        sum
    }

    #[test]
    fn the_gradient_agrees_with_central_differences_through_contact_and_out() {
        type D = Dual<f64, 4>;
        for (exponential, at) in [
            (false, [1500.0, 1.4, 0.3, 2.0]),
            (true, [900.0, 250.0, 0.3, 2.0]),
        ] {
            let dual: [D; 4] = core::array::from_fn(|i| D::parameter(at[i], i));
            let gradient = stroke(dual, exponential).gradient;
            for (i, exact) in gradient.into_iter().enumerate() {
                let step = 1e-5 * at[i];
                let moved = |sign: f64| {
                    let mut p = at;
                    p[i] += sign * step;
                    stroke(p, exponential)
                };
                let central = (moved(1.0) - moved(-1.0)) / (2.0 * step);
                assert!(exact.is_finite());
                // Third derivatives times 1e-10, rounding over 1e-5: 1e-9 of the size.
                let size = stroke(at, exponential) / at[i];
                assert!(
                    (exact - central).abs() < 1e-7 * size,
                    "{i}: {exact} {central}"
                );
            }
        }
    }

    #[test]
    fn outside_the_material_nothing_is_not_a_number() {
        type D = Dual<f64, 4>;
        let law = QuasiLinear {
            elastic: Elastic::Power {
                stiffness_n_per_m: D::parameter(1500.0, 0),
                exponent: D::parameter(1.4, 1),
                reference_depth_m: D::constant(1e-3),
            },
            modes: [RelaxationMode {
                fraction: D::parameter(0.3, 2),
                rate_per_s: D::parameter(2.0, 3),
            }],
        };
        let mut state = law.at_rest();
        for depth in [-1e-3, 0.0, -0.0] {
            let force = law.step(
                &mut state,
                D::constant(depth),
                D::constant(0.0),
                D::constant(1e-3),
            );
            assert_eq!((force.value, force.gradient), (0.0, [0.0; 4]));
        }
    }
}
