//! The counts of a channel: how large they are, and what rounding to them costs.

use crate::maths::scalar::Real;

/// Standard deviation of the error of a count: 1/√12.
pub(in crate::estimate) const COUNT_ERROR: f64 = 0.288_675_134_594_812_9;
/// What rounding to counts of q leaves of the mean of a noise σ: q/(π√2)·exp(−2π²σ²/q²), the first harmonic
/// of the sawtooth of rounding (Widrow 1956): without noise 0.23 q on the mean.
const ROUNDING: (f64, f64) = (0.225_079_079, -19.739_208_8);
/// The smallest step that a position has made is a count if it is at least this share of one: half a count and less are
/// means of several readings.
const NEARLY_A_COUNT: f64 = 0.75;
/// Counts below this many standard deviations of the noise are even in the mean to a thousandth.
const COARSE: f64 = 1.8;

/// The smallest step that a channel has made.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Step<T> {
    last: Option<T>,
    smallest: T,
}

impl<T: Real> Step<T> {
    /// Takes the next value of the channel.
    pub(super) fn observe(&mut self, value: T) {
        let moved = (value - self.last.replace(value).unwrap_or(value)).abs();
        if moved > T::zero() && (self.smallest == T::zero() || moved < self.smallest) {
            self.smallest = moved;
        }
    }

    /// The smallest step so far, or the count where that is a part of one. A step that is a count but for its rounding stays
    /// as it is: a host that knows no settings has the same bits.
    pub(super) fn at_least(&self, count: Option<T>) -> T {
        let is_part = |count: T| {
            self.smallest > T::zero() && self.smallest < T::from_f64(NEARLY_A_COUNT) * count
        };
        match count {
            Some(count) if is_part(count) => count,
            _ => self.smallest,
        }
    }

    /// The smallest step so far; 0 before the first change.
    pub(super) fn smallest(&self) -> T {
        self.smallest
    }
}

/// Standard error (N) that rounding to steps gives the mean of a force with a noise; `None` of fine steps.
pub(super) fn rounding_n<T: Real>(noise_n: T, step_n: T) -> Option<T> {
    if step_n < T::from_f64(COARSE) * noise_n {
        return None;
    }
    let (share, falls) = (T::from_f64(ROUNDING.0), T::from_f64(ROUNDING.1));
    let counts = noise_n / step_n;
    Some(share * step_n * (falls * counts * counts).exp())
}
