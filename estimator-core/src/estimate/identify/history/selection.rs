//! Passes over the history, law by law, and the choice of the law by its evidence.
//!
//! The laws of a method take turns; a law takes over when the criterion of Bayes speaks for it
//! (Schwarz 1978).

use super::bank::RelaxationBank;
use super::block_history::{BLOCKS, BlockHistory};
use super::contender::{BAD, Contender, NEAR, PATIENCE, Pass};
use super::gauss_newton::GaussNewton;
use super::theta::Theta;
use crate::maths::scalar::Real;
use crate::physics::law::LawKind;

/// Number of blocks that a pass takes at one sample: over a history of 600 a pass takes 40 ms at 1 kHz. With 2 the
/// second mode was tried twice in 8 s of strokes, and never found; with 64 nothing settles earlier.
const BLOCKS_PER_SAMPLE: u32 = 16;
/// Number of blocks over which the passes go; the rest of the history waits to be released.
const KEPT: u32 = BLOCKS as u32 - 8;
/// Range of force that the blocks must cover before the first pass.
const FIRST_RANGE: f64 = 2.0;
/// By how much the criterion must speak for a law with more parameters: 10 is very strong (Kass &
/// Raftery 1995).
const MARGIN: f64 = 10.0;
/// A law whose mean squared residual is this share of a bad one takes its place at once.
const FAR_BETTER: f64 = 0.25;
/// The most laws that a method chooses from.
const MOST_LAWS: usize = 4;

/// The laws of a method, the simplest first, and the pass that is under way.
#[derive(Clone, Debug)]
pub(super) struct Selection<T: Real> {
    contenders: [Option<Contender<T>>; MOST_LAWS],
    pass: Option<Pass<T>>,
    /// The contender whose pass it is, and the one whose fit is in use.
    turn: usize,
    champion: usize,
}

impl<T: Real> Selection<T> {
    /// The laws with nothing learned; their passes begin at block number `first`.
    pub(super) fn new(laws: &[LawKind], first: u32) -> Self {
        let mut contenders = [const { None }; MOST_LAWS];
        for (slot, law) in contenders.iter_mut().zip(laws) {
            let mut contender = Contender::new(*law);
            contender.anchor.next = first;
            *slot = Some(contender);
        }
        Selection {
            contenders,
            pass: None,
            turn: 0,
            champion: 0,
        }
    }

    fn contenders(&self) -> impl Iterator<Item = &Contender<T>> {
        self.contenders.iter().flatten()
    }

    /// Whether Zener is the only law, whose exponent is 1.
    pub(super) fn is_zener(&self) -> bool {
        self.contenders().all(|one| one.law == LawKind::Zener)
    }

    /// Whether no law with more parameters than the one in use could still take its place.
    pub(super) fn has_no_other(&self) -> bool {
        self.champion + 1 >= self.contenders().count()
    }

    /// Whether a law needs a start from the bank.
    pub(super) fn needs_start(&self) -> bool {
        self.contenders().any(Contender::is_lost)
    }

    /// Where the simplest law stands, once it has made some passes.
    fn simplest(&self) -> Option<Theta<T>> {
        self.contenders.first()?.as_ref()?.standing()
    }

    /// Releases the oldest block from the history, for one law at a time; returns whether one was
    /// due.
    pub(super) fn release(
        &mut self,
        history: &BlockHistory<T>,
        noise_raw: T,
        surface_error: T,
    ) -> bool {
        let simpler = self.simplest();
        let due = history.next().saturating_sub(KEPT);
        let behind = |one: &&mut Contender<T>| one.anchor.next < due;
        let Some(contender) = self.contenders.iter_mut().flatten().find(behind) else {
            return false;
        };
        match history.get(contender.anchor.next) {
            Some(block) => contender.release(block, noise_raw, surface_error, simpler.as_ref()),
            None => contender.anchor.next = history.oldest(),
        }
        true
    }

    /// Whether the pass that is under way has come to the newest block.
    pub(super) fn has_finished(&self, history: &BlockHistory<T>) -> bool {
        let ends = |pass: &Pass<T>| pass.fit.next >= history.next();
        self.pass.as_ref().is_some_and(ends)
    }

