//! A material that loads along one curve and unloads along another.

use super::{row::effect, shapes::direction, shapes::leaves_some, shapes::slid};
use crate::maths::scalar::Scalar;

effect! {
    /// The elastic force Fᵉ·(1 + a·tanh(δ̇/v_t)), or with a width the change from one curve to the other takes a
    /// way, and stays in a hold. Where the curves stiffen at different rates a is a·e^{gδ}.
    LoadingCurve = "loading_curve" {
        /// a
        fraction = "fraction", One, Fraction, SizeUpTo(0.6), FitRange::up_to(Number(0.95));
        /// v_t (m/s); 0: the sign of the speed.
        transition_mps = "transition_speed", MetrePerSecond, NotNegative = 0.0,
            Form("it changes curves at once", OfTheStart), Logarithmic(Times(1e-3, Speed), Times(0.5, Speed));
        /// The way (m) from one curve to the other; 0: the speed decides.
        width_m = "width", Metre, NotNegative = 0.0,
            Form("the speed decides", OfTheStart), Logarithmic(Times(2.0, PositionNoise), Times(1.0, Travel));
        /// g (1/m): how fast the curves part; below 0 they close.
        growth_per_m = "growth", PerMetre, Any = 0.0,
            // Half of the way down it is what it was.
            Form("the same share at every depth", TakenOn { start: Per(0.5, Travel), first: 0.8 }),
            Linear(Per(-10.0, Travel), Per(10.0, Travel));
    }
    stage: Elastic, sign: OneWay, proportional: true, several: false, repeats: Never, timed: false,
    laws: AnyLaw, needs_derivative: false, family: LoopOfLoad, simpler: None, is_physical: leaves_some,
    example: [0.1, 2e-4, 0.0, 0.0, 0.0], starts: &[
        Starts::at(&[At(Number(0.05)), Each(&[
            Largest([(1.0, SpeedNoise), (2e-3, Speed)]), Largest([(4.0, SpeedNoise), (5e-2, Speed)]),
        ])]),
        Starts::at(&[At(Number(0.05)), Held(0.0), Each(&[Times(0.01, Travel), Times(0.05, Travel), Times(0.2, Travel)])]),
    ],
    law: "Fᵉ·(1 + a·tanh(δ̇/v_t)); with a width: along the way, and kept in a hold; with a growth g: a·e^{gδ} for a",
    signature: "a loop whose width is a share of the force at that depth, whatever the rate; no friction closes it",
    motion: "strokes between several depths, slow and fast",
}

impl<S: Scalar> LoadingCurve<S> {
    /// The factor on the elastic force at a depth; `z` is its memory, and `change_m` how far the depth has
    /// changed.
    pub(crate) fn factor(&self, z: &mut S, (depth_m, speed_mps): (S, S), change_m: S) -> S {
        let towards = if self.width_m > S::zero() {
            *z = slid(*z, change_m, self.width_m);
            *z
        } else {
            direction(speed_mps, self.transition_mps)
        };
        S::one() + self.fraction_at(depth_m) * towards
    }

    /// a at a depth: more than the whole force no curve can part by.
    fn fraction_at(&self, depth_m: S) -> S {
        if self.growth_per_m == S::zero() {
            return self.fraction;
        }
        let grown = self.fraction * (self.growth_per_m * depth_m).exp();
        grown.min_of(S::one())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curves_part_by_their_own_rate_and_never_by_more_than_the_force() {
        let curves = |growth_per_m: f64| LoadingCurve {
            fraction: 0.1,
            transition_mps: 0.0,
            width_m: 0.0,
            growth_per_m,
        };
        let factor = |growth_per_m: f64, depth_m: f64, speed_mps: f64| {
            curves(growth_per_m).factor(&mut 0.0, (depth_m, speed_mps), 0.0)
        };
        assert_eq!(factor(0.0, 2e-3, 1.0), 1.1);
        assert_eq!(factor(0.0, 2e-3, -1.0), 0.9);
        // e^{500 · 2 mm} = e
        let part = 0.1 * core::f64::consts::E;
        assert!((factor(500.0, 2e-3, 1.0) - (1.0 + part)).abs() < 1e-15);
        assert!((factor(500.0, 2e-3, -1.0) - (1.0 - part)).abs() < 1e-15);
        assert!((factor(-500.0, 2e-3, 1.0) - (1.0 + 0.01 / part)).abs() < 1e-15);
        assert_eq!(factor(5000.0, 2e-3, -1.0), 0.0);
    }
}
