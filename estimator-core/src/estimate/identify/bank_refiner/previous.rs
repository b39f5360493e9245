//! The estimates from before a change of material, which come back if it was none: a fault that has passed,
//! or a surface that is elsewhere since an encoder has jumped.

use super::super::{ForceNoise, Pooled, Refiner};
use super::claims::Claims;
use crate::maths::scalar::Real;

/// After a change, the estimates before it come back if they predict this many pools in a row of at least
/// this force over the noise, within so many pools: 0.1 s of contact, within two.
const AGREE_POOLS: u32 = 12;
const AGREE_SIGMAS: f64 = 20.0;
pub(super) const RECONSIDERED: u32 = 256;
/// Range of the force, from the least to the largest of those pools, that tells a surface that has moved
/// from another material.
const AGREE_RANGE: f64 = 2.0;

/// The estimates before the last change of material.
#[derive(Clone, Debug)]
pub(super) struct Previous<T: Real> {
    pub(super) refiner: Refiner<T>,
    pub(super) claims: Claims<T>,
    /// Where they stand with the surface that they know, and with one that has moved.
    there: Agreement<T>,
    moved: Agreement<T>,
}

/// How long the estimates have predicted the force with the surface in one place.
#[derive(Clone, Copy, Debug, Default)]
struct Agreement<T> {
    /// How far the surface lies behind the one that they know.
    shift: T,
    /// Number of pools in a row that they predict, and the least and the largest force of those.
    pools: u32,
    span: (T, T),
}

impl<T: Real> Agreement<T> {
    /// Takes a pool with its prediction: the error, its largest square, and the slope dF/dx.
    fn take(&mut self, force: T, error: T, most: T, slope: T, moves: bool) {
        if error * error >= most {
            // Where the surface would have to be by this pool alone.
            self.shift = if moves && slope > T::zero() {
                self.shift - error / slope
            } else {
                T::zero()
            };
            (self.pools, self.span) = (0, (force, force));
            return;
        }
        self.pools += 1;
        let (low, high) = self.span;
        self.span = (low.min_of(force), high.max_of(force));
        if moves && slope > T::zero() {
            let share = T::one() / T::from_u32(self.pools + 1);
            self.shift -= share * error / slope;
        }
    }

    fn holds(&self, range: f64) -> bool {
        let (low, high) = self.span;
        self.pools >= AGREE_POOLS && high > T::from_f64(range) * low
    }
}

impl<T: Real> Previous<T> {
    pub(super) fn new(refiner: Refiner<T>, claims: Claims<T>) -> Self {
        Previous {
            refiner,
            claims,
            there: Agreement::default(),
            moved: Agreement::default(),
        }
    }

    /// How far the surface has moved if they have predicted enough pools in a row; pools of a small force say
    /// nothing.
    pub(super) fn agrees_with(&mut self, pooled: &Pooled<T>, noise: &ForceNoise<T>) -> Option<T> {
        if pooled.force < T::from_f64(AGREE_SIGMAS) * noise.raw {
            return None;
        }
        for (agreement, moves) in [(&mut self.there, false), (&mut self.moved, true)] {
            let at = Pooled {
                position: pooled.position - agreement.shift,
                ..*pooled
            };
            let (force, variance) = self.refiner.predict(&at);
            let most = T::from_f64(9.0) * (variance + noise.filtered * noise.filtered);
            let slope = self.refiner.slope(&at);
            agreement.take(pooled.force, pooled.force - force, most, slope, moves);
        }
        if self.there.holds(0.0) {
            return Some(T::zero());
        }
        self.moved.holds(AGREE_RANGE).then_some(self.moved.shift)
    }
}
