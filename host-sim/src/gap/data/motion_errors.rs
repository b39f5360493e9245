//! How much larger the errors of speed and acceleration are than white noise would make them.

/// The error of the speed in standard deviations that white noise would give it: the steps of an encoder in
/// slow motion are not white (1.7 was measured at reversals under dry friction).
pub(crate) const SPEED_ERROR_FACTOR: f64 = 2.0;
/// The same factor for the acceleration, besides what its windows leave out where it turns: of a joint with an encoder of
/// 14 bits the true model leaves 1.03 times what is allowed. Three times its noise, as of a servo's corners, was twice what
/// there was, and hid an offset of a tenth of the torque, a drag that grows as the square and a Stribeck friction.
pub(crate) const ACCELERATION_ERROR_FACTOR: f64 = 1.5;
