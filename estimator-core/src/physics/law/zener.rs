//! The standard linear solid: a spring in series with a spring and damper in parallel, equation (2).

use super::{
    contact_law::RelaxingLaw, elastic::Elastic, environment::Environment,
    quasi_linear::QuasiLinear, recovery::dent_n, relaxation::Decay, relaxation::RelaxationMode,
    row::DAMPING, row::LawInfo, row::LawRow, row::SECOND_STIFFNESS, row::STIFFNESS,
};
use crate::maths::scalar::Scalar;
use crate::physics::parameter::{Bounds, ParameterInfo};

/// F + λ/(κ₁+κ₂)·Ḟ = κ₁/(κ₁+κ₂)·(κ₂δ + λδ̇), (2).
///
/// A step of depth is answered by κ₁δ at once, and by κ₁κ₂/(κ₁+κ₂)·δ in the end; the time constant
/// between is λ/(κ₁+κ₂).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Zener<S> {
    /// κ₁ (N/m), the spring in series: F/δ at once.
    pub stiffness_n_per_m: S,
    /// κ₂ (N/m), parallel to the damper.
    pub second_stiffness_n_per_m: S,
    /// λ (N s/m)
    pub damping_ns_per_m: S,
}

/// What a Zener contact remembers: the depth δ (m) in the material, and how much of it the damper
/// has not followed yet, w with ẇ = δ̇ − νw (m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ZenerState<S> {
    depth_m: S,
    unrelaxed_m: S,
}

impl<S: Scalar> Zener<S> {
    /// c = κ₁/(κ₁+κ₂) and ν = (κ₁+κ₂)/λ: what relaxes of κ₁δ, and how fast.
    pub fn mode(&self) -> RelaxationMode<S> {
        let sum = self.stiffness_n_per_m + self.second_stiffness_n_per_m;
        RelaxationMode {
            fraction: self.stiffness_n_per_m / sum,
            rate_per_s: sum / self.damping_ns_per_m,
        }
    }

    /// The same law as a quasi-linear one: n = 1, r = 1.
    pub fn quasi_linear(&self, reference_depth_m: S) -> QuasiLinear<S, 1> {
        QuasiLinear {
            elastic: Elastic::Power {
                stiffness_n_per_m: self.stiffness_n_per_m,
                exponent: S::one(),
                reference_depth_m,
            },
            modes: [self.mode()],
        }
    }

    /// Force (N) of its mode after a period that does this to it, in which the depth went evenly to `depth_m` (m).
    fn relaxed(
        &self,
        state: &mut ZenerState<S>,
        depth_m: S,
        (mode, decay): (RelaxationMode<S>, Decay<S>),
    ) -> S {
        let change_m = depth_m - state.depth_m;
        state.unrelaxed_m = decay.high_passed(state.unrelaxed_m, change_m);
        state.depth_m = depth_m;
        self.stiffness_n_per_m * (depth_m - mode.fraction * (depth_m - state.unrelaxed_m))
    }

    /// κ₁κ₂/(κ₁+κ₂) (N/m): what is left of the stiffness after a long hold.
    pub fn resting_stiffness_n_per_m(&self) -> S {
        self.stiffness_n_per_m * (S::one() - self.mode().fraction)
    }
}

impl<S: Scalar> RelaxingLaw<S> for Zener<S> {
    type State = ZenerState<S>;

    fn at_rest(&self) -> ZenerState<S> {
        ZenerState {
            depth_m: S::zero(),
            unrelaxed_m: S::zero(),
        }
    }

    fn step(&self, state: &mut ZenerState<S>, depth_m: S, _speed_mps: S, period_s: S) -> S {
        let mode = self.mode();
        let decay = mode.decay(period_s);
        let force_n = self.relaxed(state, S::zero().max_of(depth_m), (mode, decay));
        if depth_m > S::zero() {
            force_n
        } else {
            S::zero()
        }
    }

    fn step_creeping(
        &self,
        state: &mut ZenerState<S>,
        depth_m: S,
        _speed_mps: S,
        period_s: S,
    ) -> S {
        // The law is linear in the depth, and so is the dent.
        let mode = self.mode();
        let decay = mode.decay(period_s);
        let only = core::iter::once((mode.fraction, decay, state.unrelaxed_m));
        let dent_m = dent_n(only, state.depth_m);
        let force_n = self.relaxed(state, depth_m.max_of(dent_m), (mode, decay));
        if depth_m > dent_m { force_n } else { S::zero() }
    }

    fn elastic_n(&self, depth_m: S) -> S {
        self.stiffness_n_per_m * S::zero().max_of(depth_m)
    }
}

