//! The weight of a lever on a machine that turns, and what the lever lifts through a rod.

use super::row::effect;
use crate::maths::scalar::Scalar;

effect! {
    /// The torque A·sin(x + φ) of a lever that the machine turns. A weight that a crank lifts through a rod goes
    /// up and down twice a turn besides, since the rod leans: A·λ sin θ cos θ/√(1 − λ² sin² θ), θ = x + ψ.
    GravityTorque = "gravity_torque" {
        /// A (N m)
        amplitude_nm = "amplitude", Newton, NotNegative, Size, FitRange::up_to(Times(1.5, Force));
        /// φ (rad) at x = 0; 0: the lever hangs there.
        phase_rad = "phase", Radian, Angle, Shape, FitRange::ANY;
        /// λ: the length of the crank over that of the rod.
        rod_ratio = "rod_ratio", One, NotNegative = 0.0,
            Form("a lever without a rod", TakenOn { start: Number(0.1), first: 1.0 }), FitRange::up_to(Number(0.9));
        /// ψ (rad): the crank's angle to the way of the rod's end at x = 0.
        rod_phase_rad = "rod_phase", Radian, Angle = 0.0,
            // It acts twice a turn.
            Form("along the rod's way", Beside(&[Number(0.0), Number(0.5 * core::f64::consts::PI)])), FitRange::ANY;
    }
    stage: LoadPath, sign: Either, proportional: false, several: false, repeats: EveryTurn, timed: false,
    laws: AnyLaw, needs_derivative: false, family: Alone, simpler: None, is_physical: |_| true,
    example: [0.5, 0.2, 0.0, 0.0, 0.0], starts: &[
        Starts::at(&[Each(&[Times(0.1, Force), Times(0.5, Force)]), Each(&[
            Number(0.0), Number(0.5 * core::f64::consts::PI), Number(core::f64::consts::PI), Number(-0.5 * core::f64::consts::PI),
        ])])
        // Over less than this a sine is a straight line with a slight bend: it fitted a foot's curve over 0.36 rad.
        .where_exceeds(Times(1.0, Travel), Number(0.8)),
    ],
    law: "A·sin(x + φ); with a rod: + A·λ sin θ cos θ/√(1 − λ² sin² θ), θ = x + ψ",
    signature: "one period a turn, whatever the speed; rotary machines only",
    motion: "slow free motion over half a turn and more",
}

impl<S: Scalar> GravityTorque<S> {
    /// Its torque (N m) at an angle (rad).
    pub(crate) fn torque_nm(&self, angle_rad: S) -> S {
        let lever = (angle_rad + self.phase_rad).sin_cos().0;
        if self.rod_ratio == S::zero() {
            return self.amplitude_nm * lever;
        }
        let (sin, cos) = (angle_rad + self.rod_phase_rad).sin_cos();
        let leans = self.rod_ratio * sin;
        let upright = (S::one() - leans * leans).pow_positive(S::from_f64(0.5));
        self.amplitude_nm * (lever + leans * cos / upright)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LEVER: GravityTorque<f64> = GravityTorque {
        amplitude_nm: 0.5,
        phase_rad: 0.3,
        rod_ratio: 0.4,
        rod_phase_rad: -1.1,
    };

    #[test]
    fn its_torque_is_the_slope_of_the_heights_of_the_lever_and_of_the_end_of_the_rod() {
        // GIVEN the heights −cos(x + φ) of a lever and −√(1 − λ² sin² θ)/λ of a rod's end
        let energy = |x: f64| {
            let own = LEVER;
            let leans = own.rod_ratio * (x + own.rod_phase_rad).sin();
            own.amplitude_nm
                * (-(x + own.phase_rad).cos() - (1.0 - leans * leans).sqrt() / own.rod_ratio)
        };
        for at in [-2.0, -0.4, 0.0, 0.9, 2.7] {
            // THEN the torque is what a small turn costs, to the error of a difference over 2·10⁻⁵ (third
            // derivatives below 4, rounding 10⁻¹⁶/10⁻⁵).
            let slope = (energy(at + 1e-5) - energy(at - 1e-5)) / 2e-5;
            assert!((LEVER.torque_nm(at) - slope).abs() < 1e-9, "{at}");
        }
    }

    #[test]
    fn without_a_rod_it_is_a_sine() {
        let lever = GravityTorque {
            rod_ratio: 0.0,
            ..LEVER
        };
        assert!((lever.torque_nm(0.7) - 0.5 * 1.0_f64.sin()).abs() < 1e-15);
    }
}
