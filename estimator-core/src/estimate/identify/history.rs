//! Laws with memory, and the choice among laws, from a history that is fitted again and again.
//!
//! What relaxes remembers: a filter that starts anew at a better reference does not know what the
//! material went through, and a press that is followed by a hold is the only thing that ever tells
//! the exponent. So the recent past is kept, condensed ([`block_history`]), and Gauss–Newton passes
//! over it, some blocks a sample, at ever better references ([`gauss_newton`]); what leaves the
//! history stays as a covariance and a state of relaxation. A bank of exact fits says where to start
//! ([`bank`]). Each pass measures what its reference costs exactly, so that a step that made it
//! worse is halved ([`contender`]). A method with several laws chooses among them ([`selection`]).

mod approach;
mod bank;
mod block;
mod block_history;
mod contender;
mod current;
mod gauss_newton;
mod predict;
mod selection;
mod theta;

use approach::Approach;
use bank::RelaxationBank;
use block::Block;
use block_history::BlockHistory;
use current::Current;
use selection::Selection;

use super::params::IdentifyParams;
use super::{ForceNoise, Identify, Instant};
use crate::estimate::method::{Method, MethodInfo, Offer, methods};
use crate::estimate::monitor::ParameterEstimate;
use crate::estimate::record::PARAMETER_SLOTS;
use crate::estimate::status::{Doubt, Reason};
use crate::maths::scalar::Real;
use crate::physics::law::LawKind;

/// The grid of surfaces begins this many uncertainties of the impact before it, and reaches two
/// beyond: a force threshold is late, never early.
const SURFACES_BEFORE: f64 = 4.0;
/// Blocks to learn from before the first pass.
const FIRST_PASS: u32 = 5;
/// After this many samples of work over the history an estimate that is still not good will not become so.
const LONG_TRIED: u32 = 8000;

// They forget by no error: another material starts them anew.
methods! {
    /// Zener by a bank of exact fits over surface and rate, refined over a history; the surface among
    /// the parameters.
    // Only where it is asked for: on the foam it says 1682 ± 0.5 N/m, converged, and leaves 0.64 N.
    ZENER_BANK = 10, Zener, "bank", "Bank of exact fits, refined over a history, surface included",
        finds_surface: true, has_history: true;
    /// The quasi-linear law with one mode by a bank over exponent, surface and rate, refined over a
    /// history; the surface among the parameters.
    QUASI_LINEAR_BANK = 11, QuasiLinear, "bank",
        "Bank of exact fits, refined over a history, surface included",
        offer: Offer::Default, finds_surface: true, has_history: true;
    /// [`Method::QUASI_LINEAR_BANK`] with two modes, once the force speaks for the second.
    QUASI_LINEAR_BANK_2 = 12, QuasiLinear2, "bank",
        "Bank of exact fits, refined over a history, surface included",
        offer: Offer::Default, finds_surface: true, has_history: true;
    /// Kelvin–Voigt, Hunt–Crossley, Zener and quasi-linear with one mode side by side over the same
    /// history; the records say which law they are of.
    SELECTION = 13, KelvinVoigt, "online",
        "Four laws side by side, as the board would choose among them while it touches",
        offer: Offer::ChoosesLaw, finds_surface: true, has_history: true;
}

/// The laws that a method chooses from, the simplest first.
fn laws(method: Method) -> &'static [LawKind] {
    match method {
        Method::ZENER_BANK => &[LawKind::Zener],
        Method::QUASI_LINEAR_BANK => &[LawKind::QuasiLinear],
        Method::QUASI_LINEAR_BANK_2 => &[LawKind::QuasiLinear, LawKind::QuasiLinear2],
        Method::SELECTION => &[
            LawKind::KelvinVoigt,
            LawKind::HuntCrossley,
            LawKind::Zener,
            LawKind::QuasiLinear,
        ],
        _ => &[],
    }
}

/// Bank, history and passes, scaled.
#[derive(Clone, Debug)]
pub struct HistoryFit<T: Real> {
    approach: Approach<T>,
    history: BlockHistory<T>,
    bank: Option<RelaxationBank<T>>,
    selection: Selection<T>,
    current: Option<Current<T>>,
    /// The first impact and its standard error.
    impact: Option<(T, T)>,
    /// Blocks that were learned from.
    learned: u32,
    /// Touches that were learned from, and whether one is under way.
    touches: u32,
    touching: bool,
    /// Samples that passes were made at.
    tried: u32,
    /// The estimate has once been good: from here on an error of the prediction is one of the law or
    /// a change of material, and not of an estimate still under way.
    trusted: bool,
}

impl<T: Real> HistoryFit<T> {
    /// The estimator before the first contact.
    pub fn new(params: &IdentifyParams<T>) -> Self {
        Self::with_history(params, BlockHistory::new(), 0)
    }

    /// The estimator before its first pass over a history of which `learned` blocks can be learned
    /// from.
    fn with_history(params: &IdentifyParams<T>, history: BlockHistory<T>, learned: u32) -> Self {
        HistoryFit {
            selection: Selection::new(laws(params.method), history.oldest()),
            approach: Approach::new(),
            history,
            bank: None,
            current: None,
            impact: None,
            learned,
            touches: u32::from(learned > 0),
            touching: learned > 0,
            tried: 0,
            trusted: false,
        }
    }