impl<S: Scalar> LawRow<S> for Zener<S> {
    const INFO: LawInfo = LawInfo {
        name: "zener",
        alias: None,
        title: "Zener",
        relaxes: true,
        summary: "Standard linear solid: a spring in series with a spring and damper in parallel",
        parameters: &[
            STIFFNESS,
            SECOND_STIFFNESS,
            // Without it there is no time in which the material relaxes.
            ParameterInfo {
                bounds: Bounds::Positive,
                ..DAMPING
            },
        ],
        optional: &[],
        most_modes: 0,
    };

    fn from_values(
        _modes: usize,
        value: &impl Fn(&str) -> Option<S>,
        _reference_depth_m: S,
    ) -> Option<Self> {
        Some(Zener {
            stiffness_n_per_m: value(STIFFNESS.name)?,
            second_stiffness_n_per_m: value(SECOND_STIFFNESS.name)?,
            damping_ns_per_m: value(DAMPING.name)?,
        })
    }

    /// κ₁ that relaxes by κ₁/(κ₁+κ₂) at the rate (κ₁+κ₂)/λ: (2) is (9) with one mode and n = 1.
    fn parts(&self, reference_depth_m: S) -> Environment<S> {
        self.quasi_linear(reference_depth_m)
            .parts(reference_depth_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GEL: Zener<f64> = Zener {
        stiffness_n_per_m: 3000.0,
        second_stiffness_n_per_m: 900.0,
        damping_ns_per_m: 780.0,
    };
    const PERIOD_S: f64 = 1e-3;

    #[test]
    fn a_ramp_is_answered_by_the_solution_of_the_differential_equation() {
        // δ = vt: F = gκ₂vt + (κ₁ − gκ₂)vτ(1 − e^{−t/τ}), τ = 0.2 s, g = κ₁/(κ₁+κ₂).
        let (speed, tau, gain) = (0.01, 0.2, 3000.0 / 3900.0);
        let mut state = GEL.at_rest();
        for i in 1..3000 {
            let t = f64::from(i) * PERIOD_S;
            let force = GEL.step(&mut state, speed * t, speed, PERIOD_S);
            let rest = gain * 900.0;
            let exact = speed * (rest * t - (3000.0 - rest) * tau * libm::expm1(-t / tau));
            // 3000 steps of rounding.
            assert!((force - exact).abs() < 1e-12 * exact.max(1.0), "{t} s");
        }
    }

    #[test]
    fn it_satisfies_equation_2_under_any_motion() {
        // F + τḞ − g(κ₂δ + λδ̇) by central differences at 0.1 ms, along δ = 3 mm + 1 mm sin 7t.
        let period = 1e-4;
        let depth = |i: i32| 3e-3 + 1e-3 * libm::sin(7.0 * f64::from(i) * period);
        let mut state = GEL.at_rest();
        let mut force = [0.0; 3];
        for i in 0..20_000 {
            force = [
                force[1],
                force[2],
                GEL.step(&mut state, depth(i), 0.0, period),
            ];
            if i < 2 {
                continue;
            }
            let rate = |late: f64, early: f64| (late - early) / (2.0 * period);
            let speed = rate(depth(i), depth(i - 2));
            let left = force[1] + 0.2 * rate(force[2], force[0]);
            let right = 3000.0 / 3900.0 * (900.0 * depth(i - 1) + 780.0 * speed);
            // Central differences: τF‴h²/6 ≈ 2e-7; the bend of δ within a period: δ̈h²κ₁/12 ≈ 1e-7.
            assert!((left - right).abs() < 1e-6, "{i}: {left} {right}");
        }
    }

    #[test]
    fn it_is_the_quasi_linear_law_with_one_mode_and_exponent_one() {
        let other = GEL.quasi_linear(1e-3);
        let (mut zener, mut quasi_linear) = (GEL.at_rest(), other.at_rest());
        for i in 0..5000 {
            let depth = 2e-3 * libm::sin(9e-3 * f64::from(i)) + 5e-4;
            let a = GEL.step(&mut zener, depth, 0.0, PERIOD_S);
            let b = other.step(&mut quasi_linear, depth, 0.0, PERIOD_S);
            // d¹ is computed as exp(ln d) there.
            assert!((a - b).abs() < 1e-12, "{i}: {a} {b}");
        }
    }

    #[test]
    fn a_hold_ends_at_both_springs_in_series() {
        let mut state = GEL.at_rest();
        // One period of a week after another: exact however long.
        let at_once = GEL.step(&mut state, 1e-3, 0.0, 1e-9);
        let in_the_end = GEL.step(&mut state, 1e-3, 0.0, 6e5);
        assert!((at_once - 3.0).abs() < 1e-7, "{at_once}");
        assert!((in_the_end - 1e-3 * GEL.resting_stiffness_n_per_m()).abs() < 1e-12);
        assert!((GEL.resting_stiffness_n_per_m() - 3000.0 * 900.0 / 3900.0).abs() < 1e-9);
    }
}
