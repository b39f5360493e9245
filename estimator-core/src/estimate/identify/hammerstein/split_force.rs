//! The measured force, split into the elastic response and what has relaxed of it.

use nalgebra::Vector3;

use crate::maths::scalar::Real;

/// The force of one instant, or its mean over a period, in scaled units.
#[derive(Clone, Copy, Debug)]
pub(super) struct SplitForce<T: Real> {
    /// z = F − F̂⁽ᵉ⁾
    pub(super) relaxed: T,
    /// F̂⁽ᵉ⁾
    pub(super) elastic: T,
    /// ∂F̂⁽ᵉ⁾ by ln γ₁, γ₂ and the surface.
    pub(super) gradient: Vector3<T>,
}

impl<T: Real> SplitForce<T> {
    /// No force: the start of a sum, and a material that is not touched.
    pub(super) fn zero() -> Self {
        SplitForce {
            relaxed: T::zero(),
            elastic: T::zero(),
            gradient: Vector3::repeat(T::zero()),
        }
    }

    /// `self + other · weight`
    pub(super) fn plus(&self, other: &Self, weight: T) -> Self {
        SplitForce {
            relaxed: self.relaxed + other.relaxed * weight,
            elastic: self.elastic + other.elastic * weight,
            gradient: self.gradient + other.gradient * weight,
        }
    }

    /// The mean of two.
    pub(super) fn midpoint(&self, other: &Self) -> Self {
        Self::zero().plus(&self.plus(other, T::one()), T::from_f64(0.5))
    }

    /// `(self − older)·per_s`
    pub(super) fn rate(&self, older: &Self, per_s: T) -> Self {
        Self::zero().plus(&self.plus(older, -T::one()), per_s)
    }
}
