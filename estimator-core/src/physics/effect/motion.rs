//! The motion that an effect answers to.

/// What the motor side does at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<S> {
    /// Time since the start of the log (s).
    pub time_s: S,
    /// x (m)
    pub position_m: S,
    /// v (m/s)
    pub speed_mps: S,
    /// a (m/s²)
    pub acceleration_mps2: S,
}