    /// Goes on with the pass that is under way, or begins one. At a sample that has searched the bank
    /// it takes one block less: that costs as much as a block.
    pub(super) fn work(
        &mut self,
        history: &BlockHistory<T>,
        bank: &RelaxationBank<T>,
        noise_raw: T,
        searched: bool,
    ) {
        let Some(pass) = &mut self.pass else {
            self.begin(history, bank);
            return;
        };
        for taken in 0..BLOCKS_PER_SAMPLE - u32::from(searched) {
            match history.get(pass.fit.next) {
                Some(block) => pass.fit.learn(block, noise_raw, T::one()),
                None if taken > 0 => return,
                // Overtaken by the end of the history.
                None => {
                    self.pass = None;
                    return;
                }
            }
        }
    }

    /// Begins a pass of the contender whose turn it is, if there is something for it to find.
    fn begin(&mut self, history: &BlockHistory<T>, bank: &RelaxationBank<T>) {
        let (low, high) = bank.span;
        if high < T::from_f64(FIRST_RANGE) * low {
            return;
        }
        let contender = self.contenders.get(self.turn).and_then(Option::as_ref);
        if !contender.is_some_and(Contender::keeps_turn) {
            let laws = self.contenders().count().max(1);
            self.turn = (self.turn + 1) % laws;
        }
        let simpler = self.simplest();
        let Some(Some(contender)) = self.contenders.get_mut(self.turn) else {
            return;
        };
        let linear = matches!(contender.law, LawKind::Zener | LawKind::KelvinVoigt);
        if contender.proposes(history.next(), simpler, || bank.best(linear)) {
            self.pass = Some(contender.first_pass(bank.surface_step));
        }
    }

    /// Takes the pass that has come to the newest block; `current` is the fit in use. Returns the fit
    /// that takes its place, if there is one, and whether it is good: its last step was small and its
    /// errors are those of the noise.
    pub(super) fn finish(
        &mut self,
        current: Option<&GaussNewton<T>>,
        surface_error: T,
    ) -> Option<(GaussNewton<T>, bool)> {
        let Pass { fit, projected } = self.pass.take()?;
        let contender = self.contenders.get_mut(self.turn)?.as_mut()?;
        if projected {
            if contender.tries_starts() {
                contender.rate_start(&fit);
            } else if contender.accepts(&fit) {
                self.pass = Some(contender.full_pass(&fit.values(), surface_error));
            }
            return None;
        }
        let sound = contender.finish(&fit, surface_error);
        if !(sound && self.takes(&fit, current)) {
            return None;
        }
        self.champion = self.turn;
        let near = self.turns()?.step < T::from_f64(NEAR);
        let good = near && fit.residual() < T::from_f64(BAD);
        Some((fit, good))
    }

    fn turns(&self) -> Option<&Contender<T>> {
        self.contenders.get(self.turn)?.as_ref()
    }

    /// Whether a fit takes the place of the one in use.
    fn takes(&self, fit: &GaussNewton<T>, current: Option<&GaussNewton<T>>) -> bool {
        let Some(contender) = self.turns() else {
            return false;
        };
        let near = contender.step < T::from_f64(NEAR);
        let champion = self.contenders.get(self.champion).and_then(Option::as_ref);
        match (current, champion) {
            (None, _) | (_, None) => near || contender.passes >= PATIENCE / 2,
            (Some(current), _) if self.turn == self.champion => {
                near || fit.residual() < T::from_f64(0.7) * current.residual()
            }
            (Some(current), Some(champion)) => {
                let margin = if self.turn > self.champion {
                    T::from_f64(MARGIN)
                } else {
                    T::zero()
                };
                // Where the law in use leaves far more than the noise, nobody waits for the last step.
                let far_better = current.residual() > T::from_f64(BAD)
                    && fit.residual() < T::from_f64(FAR_BETTER) * current.residual();
                (near || far_better) && contender.criterion() + margin < champion.criterion()
            }
        }
    }
}
