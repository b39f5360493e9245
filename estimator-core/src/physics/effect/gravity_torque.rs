//! The weight of a lever on a machine that turns.

use super::row::effect;
use crate::maths::scalar::Scalar;

effect! {
    /// The torque A·sin(x + φ) of a lever that the machine turns.
    GravityTorque = "gravity_torque" {
        /// A (N m)
        amplitude_nm = "amplitude", Newton, NotNegative, Size, FitRange::up_to(Times(1.5, Force));
        /// φ (rad) at x = 0; 0: the lever hangs there.
        phase_rad = "phase", Radian, Angle, Shape, FitRange::ANY;
    }
    stage: LoadPath, sign: Either, proportional: false, several: false, repeats: EveryTurn, timed: false,
    laws: AnyLaw, needs_derivative: false, family: Alone, simpler: None, is_physical: |_| true,
    example: [0.5, 0.2, 0.0, 0.0], starts: &[
        Starts::at(&[Each(&[Times(0.1, Force), Times(0.5, Force)]), Each(&[
            Number(0.0), Number(0.5 * core::f64::consts::PI), Number(core::f64::consts::PI), Number(-0.5 * core::f64::consts::PI),
        ])])
        // Over less than this a sine is a straight line with a slight bend: it fitted a foot's curve over 0.36 rad.
        .where_exceeds(Times(1.0, Travel), Number(0.8)),
    ],
    law: "A·sin(x + φ)",
    signature: "one period a turn, whatever the speed; rotary machines only",
    motion: "slow free motion over half a turn and more",
}

impl<S: Scalar> GravityTorque<S> {
    /// Its torque (N m) at an angle (rad).
    pub(crate) fn torque_nm(&self, angle_rad: S) -> S {
        self.amplitude_nm * (angle_rad + self.phase_rad).sin_cos().0
    }
}
