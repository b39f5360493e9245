//! The parameters of all laws together, and which of them a law has.
//!
//! θ = (K, λ, n, x₀, B₁, ln ν₁, B₂, ln ν₂), scaled.

use nalgebra::SVector;

use crate::estimate::identify::bounds::{EXPONENT as EXPONENT_BOUNDS, within};
use crate::maths::scalar::Real;
use crate::physics::law::LawKind;

/// Parameters of all laws together.
pub(super) const SLOTS: usize = 8;
pub(super) const STIFFNESS: usize = 0;
pub(super) const DAMPING: usize = 1;
pub(super) const EXPONENT: usize = 2;
pub(super) const SURFACE: usize = 3;
/// B and ln ν of the two modes.
pub(super) const MODES: [(usize, usize); 2] = [(4, 5), (6, 7)];

/// The parameter vector θ.
pub(super) type Theta<T> = SVector<T, SLOTS>;

/// Bounds of ln ν: no step makes an exponential that single precision cannot hold.
const LOG_RATES: (f64, f64) = (-9.0, 4.5);
/// Bounds of B/K.
const FRACTIONS: (f64, f64) = (0.003, 0.99);

/// The number of relaxation modes of a law.
pub(super) fn modes(law: LawKind) -> usize {
    match law {
        LawKind::KelvinVoigt | LawKind::HuntCrossley | LawKind::HuntCrossleySkew => 0,
        LawKind::Zener | LawKind::QuasiLinear => 1,
        LawKind::QuasiLinear2 => 2,
    }
}

/// Whether a law has λ, and whether it has n; every law has K and x₀.
pub(super) fn has(law: LawKind) -> (bool, bool) {
    match law {
        LawKind::KelvinVoigt => (true, false),
        // The skew is no parameter here: no method over a history has it.
        LawKind::HuntCrossley | LawKind::HuntCrossleySkew => (true, true),
        LawKind::Zener => (false, false),
        LawKind::QuasiLinear | LawKind::QuasiLinear2 => (false, true),
    }
}

/// θ within its bounds, with 0 or 1 for what the law does not have.
pub(super) fn bounded<T: Real>(law: LawKind, mut theta: Theta<T>) -> Theta<T> {
    let (damps, curves) = has(law);
    if !damps {
        theta[DAMPING] = T::zero();
    }
    theta[EXPONENT] = if curves {
        within(theta[EXPONENT], EXPONENT_BOUNDS)
    } else {
        T::one()
    };
    let mut rest = FRACTIONS.1;
    for (index, (relaxing, log_rate)) in MODES.into_iter().enumerate() {
        let stiffness = theta[STIFFNESS];
        let share = within(theta[relaxing] / stiffness, (FRACTIONS.0, rest));
        let relaxes = index < modes(law) && share.is_finite();
        theta[relaxing] = if relaxes {
            share * stiffness
        } else {
            T::zero()
        };
        if relaxes {
            rest = FRACTIONS.0.max(rest - share.to_f64());
        }
        theta[log_rate] = within(theta[log_rate], LOG_RATES);
    }
    theta
}
