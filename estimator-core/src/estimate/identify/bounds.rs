//! Bounds within which estimates are used.

use crate::maths::scalar::Real;

/// Bounds of n: neither a start nor a step makes a power that single precision cannot hold.
pub(super) const EXPONENT: (f64, f64) = (0.3, 4.0);

/// The value, or the bound that it exceeds.
pub(super) fn within<T: Real>(value: T, (low, high): (f64, f64)) -> T {
    T::from_f64(low).max_of(value).min_of(T::from_f64(high))
}
