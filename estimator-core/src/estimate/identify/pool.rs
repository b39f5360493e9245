//! Neighbouring instants pooled into one, so that a stroke fits into memory.
//!
//! The mean of eight instants of a smooth motion holds as much information as the eight, if the law
//! is averaged over the motion between them: variance and covariance give that average, as they do
//! for the filter's window. A second of contact then fits into 4 kB, and can be learned from again
//! with a better linearization.

use super::Instant;
use crate::maths::scalar::Real;

/// Number of instants in a pool.
const SIZE: u32 = 8;
/// Number of pools in the ring: 1024 instants, more than a second of contact.
pub(super) const MEMORY: usize = 128;

/// The mean of consecutive instants, scaled.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pooled<T> {
    /// Position x/δ₀.
    pub position: T,
    /// Rate of the depth, δ̇/v₀.
    pub speed: T,
    /// Force F/F₀.
    pub force: T,
    /// Rate of the force.
    pub rate: T,
    /// Variance of the position about its mean.
    pub position_variance: T,
    /// Covariance of position and speed.
    pub position_velocity_cov: T,
    /// Variance that the steps of the position sensor give the position of an instant.
    pub quantization_variance: T,
    /// Number of samples since the load began.
    pub loaded: T,
    /// Number of instants.
    pub count: T,
}

impl<T: Real> Pooled<T> {
    /// A pool of one instant.
    pub fn of(at: &Instant<T>) -> Self {
        Pooled {
            position: at.position(),
            speed: at.speed,
            force: at.force,
            rate: at.rate,
            position_variance: at.position_variance,
            position_velocity_cov: at.position_velocity_cov,
            quantization_variance: at.quantization_variance,
            loaded: at.loaded,
            count: T::one(),
        }
    }
}

/// Pools consecutive instants.
#[derive(Clone, Debug, Default)]
pub struct Pool<T> {
    first: Pooled<T>,
    /// Sums of differences to the first: f32 keeps nanometres at 0.2 m in them.
    sum: Pooled<T>,
    taken: u32,
    closed: bool,
}

impl<T: Real> Pool<T> {
    /// Makes the next instant begin another pool, as it does not follow the last one.
    pub fn close(&mut self) {
        self.closed = true;
    }

    /// Takes an instant; returns a pool when one is complete.
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
        self.sum.position_variance += at.position_variance + moved * moved;
        self.sum.position_velocity_cov += at.position_velocity_cov + moved * faster;
        self.sum.quantization_variance += at.quantization_variance;
        self.sum.loaded += at.loaded;
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
        let count = T::from_u32(self.taken);
        let moved = self.sum.position / count;
        let faster = self.sum.speed / count;
        let pooled = Pooled {
            position: self.first.position + moved,
            speed: self.first.speed + faster,
            force: self.first.force + self.sum.force / count,
            rate: self.sum.rate / count,
            position_variance: T::zero().max_of(self.sum.position_variance / count - moved * moved),
            position_velocity_cov: self.sum.position_velocity_cov / count - moved * faster,
            quantization_variance: self.sum.quantization_variance / count,
            loaded: self.sum.loaded / count,
            count,
        };
        self.sum = Pooled::default();
        self.taken = 0;
        Some(pooled)
    }
}

/// The newest pools, numbered from 0 on.
#[derive(Clone, Debug)]
pub struct PoolRing<T> {
    pools: [Pooled<T>; MEMORY],
    pushed: u32,
    /// Number of the first pool that has not been forgotten.
    first: u32,
}

impl<T: Real> Default for PoolRing<T> {
    fn default() -> Self {
        PoolRing {
            pools: [Pooled::default(); MEMORY],
            pushed: 0,
            first: 0,
        }
    }
}

impl<T: Real> PoolRing<T> {
    /// Keeps a pool, in place of the oldest if there is no room.
    pub fn push(&mut self, pooled: Pooled<T>) {
        if let Some(slot) = self.pools.get_mut(self.pushed as usize % MEMORY) {
            *slot = pooled;
        }
        self.pushed = self.pushed.saturating_add(1);
    }

    /// Forgets every pool, but not that there were some.
    pub fn clear(&mut self) {
        self.pushed = self.pushed.saturating_add(1);
        self.first = self.pushed;
    }

    /// Number of pools so far.
    pub fn pushed(&self) -> u32 {
        self.pushed
    }

    /// Number of the oldest pool that is still there; 0 if none was ever lost.
    pub fn oldest(&self) -> u32 {
        self.first.max(self.pushed.saturating_sub(MEMORY as u32))
    }

    /// The pool with a number, if it is still there.
    pub fn get(&self, number: u32) -> Option<&Pooled<T>> {
        let there = number < self.pushed && number >= self.oldest();
        self.pools.get(number as usize % MEMORY).filter(|_| there)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(i: u32) -> Instant<f64> {
        let t = f64::from(i);
        Instant {
            depth: 1.0 + 0.02 * t + 1e-3 * t * t,
            speed: 0.02 + 2e-3 * t,
            force: 3.0 * t,
            surface: 200.0,
            position_variance: 0.01,
            ..Instant::default()
        }
    }

    #[test]
    fn eight_instants_become_their_mean_variance_and_covariance() {
        let mut pool = Pool::default();
        let pooled = (0..8).filter_map(|i| pool.take(&at(i))).last().unwrap();
        let mean = |of: &dyn Fn(Instant<f64>) -> f64| (0..8).map(|i| of(at(i))).sum::<f64>() / 8.0;
        let (x, v) = (mean(&|at| at.position()), mean(&|at| at.speed));
        assert!((pooled.position - x).abs() < 1e-12);
        assert!((pooled.force - 10.5).abs() < 1e-12 && pooled.count == 8.0);
        let position_variance = mean(&|at| (at.position() - x) * (at.position() - x));
        let position_velocity_cov = mean(&|at| (at.position() - x) * (at.speed - v));
        assert!(
            (pooled.position_variance - 0.01 - position_variance).abs() < 1e-12,
            "{pooled:?}"
        );
        assert!(
            (pooled.position_velocity_cov - position_velocity_cov).abs() < 1e-12,
            "{pooled:?}"
        );
    }

    #[test]
    fn a_gap_cuts_a_pool_and_loses_nothing() {
        let mut pool = Pool::default();
        assert!((0..5).all(|i| pool.take(&at(i)).is_none()));
        pool.close();
        let cut = pool.take(&at(100)).unwrap();
        assert_eq!((cut.count, cut.force), (5.0, 6.0));
        let next = (101..108).filter_map(|i| pool.take(&at(i))).last().unwrap();
        assert_eq!((next.count, next.force), (8.0, 3.0 * 103.5));
    }

    #[test]
    fn memory_holds_the_newest_pools_under_their_numbers() {
        let mut memory = PoolRing::<f64>::default();
        for number in 0..MEMORY as u32 + 10 {
            memory.push(Pooled {
                force: f64::from(number),
                ..Pooled::default()
            });
        }
        assert_eq!(memory.oldest(), 10);
        assert_eq!(memory.get(9), None);
        assert_eq!(memory.get(10).unwrap().force, 10.0);
        assert_eq!(memory.get(memory.pushed() - 1).unwrap().force, 137.0);
        assert_eq!(memory.get(memory.pushed()), None);
    }
}
