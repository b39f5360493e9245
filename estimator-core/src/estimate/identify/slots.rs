//! Estimates in the slots of a law: what an error is compared with, and the way to SI units.

use super::params::IdentifyParams;
use crate::estimate::contact::SurfacePosition;
use crate::estimate::monitor::ParameterEstimate;
use crate::estimate::record::{Estimated, PARAMETER_SLOTS, Parameters};
use crate::maths::scalar::Real;
use crate::physics::law::LawKind;

/// What an error of a stiffness or damping is compared with: its value, but at least a tenth of the
/// stiffness, since at the reference speed a damping smaller than that is a force that hardly
/// counts.
pub(super) fn size<T: Real>(value: T, stiffness: T) -> T {
    value.abs().max_of(T::from_f64(0.1) * stiffness.abs())
}

/// A stiffness and what its error is compared with.
pub(super) fn spring<T: Real>(stiffness: T) -> (T, T) {
    (stiffness, size(stiffness, stiffness))
}

/// A damping and what its error is compared with.
pub(super) fn damper<T: Real>(damping: T, stiffness: T) -> (T, T) {
    (damping, size(damping, stiffness))
}

/// Values with what their errors are compared with, and standard errors, in the order of the law's
/// slots.
pub(super) fn in_slots<'a, T: Real>(
    values: &[(T, T)],
    errors: impl Iterator<Item = &'a T>,
) -> [ParameterEstimate<T>; PARAMETER_SLOTS] {
    let mut estimates = [ParameterEstimate::default(); PARAMETER_SLOTS];
    for ((slot, (value, scale)), std_error) in estimates.iter_mut().zip(values).zip(errors) {
        *slot = ParameterEstimate {
            value: *value,
            std_error: *std_error,
            scale: *scale,
        };
    }
    estimates
}

/// The parameters in SI units, the surface behind those of the law; what is not observable is `None`.
pub fn report<T: Real>(
    params: &IdentifyParams<T>,
    law: LawKind,
    estimates: &[ParameterEstimate<T>],
    surface: SurfacePosition<T>,
) -> Parameters<T> {
    let scale = &params.scale;
    let units = law.parameters().iter().map(|info| scale.of(info.unit));
    let mut parameters = [None; PARAMETER_SLOTS];
    for ((slot, estimate), unit) in parameters.iter_mut().zip(estimates).zip(units) {
        *slot = estimate.observable().then(|| Estimated {
            value: estimate.value * unit,
            std_error: estimate.std_error * unit,
        });
    }
    if let Some(slot) = parameters.get_mut(estimates.len()) {
        *slot = Some(Estimated {
            value: surface.position_m,
            std_error: surface.std_error_m,
        });
    }
    parameters
}
