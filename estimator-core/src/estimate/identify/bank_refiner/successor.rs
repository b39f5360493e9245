//! A refiner that learns again from memory: at a better reference, or to challenge the estimates.

use super::super::{ForceNoise, PoolRing, Refiner};
use crate::maths::scalar::Real;

/// A successor is started when the linearization error exceeds this share of the variance of the
/// filtered noise. Where it cannot learn from all samples of its predecessor, it takes over when its
/// standard errors are within this factor, or within three times when it has learned from three quarters of the
/// samples: after a swap in a press those were of a hold, and the press itself, which had told everything, was the rest.
pub(super) const LINEARIZATION_SHARE: f64 = 0.02;
const SIMILAR: f64 = 1.5;
const WORSE_AT_MOST: f64 = 3.0;
/// Pools between two challengers. One takes over when it lowers the cost of the memory by more than this:
/// χ² of five parameters exceeds 40 with probability 10⁻⁷. Estimates that had to be replaced are doubted
/// for this many pools: two seconds of contact, after which the next challenges have confirmed them.
pub(super) const CHALLENGE_EVERY: u32 = 80;
const CHALLENGED: f64 = 40.0;
pub(super) const DOUBTED: u32 = 256;
/// Forgetting factor of a refiner per pool of 8: a memory of 50 000 samples. The estimates of one material
/// only get better, and another material clears them.
pub(super) const REFINER_BETA: f64 = 0.99984;
/// Pools that a successor learns from at every sample; one less where each is compared with the estimates,
/// so that no sample costs more.
const CATCH_UP: u32 = 3;
const COMPARED: u32 = 2;

/// A refiner that learns from memory what its predecessor learned live.
#[derive(Clone, Debug)]
pub(super) struct Successor<T: Real> {
    pub(super) refiner: Refiner<T>,
    next: u32,
    /// Whether the memory reaches back to the first contact.
    pub(super) complete: bool,
    /// By how much the cost of what it has learned from is larger for the estimates than for it.
    gain: T,
    /// Whether it stays only if it contradicts the estimates.
    pub(super) challenges: bool,
}

impl<T: Real> Successor<T> {
    /// A refiner that will learn from everything in memory.
    pub(super) fn new(refiner: Refiner<T>, memory: &PoolRing<T>, challenges: bool) -> Self {
        let next = memory.oldest();
        Successor {
            refiner,
            next,
            complete: next == 0,
            gain: T::zero(),
            challenges,
        }
    }

    /// Learns a share of the memory, and says whether it has come to its end. What it learns is compared
    /// with what the estimates say of it.
    pub(super) fn catch_up(
        &mut self,
        memory: &PoolRing<T>,
        estimates: Option<&Refiner<T>>,
        noise: &ForceNoise<T>,
    ) -> bool {
        // One that has learned everything takes over whatever the estimates say.
        let estimates = estimates.filter(|_| !self.complete);
        let pools = match estimates {
            Some(_) => COMPARED,
            None => CATCH_UP,
        };
        for _ in 0..pools {
            if let Some(pooled) = memory.get(self.next) {
                let cost = self.refiner.learn(pooled, noise, T::from_f64(REFINER_BETA));
                if let Some(estimates) = estimates {
                    self.gain += estimates.cost(pooled, cost.weight, noise) - cost.least;
                }
                self.next += 1;
            }
        }
        self.next >= memory.pushed()
    }

    /// Whether what it has learned from contradicts the estimates.
    pub(super) fn is_better(&self) -> bool {
        let inflation = self.refiner.misfit().excess().inflation;
        self.gain > T::from_f64(CHALLENGED) * inflation * inflation
    }

    /// Whether it knows what the estimates know.
    pub(super) fn knows_as_much_as(&self, estimates: &Refiner<T>) -> bool {
        let most = self.refiner.learned > T::from_f64(0.75) * estimates.learned;
        let factor = if most { WORSE_AT_MOST } else { SIMILAR };
        self.refiner
            .knows_as_well_as(estimates, T::from_f64(factor))
    }
}
