//! The estimates from before a change of material, which come back if it was none: a fault that has passed.

use super::super::{ForceNoise, Pooled, Refiner};
use crate::maths::scalar::Real;

/// After a change, the estimates before it come back if they predict this many pools in a row of at least
/// this force over the noise, within so many pools: 0.1 s of contact, within two.
const AGREE_POOLS: u32 = 12;
const AGREE_SIGMAS: f64 = 20.0;
pub(super) const RECONSIDERED: u32 = 256;

/// The estimates before the last change of material.
#[derive(Clone, Debug)]
pub(super) struct Previous<T: Real> {
    pub(super) refiner: Refiner<T>,
    pub(super) std_errors: [T; 5],
    /// Number of pools in a row that they predict.
    pub(super) agrees: u32,
}

impl<T: Real> Previous<T> {
    /// Whether they have predicted enough pools in a row; pools of a small force say nothing.
    pub(super) fn agrees_with(&mut self, pooled: &Pooled<T>, noise: &ForceNoise<T>) -> bool {
        if pooled.force < T::from_f64(AGREE_SIGMAS) * noise.raw {
            return false;
        }
        let (force, variance) = self.refiner.predict(pooled);
        let left = pooled.force - force;
        let most = T::from_f64(9.0) * (variance + noise.filtered * noise.filtered);
        self.agrees = if left * left < most {
            self.agrees + 1
        } else {
            0
        };
        self.agrees >= AGREE_POOLS
    }
}
