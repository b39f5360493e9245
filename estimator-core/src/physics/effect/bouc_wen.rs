//! A restoring loop in the drive: Bouc and Wen's, with hardening.

use super::{load_memory::LoadPathMemory, row::effect};
use crate::maths::scalar::Scalar;

effect! {
    /// The force k·z with ż = v − β|v||z|^{ν−1}z − γv|z|^ν, v behind a drive_backlash. With β + γ > 0 it
    /// levels off at z = (β + γ)^{−1/ν}; with β + γ < 0 it hardens. With γ = 0 and ν = 1 it is Dahl's friction.
    BoucWen = "bouc_wen" {
        /// k (N/m)
        stiffness_n_per_m = "stiffness", NewtonPerMetre, Positive, Size, FitRange::NOT_NEGATIVE;
        /// β (1/m^ν)
        beta = "beta", PerMetrePower, Positive, Shape, Logarithmic(Per(0.5, Travel), Number(1e30));
        /// γ (1/m^ν)
        gamma = "gamma", PerMetrePower, Any, Shape, FitRange::ANY;
        /// ν (1)
        exponent = "exponent", One, Positive, Shape, Linear(Number(1.0), Number(6.0));
    }
    stage: LoadPath, sign: OneWay, proportional: true, several: false, repeats: Never, timed: false,
    laws: AnyLaw, needs_derivative: false, family: DryFriction, simpler: Some("coulomb_friction"),
    // With γ > β the loop gives more energy back than it took (Erlicher and Point 2004). Measured: a friction that only
    // sticks, with counts of 10 µm at 200 Hz, was a loop with γ of 2.4 and 3.4 β.
    is_physical: |[_, beta, gamma, ..]| *gamma <= 1.5 * *beta,
    example: [4000.0, 3000.0, 3000.0, 1.0, 0.0], starts: &[
        Starts::at(&[At(Ratio(10.0, SmallForce, Travel)), At(Per(5.0, Travel)), At(Per(5.0, Travel)), Held(1.0)]),
        Starts::at(&[At(Ratio(10.0, SmallForce, Travel)), At(PerSquare(25.0, Travel)), At(PerSquare(25.0, Travel)), Held(2.0)]),
        Starts::at(&[At(Ratio(40.0, SmallForce, Travel)), At(Per(20.0, Travel)), At(Per(20.0, Travel)), Held(1.0)]),
        Starts::at(&[At(Ratio(5.0, SmallForce, Travel)), At(Per(2.0, Travel)), At(Per(-4.0, Travel)), Held(1.0)]),
    ],
    law: "k·z, ż = v − β|v||z|^{ν−1}z − γv|z|^ν; γ + β < 0 hardens",
    signature: "a loop whose slope after a reversal is steeper than before, whatever the rate",
    motion: "strokes of several lengths in free motion",
}

impl<S: Scalar> BoucWen<S> {
    /// Its force (N) after a way of `change_m` with a play of `play_m` in front.
    pub(super) fn force_n(&self, memory: &mut LoadPathMemory<S>, change_m: S, play_m: S) -> S {
        let z = memory.follow(change_m, play_m, |z, way_m| self.moved(z, way_m));
        self.stiffness_n_per_m * z
    }

    /// Where z levels off, (β + γ)^(−1/ν) (m); 0 where it does not.
    pub(crate) fn largest_m(&self) -> S {
        let levels = self.beta + self.gamma;
        if levels > S::zero() {
            levels.pow_positive(-S::one() / self.exponent)
        } else {
            S::zero()
        }
    }

    /// z (m) after a way (m). Over a way the equation is dz/ds = 1 − λ(z)·z: that with the λ of its
    /// middle, exactly.
    fn moved(&self, z: S, way_m: S) -> S {
        let half = S::from_f64(0.5);
        let middle = self.moved_with(z, z, half * way_m);
        self.moved_with(z, middle, way_m)
    }

    /// z (m) after a way (m) with the λ of `at`.
    fn moved_with(&self, z: S, at: S, way_m: S) -> S {
        /// Where z hardens it grows by no more than this power of e in a step.
        const MOST: f64 = 5.0;
        let zero = S::zero();
        let lambda = {
            let forwards = if way_m < zero { -S::one() } else { S::one() };
            let side = if at < zero { -S::one() } else { S::one() };
            let bend = self.beta * forwards + self.gamma * side;
            bend * at.abs().pow_positive(self.exponent - S::one())
        };
        let decay = (-(lambda * way_m)).min_of(S::from_f64(MOST));
        z * decay.exp() + way_m * decay.exprel()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_loop_gives_no_more_back_than_it_took() {
        let is_physical = BoucWen::<f64>::INFO.is_physical;
        let with = |gamma: f64| is_physical(&[4e3, 3e3, gamma, 1.0, 0.0]);
        assert!(with(0.0) && with(3e3) && with(-5e3) && !with(7e3));
    }

    #[test]
    fn it_levels_off_where_beta_and_gamma_say_and_hardens_where_they_are_negative() {
        let pushed = |beta: f64, gamma: f64, exponent: f64| {
            let own = BoucWen {
                stiffness_n_per_m: 1.0,
                beta,
                gamma,
                exponent,
            };
            let mut memory = LoadPathMemory::at_rest();
            (0..20_000).fold(0.0, |_, _| own.force_n(&mut memory, 1e-6, 0.0))
        };
        // z = (β + γ)^{−1/ν}: 1/(600 + 400), and 1/√(4·10⁶ + 2·10⁶).
        assert!((pushed(600.0, 400.0, 1.0) / 1e-3 - 1.0).abs() < 1e-6);
        assert!((pushed(4e6, 2e6, 2.0) * 6e6_f64.sqrt() - 1.0).abs() < 1e-6);
        // After 20 mm with β + γ = −20 1/m: (e^{0.4} − 1)/20.
        let exact = ((0.4_f64).exp() - 1.0) / 20.0;
        assert!((pushed(30.0, -50.0, 1.0) / exact - 1.0).abs() < 1e-4);
    }
}
