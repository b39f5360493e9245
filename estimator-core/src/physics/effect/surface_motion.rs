//! A surface that moves by itself: breath, pulse, a shaking table.

use super::effect;
use super::wave;
use crate::maths::scalar::Scalar;

effect! {
    /// A sine in time, into and out of the material.
    SurfaceMotion = "surface_motion", Depth {
        /// A (m)
        amplitude_m = "amplitude", Metre, NotNegative;
        /// f (Hz)
        frequency_hz = "frequency", Hertz, Positive;
        /// φ (rad) at t = 0
        phase_rad = "phase", Radian, Angle;
    }
    law: "δ = tip − surface − A sin(2πft + φ)",
    signature: "in contact only, scales with the local stiffness, periodic in time",
    motion: "hold in contact for several periods",
}

impl<S: Scalar> SurfaceMotion<S> {
    /// How far the surface is displaced (m), and how fast (m/s).
    pub(crate) fn displacement(&self, time_s: S) -> (S, S) {
        let angular = S::from_f64(core::f64::consts::TAU) * self.frequency_hz;
        wave(self.amplitude_m, angular, self.phase_rad, time_s)
    }
}
