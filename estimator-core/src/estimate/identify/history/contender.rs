//! A law that may be the right one, and the state of its passes.

use super::{block::Block, gauss_newton::GaussNewton, theta::MODES, theta::Theta};
use crate::maths::scalar::Real;
use crate::physics::law::LawKind;

/// A pass is published when it has moved by less than this many standard errors,
pub(super) const NEAR: f64 = 1.0;
/// and has converged when by less than this: the next one waits for news.
const CONVERGED: f64 = 0.1;
/// The share of blocks that counts as news.
const NEWS: f64 = 0.1;
/// A reference may cost this much more than the one before it (the data grow), and this share,
const WORSE: f64 = 0.3;
const WORSE_SHARE: f64 = 1.2;
/// over data that have not grown by more than this.
const GROWN: f64 = 1.03;
/// A fit whose errors are this many times their variance is bad, and starts anew after some passes.
pub(super) const BAD: f64 = 4.0;
pub(super) const PATIENCE: u32 = 8;
/// References that are rejected one after the other before one that is worse is accepted.
const MOST_REJECTED: u32 = 3;
/// Passes of one mode after which two are tried.
const ONE_MODE_FIRST: u32 = 3;
/// Where two modes start from one: factors on its rate, each fast one with each slow one.
const FASTER: [f64; 3] = [1.5, 4.0, 12.0];
const SLOWER: [f64; 3] = [0.7, 0.3, 0.1];
/// Forgetting factor of what left the history: a memory of 6000 blocks, 50 000 samples.
const ANCHOR_BETA: f64 = 0.99984;

/// A pass over the history that is under way.
#[derive(Clone, Debug)]
pub(super) struct Pass<T: Real> {
    pub(super) fit: GaussNewton<T>,
    /// Whether the pass is over K, λ and B alone.
    pub(super) projected: bool,
}

/// A law and the state of its passes.
#[derive(Clone, Debug)]
pub(super) struct Contender<T: Real> {
    pub(super) law: LawKind,
    /// What is known of the blocks that have left the history, and the relaxation at its beginning.
    pub(super) anchor: GaussNewton<T>,
    /// The last reference that was accepted and what it costs at best; `None`: starts anew.
    accepted: Option<(Theta<T>, T)>,
    /// The next reference.
    proposed: Theta<T>,
    rejected: u32,
    /// Number of passes since it started anew, and how often it did.
    pub(super) passes: u32,
    starts: u32,
    /// Number of the block at which it last finished a pass.
    finished: u32,
    /// Number of blocks that the accepted reference was compared over.
    compared: T,
    /// Where several starts are tried: what they come from, which one is being tried, and the best so
    /// far with its cost.
    origin: Theta<T>,
    trial: usize,
    best_start: Option<(Theta<T>, T)>,
    /// Whether its parameters are known well enough for a gradient to hold.
    linear: bool,
    /// Whether a rate has run against its bound.
    at_bound: bool,
    /// The last step in standard errors, its mean squared residual, and the number of its blocks.
    pub(super) step: T,
    residual: T,
    blocks: T,
}

impl<T: Real> Contender<T> {
    pub(super) fn new(law: LawKind) -> Self {
        Contender {
            law,
            anchor: GaussNewton::new(law, &Theta::repeat(T::one()), T::zero()),
            accepted: None,
            proposed: Theta::repeat(T::zero()),
            rejected: 0,
            passes: 0,
            starts: 0,
            finished: 0,
            linear: false,
            at_bound: false,
            compared: T::zero(),
            origin: Theta::repeat(T::zero()),
            trial: 0,
            best_start: None,
            step: T::from_f64(1e9),
            residual: T::from_f64(1e9),
            blocks: T::zero(),
        }
    }

