//! A force that repeats in time: hum, a fan, a pump.

use super::effect;
use super::wave;
use crate::maths::scalar::Scalar;

effect! {
    /// A sin(2πft + φ)
    PeriodicDisturbance = "periodic_disturbance", LoadPath {
        /// A (N)
        amplitude_n = "amplitude", Newton, NotNegative;
        /// f (Hz)
        frequency_hz = "frequency", Hertz, Positive;
        /// φ (rad) at t = 0
        phase_rad = "phase", Radian, Angle;
    }
    law: "A sin(2πft + φ)",
    signature: "a line in the spectrum whatever the motion",
    motion: "rest in free air",
}

impl<S: Scalar> PeriodicDisturbance<S> {
    /// Its force (N).
    pub(crate) fn force_n(&self, time_s: S) -> S {
        let angular = S::from_f64(core::f64::consts::TAU) * self.frequency_hz;
        wave(self.amplitude_n, angular, self.phase_rad, time_s).0
    }
}
