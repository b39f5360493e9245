//! What a position may be off by, with and without the counts of an encoder.

use crate::stats::rounding_step;

/// How far a position may be off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Errors {
    /// For as long as a hold takes (m): half a count of an encoder with counts, else the standard deviation of its noise.
    pub(crate) held_m: f64,
    /// Standard deviation of what its counts round off (m); `None` of a position without them.
    pub(crate) rounding_m: Option<f64>,
}

/// Of a noise (m), which is that of counts or not.
pub(super) fn errors(noise_m: f64, is_counted: bool) -> Errors {
    Errors {
        held_m: match is_counted {
            true => 0.5 * rounding_step(noise_m),
            false => noise_m,
        },
        rounding_m: is_counted.then_some(noise_m),
    }
}
