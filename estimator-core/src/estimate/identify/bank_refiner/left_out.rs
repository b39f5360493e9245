//! What the estimates leave out and the data speak for: a skew of the sensors, a spring in series with the probe.

use super::super::Refiner;
use super::super::slots::{damper, spring};
use crate::estimate::status::{Doubt, Reason};
use crate::maths::scalar::Real;

/// What is not estimated is doubted from this many standard errors on, if it moves a parameter by more than this
/// share of its size.
const SURE_SIGMAS: f64 = 5.0;
const MATTERS: f64 = 0.02;
/// A compliance, which is positive, is not ruled out from this many standard errors on, where one of them moves no
/// parameter by more than this share of its size: on a contact that is nearly linear none is ever ruled out, a softer
/// material being the same.
const LIKELY_SIGMAS: f64 = 2.0;
const CAN_BE_RULED_OUT: f64 = 0.1;
/// Share of its size by which the standard error of the skew, as the data alone give it, may move a
/// parameter of a converged estimate.
const SKEW_OPEN: f64 = 0.05;

/// Whether the data speak for a skew or a compliance that the estimates leave out, or have not ruled out one that would
/// move them. The `inflation` is that of the standard errors by the residuals.
pub(super) fn doubt<T: Real>(refiner: &Refiner<T>, inflation: T) -> Option<Doubt> {
    skew_doubt(refiner, inflation).or_else(|| compliance_doubt(refiner, inflation))
}

fn skew_doubt<T: Real>(refiner: &Refiner<T>, inflation: T) -> Option<Doubt> {
    if refiner.is_estimating_skew() {
        return None;
    }
    let (skew, error) = refiner.skew();
    let error = error * inflation;
    if is_sure(skew, error) && matters(refiner, &refiner.moved_by_skew(skew), MATTERS) {
        Some(Doubt::Against(Reason::Skew))
    } else {
        // A skew that chance does not explain is not ruled out by being small beside its error.
        let open = refiner.moved_by_skew(error.max_of(skew.abs() - error));
        matters(refiner, &open, SKEW_OPEN).then_some(Doubt::NotYetRuledOut(Reason::Skew))
    }
}

fn compliance_doubt<T: Real>(refiner: &Refiner<T>, inflation: T) -> Option<Doubt> {
    let (compliance, error) = refiner.compliance()?;
    let error = error * inflation;
    let moves = |by: T, share: f64| matters(refiner, &refiner.moved_by_compliance(by), share);
    if is_sure(compliance, error) {
        moves(compliance, MATTERS).then_some(Doubt::Against(Reason::Residual))
    } else {
        let open = compliance > T::from_f64(LIKELY_SIGMAS) * error
            && moves(compliance, MATTERS)
            && !moves(error, CAN_BE_RULED_OUT);
        open.then_some(Doubt::NotYetRuledOut(Reason::Residual))
    }
}

fn is_sure<T: Real>(value: T, error: T) -> bool {
    value.abs() > T::from_f64(SURE_SIGMAS) * error
}

/// Whether a parameter is moved by more than this share of its size.
fn matters<T: Real>(refiner: &Refiner<T>, moved: &[T; 5], share: f64) -> bool {
    let [stiffness, damping, exponent, ..] = refiner.values();
    let sizes = [spring(stiffness).1, damper(damping, stiffness).1, exponent];
    let most = T::from_f64(share);
    moved
        .iter()
        .zip(sizes)
        .any(|(moved, size)| moved.abs() > most * size)
}
