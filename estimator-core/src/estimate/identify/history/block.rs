//! The mean of some consecutive instants, as one thing to learn from.

use crate::estimate::identify::Instant;
use crate::maths::scalar::Real;

/// A motion is uneven where its mean lies this share of the way off its middle: a press that becomes a hold half way
/// lies a quarter off.
const UNEVEN: f64 = 0.1;

/// Means over a block of instants, scaled as in [`Instant`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Block<T> {
    pub(super) position: T,
    pub(super) speed: T,
    pub(super) force: T,
    pub(super) position_variance: T,
    pub(super) position_velocity_cov: T,
    pub(super) duration_s: T,
    /// Samples that the force is worth; 0 if it must not be learned from, −1 in free air.
    pub(super) count: T,
}

impl<T: Real> Block<T> {
    /// One instant as a block.
    pub(super) fn of(at: &Instant<T>) -> Self {
        Block {
            position: at.position(),
            speed: at.speed,
            force: at.force,
            position_variance: at.position_variance,
            position_velocity_cov: at.position_velocity_cov,
            duration_s: at.elapsed_s,
            count: T::one(),
        }
    }
}

/// What a block may be used for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Kind {
    /// The probe is in free air, where nothing happens.
    #[default]
    Free,
    /// The probe is in or near the material, but the force must not be learned from.
    Observed,
    /// The force may be learned from.
    Usable,
}

/// The sums of the block that is under way.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct OpenBlock<T> {
    pub(super) kind: Kind,
    pub(super) samples: u32,
    pub(super) duration_s: T,
    /// Position of the first sample; the sums are of differences to it.
    pub(super) first: T,
    position: T,
    square: T,
    speed: T,
    mixed: T,
    force: T,
    position_variance: T,
    position_velocity_cov: T,
}

impl<T: Real> OpenBlock<T> {
    pub(super) fn add(&mut self, at: &Instant<T>) {
        if self.samples == 0 {
            self.first = at.position();
        }
        let moved = at.position() - self.first;
        self.samples = self.samples.saturating_add(1);
        self.duration_s += at.elapsed_s;
        self.position += moved;
        self.square += moved * moved;
        self.speed += at.speed;
        self.mixed += moved * at.speed;
        self.force += at.force;
        self.position_variance += at.position_variance;
        self.position_velocity_cov += at.position_velocity_cov;
    }

    /// Whether the mean lies more than a tenth of the way off its middle; `moved` is the way so far.
    pub(super) fn is_uneven(&self, moved: T) -> bool {
        let mean = (self.position / T::from_f64(f64::from(self.samples))).abs();
        (mean - T::from_f64(0.5) * moved).abs() > T::from_f64(UNEVEN) * moved
    }

    /// The means so far.
    pub(super) fn block(&self) -> Block<T> {
        let count = T::from_f64(f64::from(self.samples));
        let share = T::one() / count;
        let (moved, speed) = (self.position * share, self.speed * share);
        let variance = (self.position_variance + self.square) * share - moved * moved;
        Block {
            position: self.first + moved,
            speed,
            force: self.force * share,
            position_variance: T::zero().max_of(variance),
            position_velocity_cov: (self.position_velocity_cov + self.mixed) * share
                - moved * speed,
            duration_s: self.duration_s,
            count: match self.kind {
                Kind::Usable => count,
                Kind::Observed => T::zero(),
                Kind::Free => -T::one(),
            },
        }
    }
}
