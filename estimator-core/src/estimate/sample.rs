//! The input of the estimator: force and position of one instant, and their faults.

use crate::estimate::fault::Faults;
use crate::maths::scalar::Real;

/// Force and position that were read at the same tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample<T = f32> {
    /// Time since the start (µs), in 64 bits: a u32 wraps after 71 minutes, and after a day seconds in
    /// f32 resolve only 10 ms.
    pub time_us: u64,
    /// Position of the probe (m), growing into the material.
    pub position_m: T,
    /// Force on the probe (N), positive when it pushes the probe out.
    pub force_n: T,
    /// Faults that the reader of the sensors has found; [`Faults::NONE`] if there are none.
    pub faults: Faults,
}

impl<T: Real> Sample<T> {
    /// Converts the sample to another precision.
    pub fn cast<U: Real>(self) -> Sample<U> {
        Sample {
            time_us: self.time_us,
            position_m: U::from_f64(self.position_m.to_f64()),
            force_n: U::from_f64(self.force_n.to_f64()),
            faults: self.faults,
        }
    }
}
