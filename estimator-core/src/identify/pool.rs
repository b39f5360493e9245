//! Neighbouring instants as one: what a refiner can remember of a stroke.
//!
//! Eight instants of a smooth motion teach as much by their mean as one by one, if the law is asked
//! for its mean over the motion between them: spread and coupling say what that is, as they do for
//! the filter's window. A second of contact then fits into 4 kB, and can be learned from again with
//! a better linearisation.

use super::Instant;
use crate::scalar::Real;

/// Instants that are pooled.
const SIZE: u32 = 8;
/// Pools that are remembered: 1024 instants, over a second of contact.
pub(super) const MEMORY: usize = 128;

/// The mean of some instants, scaled.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pooled<T> {
    /// x/δ₀
    pub position: T,
    /// δ̇/v₀
    pub speed: T,
    /// F/F₀
    pub force: T,
    /// Rate of the force.
    pub rate: T,
    /// Variance of the position about its mean.
    pub spread: T,
    /// Covariance of position and speed.
    pub coupling: T,
    /// Variance of the position's error, per instant.
    pub jitter: T,
    /// Number of instants.
    pub count: T,
}

impl<T: Real> Pooled<T> {
    /// One instant.
    pub fn of(at: &Instant<T>) -> Self {
        Pooled {
            position: at.position(),
            speed: at.speed,
            force: at.force,
            rate: at.rate,
            spread: at.spread,
            coupling: at.coupling,
            jitter: at.jitter,
            count: T::unit(),
        }
    }
}

/// Gathers instants.
#[derive(Clone, Debug, Default)]
pub struct Pool<T> {
    first: Pooled<T>,
    /// Sums of differences to the first: f32 keeps nanometres at 0.2 m in them.
    sum: Pooled<T>,
    taken: u32,
    closed: bool,
}

impl<T: Real> Pool<T> {
    /// The next instant does not follow the last one: it begins another pool.
    pub fn close(&mut self) {
        self.closed = true;
    }

    /// Takes an instant; gives a pool when one is complete.
    pub fn take(&mut self, at: &Instant<T>) -> Option<Pooled<T>> {
        let at = Pooled::of(at);
        let cut = if self.closed { self.finish() } else { None };
        self.closed = false;
        if self.taken == 0 {
            self.first = at;
        }
        let moved = at.position - self.first.position;
        let faster = at.speed - self.first.speed;
        self.sum.position += moved;
        self.sum.speed += faster;
        self.sum.force += at.force - self.first.force;
        self.sum.rate += at.rate;
        self.sum.spread += at.spread + moved * moved;
        self.sum.coupling += at.coupling + moved * faster;
        self.sum.jitter += at.jitter;
        self.taken += 1;
        if self.taken >= SIZE {
            return self.finish();
        }
        cut
    }

    fn finish(&mut self) -> Option<Pooled<T>> {
        if self.taken == 0 {
            return None;
        }
        let count = T::from_f64(f64::from(self.taken));
        let moved = self.sum.position / count;
        let faster = self.sum.speed / count;
        let pooled = Pooled {
            position: self.first.position + moved,
            speed: self.first.speed + faster,
            force: self.first.force + self.sum.force / count,
            rate: self.sum.rate / count,
            spread: T::nil().max_of(self.sum.spread / count - moved * moved),
            coupling: self.sum.coupling / count - moved * faster,
            jitter: self.sum.jitter / count,
            count,
        };
        self.sum = Pooled::default();
        self.taken = 0;
        Some(pooled)
    }
}

/// The newest pools.
#[derive(Clone, Debug)]
pub struct Memory<T> {
    pools: [Pooled<T>; MEMORY],
    pushed: u32,
}

impl<T: Real> Memory<T> {
    /// Nothing.
    pub fn new() -> Self {
        Memory {
            pools: [Pooled::default(); MEMORY],
            pushed: 0,
        }
    }

    /// Keeps a pool, in place of the oldest if there is no room.
    pub fn push(&mut self, pooled: Pooled<T>) {
        if let Some(slot) = self.pools.get_mut(self.pushed as usize % MEMORY) {
            *slot = pooled;
        }
        self.pushed = self.pushed.saturating_add(1);
    }

    /// Pools so far.
    pub fn pushed(&self) -> u32 {
        self.pushed
    }

    /// Number of the oldest pool that is still there.
    pub fn oldest(&self) -> u32 {
        self.pushed.saturating_sub(MEMORY as u32)
    }

    /// A pool by its number.
    pub fn get(&self, number: u32) -> Option<&Pooled<T>> {
        let there = number < self.pushed && number >= self.oldest();
        self.pools
            .get(number as usize % MEMORY)
            .filter(|_| there)
    }
}