    /// Takes the oldest block as it leaves the history; `simpler` is where a law of one mode stands.
    pub(super) fn release(
        &mut self,
        block: &Block<T>,
        noise_raw: T,
        surface_error: T,
        simpler: Option<&Theta<T>>,
    ) {
        let good = self.accepted.is_some() && self.residual < T::from_f64(BAD);
        let reference = match self.accepted {
            Some(_) => Some(self.proposed),
            None => simpler.map(|simpler| split(simpler, FASTER.len() + 1)),
        };
        if let Some(reference) = reference {
            self.anchor = self.full_pass(&reference, surface_error).fit;
        }
        if good && self.linear && self.step < T::from_f64(NEAR) {
            self.anchor
                .learn(block, noise_raw, T::from_f64(ANCHOR_BETA));
        } else {
            self.anchor.observe(block);
        }
    }

    fn converged(&self) -> bool {
        self.accepted.is_some() && self.step < T::from_f64(CONVERGED)
    }

    /// Whether it needs a start from the bank.
    pub(super) fn is_lost(&self) -> bool {
        self.accepted.is_none() || self.is_bad()
    }

    /// Whether it leaves more than the noise, or has run into a rate that no data give.
    fn is_bad(&self) -> bool {
        self.residual > T::from_f64(BAD) || self.at_bound
    }

    /// Its next reference, once it has made some passes.
    pub(super) fn standing(&self) -> Option<Theta<T>> {
        (self.passes >= ONE_MODE_FIRST || self.converged()).then_some(self.proposed)
    }

    /// Whether it looks for a start among several.
    pub(super) fn tries_starts(&self) -> bool {
        self.law == LawKind::QuasiLinear2 && self.accepted.is_none()
    }

    /// Whether it is in the middle of its starts, and keeps its turn.
    pub(super) fn keeps_turn(&self) -> bool {
        self.tries_starts() && self.trial > 0
    }

    /// Proposes the reference of the next pass, if there is something for it to find; `next` is the
    /// number of the next block, `simpler` where a law of one mode stands, and `found` the best cell
    /// of the bank.
    pub(super) fn proposes(
        &mut self,
        next: u32,
        simpler: Option<Theta<T>>,
        found: impl FnOnce() -> Option<Theta<T>>,
    ) -> bool {
        let news = T::from_f64(f64::from(next.saturating_sub(self.finished)));
        let waits = self.converged() && news < T::from_f64(NEWS) * self.blocks;
        if waits && !self.is_bad() {
            return false;
        }
        let bad = self.is_bad() && self.passes >= PATIENCE;
        if bad {
            self.accepted = None;
        }
        if self.tries_starts() {
            let Some(simpler) = simpler else { return false };
            self.propose_start(simpler, bad);
        } else if self.accepted.is_none() {
            let Some(found) = found() else { return false };
            self.proposed = found;
            self.start_anew();
        }
        true
    }

    fn start_anew(&mut self) {
        self.passes = 0;
        self.starts = self.starts.wrapping_add(1);
    }

    /// Proposes the next of its starts. They come from one mode, every other time after a bad end
    /// from where that was.
    fn propose_start(&mut self, simpler: Theta<T>, bad: bool) {
        if self.trial == 0 {
            self.origin = if bad && self.starts % 2 == 1 {
                self.proposed
            } else {
                simpler
            };
            self.start_anew();
        }
        self.proposed = split(&self.origin, self.trial);
    }

    /// The first of the two passes at the next reference. What has left the history is known for all
    /// parameters together: then it is one over all of them.
    pub(super) fn first_pass(&self, surface_error: T) -> Pass<T> {
        if self.anchor.informed && !self.tries_starts() {
            return self.full_pass(&self.proposed, surface_error);
        }
        Pass {
            fit: self.anchor.projected(self.law, &self.proposed),
            projected: true,
        }
    }

    /// A pass over all parameters.
    pub(super) fn full_pass(&self, reference: &Theta<T>, surface_error: T) -> Pass<T> {
        Pass {
            fit: self.anchor.at_reference(self.law, reference, surface_error),
            projected: false,
        }
    }

