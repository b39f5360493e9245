//! Forward-mode dual numbers carry a value and its derivatives by N parameters, exact to rounding.

use core::cmp::Ordering;
use core::ops::{Add, Div, Mul, Neg, Sub};

use super::scalar::{Scalar, is_far};
use num_traits::{One, Zero};

/// A value with its gradient by `N` parameters.
#[derive(Clone, Copy, Debug)]
pub struct Dual<T, const N: usize> {
    /// The value.
    pub value: T,
    /// The derivatives ∂value/∂parameter, in the caller's order of parameters.
    pub gradient: [T; N],
}

impl<T: Scalar, const N: usize> Dual<T, N> {
    /// Makes a number that depends on no parameter.
    pub fn constant(value: T) -> Self {
        Dual {
            value,
            gradient: [T::zero(); N],
        }
    }

    /// Makes the parameter with this index; an index of `N` or more gives a constant.
    pub fn parameter(value: T, index: usize) -> Self {
        let mut gradient = [T::zero(); N];
        if let Some(slope) = gradient.get_mut(index) {
            *slope = T::one();
        }
        Dual { value, gradient }
    }

    /// Applies the chain rule to a function with this value and slope at `self.value`.
    fn chain(self, value: T, slope: T) -> Self {
        Dual {
            value,
            gradient: self.gradient.map(|g| g * slope),
        }
    }

    /// The gradient `a·∂self + b·∂other`.
    fn combine(self, a: T, other: Self, b: T) -> [T; N] {
        let mut gradient = self.gradient;
        for (g, o) in gradient.iter_mut().zip(other.gradient) {
            *g = *g * a + o * b;
        }
        gradient
    }
}

/// Comparisons use the value only, so that a law takes the same branch for every scalar.
impl<T: Scalar, const N: usize> PartialEq for Dual<T, N> {
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value
    }
}

impl<T: Scalar, const N: usize> PartialOrd for Dual<T, N> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        self.value.partial_cmp(&other.value)
    }
}

impl<T: Scalar, const N: usize> Add for Dual<T, N> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Dual {
            value: self.value + other.value,
            gradient: self.combine(T::one(), other, T::one()),
        }
    }
}

impl<T: Scalar, const N: usize> Sub for Dual<T, N> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Dual {
            value: self.value - other.value,
            gradient: self.combine(T::one(), other, -T::one()),
        }
    }
}

impl<T: Scalar, const N: usize> Mul for Dual<T, N> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Dual {
            value: self.value * other.value,
            gradient: self.combine(other.value, other, self.value),
        }
    }
}

impl<T: Scalar, const N: usize> Div for Dual<T, N> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        let scale = T::one() / other.value;
        Dual {
            value,
            gradient: self.combine(scale, other, -(value * scale)),
        }
    }
}

impl<T: Scalar, const N: usize> Neg for Dual<T, N> {
    type Output = Self;
    fn neg(self) -> Self {
        self.chain(-self.value, -T::one())
    }
}

impl<T: Scalar, const N: usize> Zero for Dual<T, N> {
    fn zero() -> Self {
        Dual::constant(T::zero())
    }

    fn is_zero(&self) -> bool {
        self.value.is_zero()
    }
}

impl<T: Scalar, const N: usize> One for Dual<T, N> {
    fn one() -> Self {
        Dual::constant(T::one())
    }
}

impl<T: Scalar, const N: usize> Scalar for Dual<T, N> {
    fn from_f64(value: f64) -> Self {
        Dual::constant(T::from_f64(value))
    }

    fn from_u32(count: u32) -> Self {
        Dual::constant(T::from_u32(count))
    }

    fn to_f64(self) -> f64 {
        self.value.to_f64()
    }

    fn exp(self) -> Self {
        let value = self.value.exp();
        self.chain(value, value)
    }

    fn ln(self) -> Self {
        self.chain(self.value.ln(), T::one() / self.value)
    }

    fn pow_positive(self, exponent: Self) -> Self {
        if self.value <= T::zero() {
            return Self::zero();
        }
        // ∂d^n/∂d = n d^n / d and ∂d^n/∂n = d^n ln d: both finite for d > 0. The value is that of a real number to the
        // bit, whose power takes the same logarithm.
        let ln = self.value.ln();
        let value = (exponent.value * ln).exp();
        let by_base = exponent.value * value / self.value;
        let by_exponent = value * ln;
        Dual {
            value,
            gradient: self.combine(by_base, exponent, by_exponent),
        }
    }

    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.value.sin_cos();
        (self.chain(sin, cos), self.chain(cos, -sin))
    }

    /// The derivative is (eˣ − exprel x)/x, which saves nine divisions of whole gradients against the
    /// series of the value.
    fn exprel(self) -> Self {
        /// Coefficients k/(k + 1)! for k = 9…1 of the series of the derivative.
        const SERIES: [f64; 9] = [
            9.0 / 3_628_800.0,
            1.0 / 45_360.0,
            1.0 / 5_760.0,
            1.0 / 840.0,
            1.0 / 144.0,
            1.0 / 30.0,
            1.0 / 8.0,
            1.0 / 3.0,
            1.0 / 2.0,
        ];
        let x = self.value;
        let value = x.exprel();
        let slope = if is_far(x) {
            (x.exp() - value) / x
        } else {
            SERIES
                .iter()
                .fold(T::zero(), |sum, term| sum * x + T::from_f64(*term))
        };
        self.chain(value, slope)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type Two = Dual<f64, 2>;

    /// d^n·e^d / (d + n) at (d, n), by hand and by central differences.
    fn function<S: Scalar>(d: S, n: S) -> S {
        d.pow_positive(n) * d.exp() / (d + n) - d.ln() * n
            + (d * n).sin_cos().0 * d.sin_cos().1
            + d.tanh()
            + (d * n).exprel()
            + (d * S::from_f64(0.02)).exprel()
    }

    #[test]
    fn the_gradient_agrees_with_central_differences() {
        let (d, n, h) = (0.7, 1.35, 1e-6);
        let dual = function(Two::parameter(d, 0), Two::parameter(n, 1));
        let by_d = (function(d + h, n) - function(d - h, n)) / (2.0 * h);
        let by_n = (function(d, n + h) - function(d, n - h)) / (2.0 * h);
        assert_eq!(dual.value, function(d, n));
        // Central differences with h = 1e-6 are good to 1e-9 here.
        assert!(
            (dual.gradient[0] - by_d).abs() < 1e-8,
            "{} {by_d}",
            dual.gradient[0]
        );
        assert!(
            (dual.gradient[1] - by_n).abs() < 1e-8,
            "{} {by_n}",
            dual.gradient[1]
        );
    }

    #[test]
    fn outside_the_material_the_gradient_is_zero_and_not_nan() {
        let power = Two::parameter(-0.1, 0).pow_positive(Two::parameter(1.5, 1));
        assert_eq!(power.value, 0.0);
        assert_eq!(power.gradient, [0.0, 0.0]);
    }
}
