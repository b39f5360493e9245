//! What the law says of a pool of instants.

use nalgebra::Vector5;

use super::super::pool::Pooled;
use crate::maths::scalar::Real;

/// Largest variance of the position in the filter's window, over the square of the depth.
const WIDEST: f64 = 0.15;

/// The force of a pool and its gradient.
pub(super) struct Predicted<T: Real> {
    pub(super) force: T,
    pub(super) gradient: Vector5<T>,
}

/// The force and its gradient by θ = (K, λ, n, x₀, τ) at a pool of instants.
///
/// The filter averages a curved law over its window, which is ½F″·var(x) + (∂²F/∂x∂v)·cov(x, v) more
/// than the law of the averages: 27 mN where a ramp of 17 mm/s meets a hold 3 mm deep in gel.
pub(super) fn predict<T: Real>(theta: &[T; 5], at: &Pooled<T>) -> Predicted<T> {
    let [stiffness, damping, exponent, surface, skew] = *theta;
    let depth = at.position - surface;
    if depth <= T::zero() {
        return Predicted {
            force: T::zero(),
            gradient: Vector5::repeat(T::zero()),
        };
    }
    let log = depth.ln();
    let shape = (exponent * log).exp();
    // Where the window spans more than a fifth of the depth, two orders do not describe it; the
    // gradient would be huge, and one such sample would settle a parameter for good.
    if at.position_variance > T::from_f64(WIDEST) * depth * depth {
        let force = (stiffness + damping * at.speed) * shape;
        return Predicted {
            force,
            gradient: Vector5::repeat(T::zero()),
        };
    }
    let curve = T::from_f64(0.5) * exponent * (exponent - T::one()) * at.position_variance
        / (depth * depth);
    let by_stiffness = shape * (T::one() + curve);
    let by_damping = by_stiffness * at.speed + shape * exponent * at.position_velocity_cov / depth;
    let force = stiffness * by_stiffness + damping * by_damping;
    let by_surface = -(exponent * force / depth);
    Predicted {
        force: force - skew * at.rate,
        gradient: Vector5::new(by_stiffness, by_damping, force * log, by_surface, -at.rate),
    }
}