    /// The depth of an instant, with the standard error of the surface: as estimated, else of the
    /// first impact.
    fn depth(&self, at: &Instant<T>) -> Option<(T, T)> {
        let (impact, error) = self.impact?;
        let surface = self.current.as_ref().map_or(impact, |own| own.surface.0);
        Some((at.position() - surface, error))
    }

    /// Takes an instant, to learn from it if it is `usable`, and goes on with the work over the
    /// history.
    fn take(&mut self, at: &Instant<T>, usable: bool, in_contact: bool) {
        let is_first = in_contact && self.impact.is_none();
        if in_contact {
            self.impact.get_or_insert((at.surface, at.surface_error));
        } else if self.impact.is_none() {
            self.approach.add(at);
        }
        let depth = self.depth(at);
        if let Some(block) = self.history.add(at, depth, usable, in_contact) {
            // Bank and passes wait: no sample pays for everything.
            self.take_block(&block, at);
            if is_first {
                let way = self.approach.touched();
                way.for_each(|block| self.history.push(block));
            }
            return;
        }
        if let Some(current) = &mut self.current {
            current.observe(&Block::of(at));
        }
        self.work(at.noise.raw);
    }

    /// Takes a block that has ended.
    fn take_block(&mut self, block: &Block<T>, at: &Instant<T>) {
        self.history.push(*block);
        self.touching &= block.count >= T::zero();
        if let Some(Current { mut fit, .. }) = self.current.take() {
            fit.learn(block, at.noise.raw, T::one());
            self.current = fit
                .is_sound()
                .then(|| Current::new(fit, self.history.open()));
        }
        if block.count > T::zero() {
            self.touches = self.touches.saturating_add(u32::from(!self.touching));
            self.touching = true;
            self.learned = self.learned.saturating_add(1);
            if self.bank.is_none() {
                let step = at.surface_error;
                let first = at.surface - T::from_f64(SURFACES_BEFORE) * step;
                let linear = self.selection.is_zener();
                let oldest = self.history.oldest();
                self.bank = Some(RelaxationBank::new(first, step, linear, oldest));
            }
        }
    }

    /// The share of the work over the history that one sample pays for.
    fn work(&mut self, noise_raw: T) {
        let surface_error = self
            .bank
            .as_ref()
            .map_or(T::zero(), |bank| bank.surface_step);
        if self.selection.has_finished(&self.history) {
            self.finish(surface_error);
            return;
        }
        if self
            .selection
            .release(&self.history, noise_raw, surface_error)
        {
            return;
        }
        let Some(bank) = &mut self.bank else { return };
        let searches = self.selection.needs_start();
        let taken = self.history.get(bank.next);
        if let Some(block) = taken {
            bank.take(block, searches);
        }
        let searched = searches && taken.is_some();
        if self.learned >= FIRST_PASS {
            self.tried = self.tried.saturating_add(1);
            self.selection
                .work(&self.history, bank, noise_raw, searched);
        }
    }

    /// Takes the pass that has come to the newest block.
    fn finish(&mut self, surface_error: T) {
        let current = self.current.as_ref().map(|current| &current.fit);
        let Some((fit, good)) = self.selection.finish(current, surface_error) else {
            return;
        };
        let before = self.current.as_ref().map(|current| current.fit.law);
        let current = Current::new(fit, self.history.open());
        self.trusted &= before == Some(current.fit.law);
        // One touch may be followed by too simple a law, which the next one shows.
        let tested = self.touches > 1 || self.selection.has_no_other();
        self.trusted |= good && tested && current.is_known();
        self.current = Some(current);
    }
}

impl<T: Real> Identify<T> for HistoryFit<T> {
    const METHODS: &'static [MethodInfo] = METHODS;

    fn law(&self, params: &IdentifyParams<T>) -> LawKind {
        self.current
            .as_ref()
            .map_or(params.law, |current| current.fit.law)
    }

    fn surface(&self, _noise: &ForceNoise<T>) -> Option<(T, T)> {
        Some(self.current.as_ref()?.surface)
    }

    fn predict(&self, at: &Instant<T>) -> (T, T) {
        let Some(current) = &self.current else {
            return (at.force, T::zero());
        };
        let (force, variance) = current.predict(&Block::of(at));
        if self.trusted || self.tried >= LONG_TRIED {
            return (force, variance);
        }
        let error = at.force - force;
        (force, variance.max_of(error * error))
    }

    fn doubt(&self, _at: &Instant<T>) -> Option<Doubt> {
        let at_bound = self.current.as_ref()?.is_at_bound;
        at_bound.then_some(Doubt::Against(Reason::Bound))
    }

    fn observe(&mut self, at: &Instant<T>, in_contact: bool) {
        self.take(at, false, in_contact);
    }

    fn learn(&mut self, _params: &IdentifyParams<T>, at: &Instant<T>, _beta: T) -> Option<T> {
        self.take(at, true, true);
        self.current.is_some().then(T::one)
    }

    /// Another material has been touched: what the last touch has said already is kept.
    fn reset_covariance(&mut self, params: &IdentifyParams<T>, _since_touch: bool) {
        let learned = self.history.keep_last_touch();
        *self = Self::with_history(params, self.history.clone(), learned);
    }

    fn estimates(&self, _at: &Instant<T>) -> [ParameterEstimate<T>; PARAMETER_SLOTS] {
        let current = self.current.as_ref();
        current.map_or_else(Default::default, |current| current.estimates)
    }
}
