//! The numbers that the core computes with.
//!
//! [`Scalar`] has the operations of a contact law. It is implemented for `f32`, `f64` and
//! [`Dual`](crate::maths::Dual) numbers, so that the host gets exact gradients from the code that the
//! board runs. [`Real`] adds those of the estimators, for `f32` on the board and `f64` on the host.
//!
//! Every transcendental function comes from `libm` or from this room, never from the platform, so that
//! host and board agree bit for bit.

use super::trig;
use core::fmt::Debug;
use core::ops::{Add, Div, Mul, Neg, Sub};
use num_traits::{One, Zero};

/// A number that a contact law can be evaluated with.
pub trait Scalar:
    Copy
    + Debug
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Zero
    + One
    + 'static
{
    /// The constant nearest to `value`.
    fn from_f64(value: f64) -> Self;
    /// The number nearest to a count. Not by way of `f64`, which a board has in software: 100 instructions.
    fn from_u32(count: u32) -> Self;
    /// The value without its derivatives, in double precision.
    fn to_f64(self) -> f64;
    /// The exponential eˣ.
    fn exp(self) -> Self;
    /// The natural logarithm.
    fn ln(self) -> Self;
    /// The power `self`^`exponent` for `self` > 0; 0 with derivatives of 0 for `self` ≤ 0, since a probe
    /// outside of the material feels no force.
    fn pow_positive(self, exponent: Self) -> Self;
    /// The sine and the cosine of an angle (rad), together since each is the derivative of the other.
    fn sin_cos(self) -> (Self, Self);

    /// The relative exponential (eˣ − 1)/x, which is 1 at x = 0. It avoids the cancellation that costs f32
    /// its last four digits at x = 10⁻³, which is a rate of 1/s at 1 kHz.
    fn exprel(self) -> Self {
        /// The first omitted term is x⁹/10!, 3·10⁻¹⁶ where the series is used last.
        const TERMS: u32 = 9;
        if is_far(self) {
            return (self.exp() - Self::one()) / self;
        }
        let mut sum = Self::one();
        for k in (2..=TERMS).rev() {
            sum = Self::one() + sum * self / Self::from_u32(k);
        }
        sum
    }

    /// The larger of two numbers, or `self` if they are equal or not comparable.
    fn max_of(self, other: Self) -> Self {
        if other > self { other } else { self }
    }

    /// The smaller of two numbers, or `self` if they are equal or not comparable.
    fn min_of(self, other: Self) -> Self {
        if other < self { other } else { self }
    }

    /// The absolute value.
    fn abs(self) -> Self {
        if self < Self::zero() { -self } else { self }
    }

    /// The hyperbolic tangent, which is ±1 beyond ±20, where it rounds to that in f64 as well.
    fn tanh(self) -> Self {
        let (one, far) = (Self::one(), Self::from_f64(20.0));
        if self > far {
            return one;
        }
        if self < -far {
            return -one;
        }
        let square = (self + self).exp();
        (square - one) / (square + one)
    }
}

/// Whether `x` is so far from 0 that (eˣ − 1)/x is computed directly, and not as a series.
pub(super) fn is_far<S: Scalar>(x: S) -> bool {
    const SERIES_BELOW: f64 = 0.1;
    let limit = S::from_f64(SERIES_BELOW);
    !(-limit..limit).contains(&x)
}

/// A time in seconds, of one in microseconds: to the last digit up to 4294 s, and to two digits of the last place
/// beyond. A `u64` as `f64` would cost the board 200 instructions.
pub fn seconds<S: Scalar>(time_us: u64) -> S {
    /// What the upper half of the word counts in (s): 2³² µs.
    const UPPER_S: f64 = 4_294.967_296;
    let lower = S::from_u32(time_us as u32) / S::from_f64(1e6);
    S::from_u32((time_us >> 32) as u32) * S::from_f64(UPPER_S) + lower
}

/// A real number that an estimator can run on: `f32` or `f64`.
pub trait Real:
    Scalar
    + nalgebra::Scalar
    + nalgebra::ClosedAddAssign
    + nalgebra::ClosedSubAssign
    + nalgebra::ClosedMulAssign
    + nalgebra::ClosedDivAssign
    + Default
{
    /// Whether the number is neither NaN nor infinite.
    fn is_finite(self) -> bool;
    /// The square root.
    fn sqrt(self) -> Self;
    /// The arc tangent (rad).
    fn atan(self) -> Self;
    /// The nearest whole number of one that is not negative, up to 2³² − 1.
    fn nearest(self) -> Self;
}

macro_rules! real {
    ($type:ty, $exp:ident, $log:ident, $sin_cos:path, $sqrt:ident, $atan:ident) => {
        impl Scalar for $type {
            #[inline]
            fn from_f64(value: f64) -> Self {
                value as $type
            }
            #[inline]
            fn from_u32(count: u32) -> Self {
                count as $type
            }
            #[inline]
            fn to_f64(self) -> f64 {
                self as f64
            }
            #[inline]
            fn exp(self) -> Self {
                libm::$exp(self)
            }
            #[inline]
            fn ln(self) -> Self {
                libm::$log(self)
            }
            #[inline]
            fn pow_positive(self, exponent: Self) -> Self {
                if self > 0.0 {
                    libm::$exp(exponent * libm::$log(self))
                } else {
                    0.0
                }
            }
            #[inline]
            fn sin_cos(self) -> (Self, Self) {
                $sin_cos(self)
            }
            #[inline]
            fn abs(self) -> Self {
                <$type>::abs(self)
            }
        }

        impl Real for $type {
            #[inline]
            fn is_finite(self) -> bool {
                self.is_finite()
            }
            // The board's VSQRT gives the same bits in 14 cycles in place of 170 instructions. On stable Rust it is
            // reached by `std` or by assembly alone; this crate has neither `std` nor unsafe code.
            #[inline]
            fn sqrt(self) -> Self {
                libm::$sqrt(self)
            }
            #[inline]
            fn atan(self) -> Self {
                libm::$atan(self)
            }
            #[inline]
            fn nearest(self) -> Self {
                (self + 0.5) as u32 as $type
            }
        }
    };
}

// The power dⁿ is computed as exp(n ln d), with 114 instructions on the board where libm's powf takes
// 241. Its relative error is at most |n ln d| ulp, 1e-6 in f32 over the depths of a palpation.
real!(f32, expf, logf, trig::sin_cos, sqrtf, atanf);
real!(f64, exp, log, libm::sincos, sqrt, atan);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_of_a_depth_outside_the_material_is_zero() {
        assert_eq!((-0.5_f32).pow_positive(1.5), 0.0);
        assert_eq!(0.0_f64.pow_positive(0.3), 0.0);
    }

    #[test]
    fn a_power_agrees_with_the_exact_one_to_single_precision() {
        for depth in [1e-4_f32, 0.03, 0.7, 1.0, 4.5, 30.0] {
            for exponent in [1.0_f32, 1.2, 1.5, 2.0] {
                let exact = libm::pow(f64::from(depth), f64::from(exponent));
                let error = (f64::from(depth.pow_positive(exponent)) - exact).abs() / exact;
                // |n ln d| ≤ 18.4 over this grid, times 2^-24.
                assert!(error < 1.2e-6, "{depth}^{exponent}: {error:e}");
            }
        }
    }
}
