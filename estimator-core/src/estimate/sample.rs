//! What goes in: one instant of both channels, and what may be wrong with it.

use crate::estimate::fault::Faults;
use crate::maths::scalar::Real;

/// One instant of force and position, taken at the same tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample<T = f32> {
    /// Time since start (µs). 64 bits: a u32 wraps after 71 minutes, and seconds in f32 resolve
    /// only 10 ms after a day.
    pub time_us: u64,
    /// Position of the probe (m), growing into the material.
    pub position_m: T,
    /// Force on the probe (N), positive when it pushes the probe out.
    pub force_n: T,
    /// What the reader of the sensors already knows to be wrong; [`Faults::NONE`] if nothing.
    pub faults: Faults,
}

impl<T: Real> Sample<T> {
    /// The same instant in another precision.
    pub fn cast<U: Real>(self) -> Sample<U> {
        Sample {
            time_us: self.time_us,
            position_m: U::from_f64(self.position_m.to_f64()),
            force_n: U::from_f64(self.force_n.to_f64()),
            faults: self.faults,
        }
    }
}
