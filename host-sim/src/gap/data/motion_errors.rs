//! How much larger the errors of speed and acceleration are than white noise would make them.

/// The error of the speed in standard deviations that white noise would give it: the steps of an encoder in
/// slow motion are not white (1.7 was measured at reversals under dry friction).
pub(crate) const SPEED_ERROR_FACTOR: f64 = 2.0;
/// The same factor for the acceleration: a corner of the set point leaves errors in the windows around it
/// (2.0 to 3.1 were measured on a simulated servo); elsewhere the true model of a joint with an encoder of 14 bits leaves 1.03
/// times what 1.5 allows. With 3 everywhere an offset of a tenth of the torque, a drag that grows as the square and a Stribeck
/// friction hid in it.
pub(crate) const fn acceleration_error_factor(is_corner: bool) -> f64 {
    match is_corner {
        true => 3.0,
        false => 1.5,
    }
}
