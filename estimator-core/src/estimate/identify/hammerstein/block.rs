//! What the second stage of the cascade looks at: means over a period, and their differences.

use nalgebra::Vector3;

use crate::maths::scalar::Real;

/// Means over one period.
#[derive(Clone, Copy, Debug)]
pub(super) struct Block<T: Real> {
    /// z = F − F̂⁽ᵉ⁾
    pub(super) relaxed: T,
    /// F̂⁽ᵉ⁾
    pub(super) elastic: T,
    /// ∂F̂⁽ᵉ⁾ by ln γ₁, γ₂ and the surface.
    pub(super) gradient: Vector3<T>,
}

impl<T: Real> Block<T> {
    /// The sum of nothing.
    pub(super) fn empty() -> Self {
        Block {
            relaxed: T::zero(),
            elastic: T::zero(),
            gradient: Vector3::repeat(T::zero()),
        }
    }

    /// `self + other · weight`
    pub(super) fn plus(&self, other: &Self, weight: T) -> Self {
        Block {
            relaxed: self.relaxed + other.relaxed * weight,
            elastic: self.elastic + other.elastic * weight,
            gradient: self.gradient + other.gradient * weight,
        }
    }

    /// Half way between two.
    pub(super) fn middle(&self, other: &Self) -> Self {
        Block::empty().plus(&self.plus(other, T::one()), T::from_f64(0.5))
    }

    /// `(self − older)·per_s`
    pub(super) fn rate(&self, older: &Self, per_s: T) -> Self {
        let difference = self.plus(older, -T::one());
        Block::empty().plus(&difference, per_s)
    }
}
