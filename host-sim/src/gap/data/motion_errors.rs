//! How much larger the errors of speed and acceleration are than white noise would make them.

/// The error of the speed in standard deviations that white noise would give it: the steps of an encoder in
/// slow motion are not white (1.7 was measured at reversals under dry friction).
pub(crate) const SPEED_ERROR_FACTOR: f64 = 2.0;
/// The same factor for the acceleration: a corner of the set point leaves errors in the windows around it
/// (2.0 to 3.1 were measured on a simulated servo).
pub(crate) const ACCELERATION_ERROR_FACTOR: f64 = 1.5;
