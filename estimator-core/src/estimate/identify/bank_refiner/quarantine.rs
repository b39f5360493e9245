//! Pools wait before they are learned from, so that what a fault or a change of material has reached can be
//! dropped.

use super::super::Pooled;
use crate::maths::scalar::Real;

/// Pools that wait before they are learned from: longer than a change of material takes to be noticed.
const QUARANTINE: usize = 4;

/// Pools that wait before they are learned from.
#[derive(Clone, Debug)]
pub(super) struct Quarantine<T> {
    pools: [Pooled<T>; QUARANTINE],
    waiting: usize,
}

impl<T: Real> Default for Quarantine<T> {
    fn default() -> Self {
        Quarantine {
            pools: [Pooled::default(); QUARANTINE],
            waiting: 0,
        }
    }
}

impl<T: Real> Quarantine<T> {
    /// Takes a pool, and gives the one that has waited long enough.
    pub(super) fn push(&mut self, pooled: Pooled<T>) -> Option<Pooled<T>> {
        if let Some(slot) = self.pools.get_mut(self.waiting) {
            *slot = pooled;
            self.waiting += 1;
            return None;
        }
        let oldest = self.pools.first().copied();
        self.pools.rotate_left(1);
        if let Some(last) = self.pools.last_mut() {
            *last = pooled;
        }
        oldest
    }

    /// Drops what is not of the touch that the newest pool is of.
    pub(super) fn keep_last_touch(&mut self) {
        let waiting = self.pools.get(..self.waiting).unwrap_or(&[]);
        let pairs = waiting.windows(2).enumerate();
        let begins = |(at, pair): (usize, &[Pooled<T>])| match pair {
            [before, after] if after.loaded < before.loaded => Some(at + 1),
            _ => None,
        };
        let from = pairs.filter_map(begins).last().unwrap_or(0);
        (0..from).for_each(|_| {
            self.take_oldest();
        });
    }

    /// Takes out the pool that has waited longest.
    pub(super) fn take_oldest(&mut self) -> Option<Pooled<T>> {
        self.waiting = self.waiting.checked_sub(1)?;
        let oldest = self.pools.first().copied();
        self.pools.rotate_left(1);
        oldest
    }
}
