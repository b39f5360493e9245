//! A skew of the sensors that the estimates leave out.

use super::super::Refiner;
use super::super::slots::{damper, spring};
use crate::estimate::status::{Doubt, Reason};
use crate::maths::scalar::Real;

/// A skew that is not estimated is doubted from this many standard errors on, if it moves a parameter by
/// more than this share of its size.
const SKEWED_SIGMAS: f64 = 5.0;
const SKEW_MATTERS: f64 = 0.02;
/// Share of its size by which the standard error of the skew, as the data alone give it, may move a
/// parameter of a converged estimate.
const SKEW_OPEN: f64 = 0.05;

/// Whether the data speak for a skew that the estimates leave out, or have not ruled out one that would move
/// them. The `inflation` is that of the standard errors by the residuals.
pub(super) fn skew_doubt<T: Real>(refiner: &Refiner<T>, inflation: T) -> Option<Doubt> {
    if refiner.is_estimating_skew() {
        return None;
    }
    let (skew, error) = refiner.skew();
    let [stiffness, damping, exponent, ..] = refiner.values();
    let sizes = [spring(stiffness).1, damper(damping, stiffness).1, exponent];
    let moves = |by: T, share: f64| {
        let moved = refiner.moved_by_skew(by);
        let most = T::from_f64(share);
        moved
            .iter()
            .zip(sizes)
            .any(|(moved, size)| moved.abs() > most * size)
    };
    if skew.abs() > T::from_f64(SKEWED_SIGMAS) * error * inflation && moves(skew, SKEW_MATTERS) {
        Some(Doubt::Against(Reason::Skew))
    } else {
        // A skew that chance does not explain is not ruled out by being small beside its error.
        let error = error * inflation;
        let open = moves(error.max_of(skew.abs() - error), SKEW_OPEN);
        open.then_some(Doubt::NotYetRuledOut(Reason::Skew))
    }
}
