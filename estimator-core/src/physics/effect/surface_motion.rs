//! A surface that moves by itself: breath, pulse, a shaking table.

use super::{row::effect, shapes::wave};
use crate::maths::scalar::Scalar;

effect! {
    /// A sine in time, into and out of the material.
    SurfaceMotion = "surface_motion" {
        /// A (m)
        amplitude_m = "amplitude", Metre, NotNegative, Size, FitRange::up_to(Times(0.3, Travel));
        // A little beyond half of the rate: of a log at 200 Hz of which every second sample is searched, mains stood at
        // the bound, without a standard error.
        /// f (Hz)
        frequency_hz = "frequency", Hertz, Positive, Shape, Linear(Per(2.0, Duration), Per(0.505, Period));
        /// φ (rad) at t = 0
        phase_rad = "phase", Radian, Angle, Shape, FitRange::ANY;
    }
    stage: Depth, sign: OneWay, proportional: false, several: true, repeats: InTime, timed: true,
    laws: AnyLaw, needs_derivative: false, family: Alone, simpler: None, is_physical: |_| true,
    example: [5e-5, 3.0, 0.4, 0.0, 0.0], starts: &[],
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