    /// Whether a reference is no worse than the one before, by what it costs at best; else the next
    /// one is halfway. Costs over other data cannot be compared: there every reference is accepted.
    pub(super) fn accepts(&mut self, pass: &GaussNewton<T>) -> bool {
        let (cost, blocks) = (pass.residual(), pass.blocks);
        let grown = blocks > T::from_f64(GROWN) * self.compared;
        let worse = match self.accepted {
            Some((_, before)) if !grown => {
                cost > T::from_f64(WORSE_SHARE) * before + T::from_f64(WORSE)
            }
            _ => false,
        };
        if pass.is_sound() && (!worse || self.rejected >= MOST_REJECTED) {
            self.rejected = 0;
            self.accepted = Some((pass.reference, cost));
            self.compared = blocks;
            return true;
        }
        self.rejected += 1;
        match self.accepted {
            // Halfway to a reference that more data have made unsound the next one is as unsound, for good: two
            // modes that were tried on the first 0.1 s of a press stayed beyond the bound of their rates, and one
            // in seven palpations ended with one mode.
            Some(_) if !pass.is_sound() && self.rejected > MOST_REJECTED => {
                (self.accepted, self.rejected) = (None, 0);
            }
            Some((reference, _)) => {
                self.proposed = (reference + self.proposed) * T::from_f64(0.5);
            }
            None => self.passes = PATIENCE,
        }
        false
    }

    /// Takes the cost of a start; after the last one, the best is the next reference.
    pub(super) fn rate_start(&mut self, pass: &GaussNewton<T>) {
        let cost = pass.residual();
        let better = self.best_start.is_none_or(|(_, kept)| cost < kept);
        if pass.is_sound() && better {
            self.best_start = Some((pass.reference, cost));
        }
        self.trial += 1;
        if self.trial >= FASTER.len() * SLOWER.len() {
            self.accepted = self.best_start;
            self.compared = T::zero();
            if let Some((reference, _)) = self.best_start {
                self.proposed = reference;
            }
            self.trial = 0;
            self.best_start = None;
        }
    }

    /// Takes a finished pass over all parameters; returns whether it is one to go on from.
    pub(super) fn finish(&mut self, pass: &GaussNewton<T>, surface_error: T) -> bool {
        self.finished = pass.next;
        self.passes = self.passes.saturating_add(1);
        if !pass.is_sound() {
            self.accepted = None;
            self.step = T::from_f64(1e9);
            return false;
        }
        self.proposed = pass.stepped(surface_error);
        self.step = pass.step();
        self.linear = pass.is_linear();
        self.at_bound = pass.is_at_bound();
        self.residual = pass.residual();
        self.blocks = pass.blocks;
        if self.accepted.is_none() {
            self.accepted = Some((pass.reference, pass.cost()));
        }
        true
    }

    /// Schwarz's criterion: n·ln(mean squared residual) + p·ln n.
    pub(super) fn criterion(&self) -> T {
        let floor = T::from_f64(0.1).max_of(self.residual);
        let count = self.blocks.max_of(T::one());
        let parameters = T::from_f64(self.law.parameters().len() as f64);
        count * floor.ln() + parameters * count.ln()
    }
}

/// Where two modes start from one.
fn split<T: Real>(one: &Theta<T>, trial: usize) -> Theta<T> {
    let [(relaxing_1, log_rate_1), (relaxing_2, log_rate_2)] = MODES;
    let factor = |factors: &[f64], index: usize| factors.get(index).map_or(0.0, |f| libm::log(*f));
    let mut two = *one;
    let half = T::from_f64(0.5) * (one[relaxing_1] + one[relaxing_2]);
    let middle = if one[relaxing_2] > T::zero() {
        T::from_f64(0.5) * (one[log_rate_1] + one[log_rate_2])
    } else {
        one[log_rate_1]
    };
    (two[relaxing_1], two[relaxing_2]) = (half, half);
    two[log_rate_1] = middle + T::from_f64(factor(&FASTER, trial % FASTER.len()));
    two[log_rate_2] = middle + T::from_f64(factor(&SLOWER, trial / FASTER.len()));
    two
}
