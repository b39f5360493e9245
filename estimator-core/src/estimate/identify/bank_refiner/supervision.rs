//! The bank supervises the refiner: it starts one, and what has been learned is learned again at a better reference, or
//! challenged.

use super::super::{Bank, ForceNoise, Prior, Refiner};
use super::BankRefiner;
use super::successor::{CHALLENGE_EVERY, DOUBTED, LINEARIZATION_SHARE, Successor};
use crate::maths::scalar::Real;

/// Pools before the refiner starts.
const START_POOLS: f64 = 3.0;
/// When the mean squared residual of the refiner is this many times the bank's, the bank starts
/// another refiner.
const WORSE: f64 = 8.0;
/// Prior standard deviation of the exponent, and of the surface over the reference depth, as long as estimates that
/// began from those before a change within a press have seen no range of force: what a probe has not left is where it
/// was, and much alike. Once there is a range they weigh next to nothing.
const ALIKE: f64 = 0.05;

impl<T: Real> BankRefiner<T> {
    /// Starts a refiner from the bank: the first one, or one that replaces a refiner whose residual
    /// has become far larger than the bank's.
    pub(super) fn supervise(&mut self, noise: &ForceNoise<T>) {
        let Some(bank) = &self.bank else { return };
        if bank.weight < T::from_f64(START_POOLS) || self.successor.is_some() {
            return;
        }
        let early = !bank.has_range();
        let previous = self.previous.as_ref().filter(|_| self.refiner.is_none());
        let candidate = match early {
            true => previous.and_then(|own| own.scaled_to(&self.memory)),
            false => bank.best(),
        };
        let Some(candidate) = candidate else { return };
        if let Some(refiner) = self.refiner.as_ref().filter(|refiner| refiner.is_sound()) {
            let floor = candidate.residual + noise.filtered * noise.filtered;
            if refiner.residual <= T::from_f64(WORSE) * floor {
                return;
            }
        }
        self.began_early = early;
        self.begin(
            Refiner::new(&candidate, T::zero(), &self.prior_now()),
            false,
        );
    }

    /// Starts a refiner at a better reference when the linearization error of the current one
    /// matters.
    pub(super) fn relinearize(&mut self, noise: &ForceNoise<T>) {
        let Some(refiner) = &self.refiner else { return };
        let tolerated = T::from_f64(LINEARIZATION_SHARE) * noise.filtered * noise.filtered;
        if self.successor.is_none() && refiner.is_sound() && refiner.linearization_error > tolerated
        {
            self.begin(refiner.successor(&self.prior_now()), false);
        }
    }

    /// Whether the estimates began from the material before and have seen a range of force that tells little.
    pub(super) fn lacks_range(&self) -> bool {
        self.began_early && !self.bank.as_ref().is_none_or(Bank::has_range)
    }

    fn prior_now(&self) -> Prior<T> {
        let alike = T::from_f64(ALIKE);
        match self.lacks_range() {
            true => Prior {
                surface: self.prior.surface.min_of(alike),
                exponent: alike,
                ..self.prior
            },
            false => self.prior,
        }
    }

    fn begin(&mut self, refiner: Refiner<T>, challenges: bool) {
        self.successor = Some(Successor::new(refiner, &self.memory, challenges));
    }

    /// Starts a challenger, which learns from the memory alone. What was learned before it may be of
    /// another material, or of a fault, and would never be forgotten.
    pub(super) fn challenge(&mut self) {
        let Some(refiner) = &self.refiner else { return };
        let due = self.memory.pushed() >= self.next_challenge;
        if !due || self.successor.is_some() || !refiner.is_sound() {
            return;
        }
        self.next_challenge = self.memory.pushed().saturating_add(CHALLENGE_EVERY);
        if self.memory.oldest() == 0 {
            return;
        }
        self.begin(refiner.successor(&self.prior_now()), true);
    }

    /// The successor learns from memory, and takes over once it knows what its predecessor does.
    pub(super) fn catch_up(&mut self, noise: &ForceNoise<T>) {
        let Some(successor) = &mut self.successor else {
            return;
        };
        if !successor.catch_up(&self.memory, self.refiner.as_ref(), noise) {
            return;
        }
        let knows = match &self.refiner {
            Some(refiner) if refiner.is_sound() && !successor.complete => {
                if successor.is_better() {
                    self.doubted_until = self.memory.pushed().saturating_add(DOUBTED);
                }
                successor.is_better()
                    || !successor.challenges && successor.knows_as_much_as(refiner)
            }
            _ => true,
        };
        if !successor.refiner.is_sound() || successor.challenges && !knows {
            self.successor = None;
        } else if knows {
            self.refiner = self.successor.take().map(|successor| successor.refiner);
            self.claims.is_stale = true;
        }
    }
}
