//! How much larger the errors of a motion are than those of white noise.

/// Errors of the speed in units of what white noise would leave: the steps of an encoder in slow
/// motion are not white (measured at reversals under dry friction: 1.7).
pub(in crate::gap) const SPEED_ERRORS: f64 = 2.0;
/// The same of the acceleration: what a corner of the set point leaves in the windows about it
/// (measured on a simulated servo: 2.0 to 3.1).
pub(in crate::gap) const ACCELERATION_ERRORS: f64 = 3.0;
