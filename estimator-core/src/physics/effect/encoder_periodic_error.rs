//! An encoder whose reading ripples along the way: interpolation error, an eccentric disc.

use super::{motion::Motion, row::effect, shapes::angular_of, shapes::wave};
use crate::maths::scalar::Scalar;

effect! {
    /// The reading x_read = x + A sin(2πx/p + φ).
    EncoderPeriodicError = "encoder_periodic_error" {
        /// A (m)
        amplitude_m = "amplitude", Metre, NotNegative, Size, FitRange::up_to(Times(0.05, Travel));
        /// p (m)
        pitch_m = "pitch", Metre, Positive, Shape, Linear(Times(4.0, PositionNoise), Times(1.0, PitchInContact));
        /// φ (rad) at x = 0
        phase_rad = "phase", Radian, Angle, Shape, FitRange::ANY;
    }
    stage: PositionReading, sign: OneWay, proportional: false, several: true, repeats: AlongTheWay, timed: false,
    laws: AnyLaw, needs_derivative: false, family: Alone, simpler: None,
    // Where the reading falls while the position rises, the error is any curve at all (70 nm that
    // repeat every 140 nm).
    is_physical: |[amplitude_m, pitch_m, ..]| core::f64::consts::TAU * amplitude_m < *pitch_m,
    example: [4e-5, 1e-3, 0.2, 0.0, 0.0], starts: &[],
    law: "x_read = x + A sin(2πx/p + φ)",
    signature: "periodic in x, in contact only, scales with the local stiffness",
    motion: "slow strokes in contact over many pitches",
}

impl<S: Scalar> EncoderPeriodicError<S> {
    /// What the encoder reads (m) where the motor side is at `position_m`: the forward law.
    pub fn reading_m(&self, position_m: S) -> S {
        let angular = angular_of(self.pitch_m);
        position_m + wave(self.amplitude_m, angular, self.phase_rad, position_m).0
    }

    /// What the motor side did when this was read: x = x_read − A sin(2πx/p + φ) by two steps of
    /// Newton's method, which leave less than 10⁻⁵ of A: an encoder of use has 2πA/p < 0.2.
    pub(crate) fn motor_side(&self, read: Motion<S>) -> Motion<S> {
        let angular = angular_of(self.pitch_m);
        let at = |x: S| {
            let (ripple, slope) = wave(self.amplitude_m, angular, self.phase_rad, x);
            // Beyond s = −½ no encoder goes.
            (ripple, S::from_f64(0.5).max_of(S::one() + slope))
        };
        let mut x = read.position_m;
        for _ in 0..2 {
            let (ripple, gain) = at(x);
            x = x - (x + ripple - read.position_m) / gain;
        }
        let (ripple, gain) = at(x);
        // v_read = v(1 + s), a_read = a(1 + s) − A(2π/p)² sin(…)·v².
        let speed_mps = read.speed_mps / gain;
        let bend = ripple * angular * angular * speed_mps * speed_mps;
        Motion {
            time_s: read.time_s,
            position_m: x,
            speed_mps,
            acceleration_mps2: (read.acceleration_mps2 + bend) / gain,
        }
    }
}
