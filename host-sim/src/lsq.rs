//! Least squares that several rooms need: dense symmetric systems, a Levenberg–Marquardt within bounds, the
//! inverse of a curvature, and the covariance of a sum of correlated terms.
//!
//! A minimum is sought on normal equations: a crate for it has no bounds, and wants the whole Jacobian at
//! once, 10 MB a step for 100 000 rows of 12 columns. Each caller accumulates them in its own way from the
//! exact gradients of dual numbers.

pub(crate) mod basis;
pub(crate) mod covariance;
pub(crate) mod dense;
pub(crate) mod minimize;

/// The normal equations of a weighted least-squares problem at some values of its numbers.
pub(crate) struct NormalEquations {
    /// Σ w r².
    pub(crate) cost: f64,
    /// JᵀWr: half of the cost's gradient, with the sign turned.
    pub(crate) downhill: Vec<f64>,
    /// JᵀWJ row by row: half of the cost's second derivative, as Gauss and Newton have it.
    pub(crate) curvature: Vec<f64>,
}
