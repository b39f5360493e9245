//! What Dahl's friction and Bouc & Wen's loop share: a force that follows the way, not the time.

use crate::scalar::Scalar;

/// z after a way of `change_m`: dz/ds = (1 − z·sgn ṡ)/w, exactly, however long the way.
pub(super) fn slid<S: Scalar>(z: S, change_m: S, width_m: S) -> S {
    let nil = S::nil();
    if change_m == nil {
        return z;
    }
    let towards = if change_m > nil {
        S::unit()
    } else {
        -S::unit()
    };
    towards + (z - towards) * (-(change_m.absolute() / width_m)).exp()
}
