//! The estimates from before a change of material, which come back if it was none: a fault that has passed,
//! or a surface that is elsewhere since an encoder has jumped.

use super::super::{ForceNoise, PoolRing, Pooled, Refiner, bank::Candidate};
use super::claims::Claims;
use crate::maths::scalar::Real;

/// After a change, the estimates before it come back if they predict this many pools in a row of at least
/// this force over the noise, within so many pools: 0.1 s of contact, within two.
const AGREE_POOLS: u32 = 12;
const AGREE_SIGMAS: f64 = 20.0;
/// A prediction agrees within so many standard errors.
const AGREE_ERRORS: f64 = 3.0;
pub(super) const RECONSIDERED: u32 = 256;
/// Range of the force, from the least to the largest of those pools, that tells a surface that has moved
/// from another material.
const AGREE_RANGE: f64 = 2.0;
/// Over a few pools old estimates with a surface that has moved predict another material as well: on the way
/// out of a gel that had become 1.5 times as stiff those from before came back, a second after the new ones had
/// converged. They do not where the new ones predict the same pools and are so many of their standard errors
/// away.
const ANOTHER_SIGMAS: f64 = 4.0;
/// A material that would have to be more than so many times as stiff, or as soft, is not begun from: near a surface
/// that has moved the force of the last one is next to nothing.
const MOST_TIMES: f64 = 4.0;

/// The estimates before the last change of material.
#[derive(Clone, Debug)]
pub(super) struct Previous<T: Real> {
    pub(super) refiner: Refiner<T>,
    pub(super) claims: Claims<T>,
    /// Where they stand with the surface that they know, and with one that has moved.
    there: Agreement<T>,
    moved: Agreement<T>,
    /// Number of pools in a row that the estimates since then predict as well.
    since: u32,
}

/// How long the estimates have predicted the force with the surface in one place.
#[derive(Clone, Copy, Debug, Default)]
struct Agreement<T> {
    /// How far the surface lies behind the one that they know, and the standard deviation of that.
    shift: T,
    shift_error: T,
    /// Number of pools in a row that they predict, and the least and the largest force of those.
    pools: u32,
    span: (T, T),
}

impl<T: Real> Agreement<T> {
    /// Takes a pool with its prediction: the error, its largest square, and the slope dF/dx. `alone` is the shift by
    /// this pool alone.
    fn take(&mut self, force: T, error: T, most: T, slope: T, alone: Option<T>) {
        let moves = alone.is_some();
        // Of an error that is no number neither is true, and it agrees with nothing.
        let agrees = error * error < most;
        if !agrees {
            self.shift = alone.unwrap_or_default();
            (self.pools, self.span) = (0, (force, force));
            return;
        }
        self.pools += 1;
        let (low, high) = self.span;
        self.span = (low.min_of(force), high.max_of(force));
        if moves && slope > T::zero() {
            let share = T::one() / T::from_u32(self.pools + 1);
            self.shift -= share * error / slope;
            // That of one pool: the errors of the estimates are in all of them.
            self.shift_error = most.sqrt() / (T::from_f64(AGREE_ERRORS) * slope);
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
            since: 0,
        }
    }

    /// Them with spring and damper scaled so that they predict the force of the newest pool, once a pool has
    /// contradicted that the material is the same, where it was or elsewhere. After a change within a press the
    /// range of force that the bank needs may take seconds to come.
    pub(super) fn scaled_to(&self, memory: &PoolRing<T>) -> Option<Candidate<T>> {
        let pooled = memory.get(memory.pushed().checked_sub(1)?)?;
        let (force, _) = self.refiner.predict(pooled);
        let times = pooled.force / force;
        let most = T::from_f64(MOST_TIMES);
        let is_alike = force > T::zero() && times < most && times * most > T::one();
        let is_another = self.there.pools == 0 && self.moved.pools == 0;
        let [stiffness, damping, exponent, surface, _] = self.refiner.values();
        let residual = self.refiner.residual;
        (is_alike && is_another).then_some(Candidate {
            stiffness: times * stiffness,
            damping: times * damping,
            exponent,
            surface,
            residual,
        })
    }

    /// How far the surface has moved, and the standard deviation of that, if they have predicted enough pools in a
    /// row; pools of a small force say nothing. `since` are the estimates from after the change.
    pub(super) fn agrees_with(
        &mut self,
        pooled: &Pooled<T>,
        noise: &ForceNoise<T>,
        since: Option<(&Refiner<T>, &Claims<T>)>,
    ) -> Option<(T, T)> {
        if pooled.force < T::from_f64(AGREE_SIGMAS) * noise.raw {
            return None;
        }
        for (agreement, moves) in [(&mut self.there, false), (&mut self.moved, true)] {
            let at = Pooled {
                position: pooled.position - agreement.shift,
                ..*pooled
            };
            let (force, variance) = self.refiner.predict(&at);
            let most = most(variance, noise);
            let slope = self.refiner.slope(&at);
            // Beyond a surface that has moved further than the depth there is no slope to follow.
            let alone = moves.then(|| pooled.position - self.refiner.position_of(pooled));
            agreement.take(pooled.force, pooled.force - force, most, slope, alone);
        }
        let predicted = since.is_some_and(|(refiner, _)| {
            let (force, variance) = refiner.predict(pooled);
            let error = pooled.force - force;
            error * error < most(variance, noise)
        });
        self.since = if predicted { self.since + 1 } else { 0 };
        if self.since >= AGREE_POOLS && since.is_some_and(|since| self.differs_from(since)) {
            None
        } else if self.there.holds(0.0) {
            Some((T::zero(), T::zero()))
        } else {
            let moved = (self.moved.shift, self.moved.shift_error);
            self.moved.holds(AGREE_RANGE).then_some(moved)
        }
    }

    /// Whether the estimates since are of another K, λ or n for sure.
    fn differs_from(&self, (refiner, claims): (&Refiner<T>, &Claims<T>)) -> bool {
        let sigmas = T::from_f64(ANOTHER_SIGMAS) * claims.excess.inflation;
        let pairs = refiner.values().into_iter().zip(self.refiner.values());
        let mut material = pairs.zip(claims.std_errors).take(3);
        material.any(|((now, then), error)| (now - then).abs() > sigmas * error)
    }
}

/// The largest square of the error of a prediction that agrees.
fn most<T: Real>(variance: T, noise: &ForceNoise<T>) -> T {
    T::from_f64(AGREE_ERRORS * AGREE_ERRORS) * (variance + noise.filtered * noise.filtered)
}
