//! The functions that several effects are made of: a wave, a rounded corner, the direction of a speed,
//! and a force that follows the way.

use super::row::MOST_PARAMETERS;
use crate::maths::scalar::Scalar;

/// The sine A sin(ωu + φ) and its derivative Aω cos(ωu + φ).
pub(super) fn wave<S: Scalar>(amplitude: S, angular: S, phase: S, at: S) -> (S, S) {
    let (sin, cos) = (angular * at + phase).sin_cos();
    (amplitude * sin, amplitude * angular * cos)
}

/// max(x, 0) with its corner rounded over a width w: w ln(1 + e^{x/w}).
pub(super) fn ramp<S: Scalar>(x: S, width: S) -> S {
    if width <= S::zero() {
        return x.max_of(S::zero());
    }
    let far = x / width;
    // Beyond this the rounding is 10⁻¹³ of its width.
    if far > S::from_f64(30.0) {
        return x;
    }
    width * (S::one() + far.exp()).ln()
}

/// Whether a share of the elastic force, the first number of a row, leaves some of it. At the bound of 0.95 a material
/// pushes back 39 times as hard on the way in as on the way out: such curves stood for a cell layer that relaxes.
pub(super) fn leaves_some(row: &[f64; MOST_PARAMETERS]) -> bool {
    row[0] < 0.9
}

/// 2π/`period`
pub(super) fn angular_of<S: Scalar>(period: S) -> S {
    S::from_f64(core::f64::consts::TAU) / period
}

/// The direction of a speed: its sign where `transition_mps` is 0, else tanh(v/v_t).
pub(super) fn direction<S: Scalar>(speed_mps: S, transition_mps: S) -> S {
    if transition_mps > S::zero() {
        return (speed_mps / transition_mps).tanh();
    }
    if speed_mps > S::zero() {
        S::one()
    } else if speed_mps < S::zero() {
        -S::one()
    } else {
        S::zero()
    }
}

/// The state z of Dahl's friction after a way of `change_m`: dz/ds = (1 − z·sgn ṡ)/w, exactly, however long the way.
pub(super) fn slid<S: Scalar>(z: S, change_m: S, width_m: S) -> S {
    slid_to(S::one(), z, change_m, width_m)
}

/// The state z of a friction that slides with the share `most` of what it sticks with, after a way of `change_m`:
/// dz/ds = (1 − z·sgn ṡ/most)/w, exactly while the share stays (LuGre's bristles without their own damping).
pub(super) fn slid_to<S: Scalar>(most: S, z: S, change_m: S, width_m: S) -> S {
    let zero = S::zero();
    if change_m == zero {
        return z;
    }
    let towards = if change_m > zero { most } else { -most };
    towards + (z - towards) * (-(change_m.abs() / (width_m * most))).exp()
}
