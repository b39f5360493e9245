//! What Dahl's friction and Bouc & Wen's loop share: a force that follows the way, not the time.

use crate::maths::scalar::Scalar;

/// z after a way of `change_m`: dz/ds = (1 − z·sgn ṡ)/w, exactly, however long the way.
pub(super) fn slid<S: Scalar>(z: S, change_m: S, width_m: S) -> S {
    let nil = S::zero();
    if change_m == nil {
        return z;
    }
    let towards = if change_m > nil { S::one() } else { -S::one() };
    towards + (z - towards) * (-(change_m.abs() / width_m)).exp()
}
