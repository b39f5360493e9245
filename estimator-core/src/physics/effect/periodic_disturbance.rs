//! A force that repeats in time: hum, a fan, a pump.

use super::{row::effect, shapes::wave};
use crate::maths::scalar::Scalar;

effect! {
    /// The force A sin(2πft + φ).
    PeriodicDisturbance = "periodic_disturbance" {
        /// A (N)
        amplitude_n = "amplitude", Newton, NotNegative, Size, FitRange::up_to(Times(1.0, Force));
        // A little beyond half of the rate: of a log at 200 Hz of which every second sample is searched, mains stood at
        // the bound, without a standard error.
        /// f (Hz)
        frequency_hz = "frequency", Hertz, Positive, Shape, Linear(Per(2.5, Duration), Per(0.505, Period));
        /// φ (rad) at t = 0
        phase_rad = "phase", Radian, Angle, Shape, FitRange::ANY;
    }
    stage: LoadPath, sign: Either, proportional: false, several: true, repeats: InTime, timed: true,
    laws: AnyLaw, needs_derivative: false, family: Alone, simpler: None, is_physical: |_| true,
    example: [0.15, 12.0, 0.3, 0.0, 0.0], starts: &[],
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
