//! Laws with memory, and the choice among laws, from a history that is fitted again and again.
//!
//! What relaxes remembers: a filter that starts anew at a better reference does not know what the
//! material went through, and a press that is followed by a hold is the only thing that ever tells
//! the exponent. So the recent past is kept, condensed ([`course`]), and Gauss–Newton passes over it,
//! two blocks a sample, at ever better references ([`fit`]); what leaves the history stays as a
//! covariance and a memory (`anchor`). A bank of exact fits says where to start ([`bank`]). Each pass
//! measures what its reference costs exactly, so that a step that made it worse is halved.
//!
//! A method that has several laws to choose from gives each its turn; a law takes over when the
//! criterion of Bayes speaks for it (Schwarz 1978).

mod bank;
mod course;
mod fit;

use bank::Bank;
use course::{BLOCKS, Block, Course};
use fit::{DAMPING, EXPONENT, Fit, MODES, Memory, STIFFNESS, SURFACE, Theta, modes, predict};

use super::kelvin_voigt::size;
use super::params::{IdentifyParams, SPEED_PER_DEPTH};
use super::{ForceNoise, Identify, Instant};
use crate::estimate::contact::SurfacePosition;
use crate::estimate::method::Method;
use crate::estimate::monitor::ParameterEstimate;
use crate::estimate::record::PARAMETER_SLOTS;
use crate::maths::scalar::Real;
use crate::physics::law::LawKind;

/// The grid of surfaces begins this many uncertainties of the impact before it, and reaches two
/// beyond: a force threshold is late, never early.
const SURFACES_BEFORE: f64 = 4.0;
/// Blocks that a pass takes at one sample.
const BLOCKS_PER_SAMPLE: u32 = 2;
/// Blocks over which the passes go; the rest of the course waits for its anchors.
const KEPT: u32 = BLOCKS as u32 - 8;
/// Blocks to learn from before the first pass, and the range of force that they must cover.
const FIRST_PASS: u32 = 5;
const FIRST_RANGE: f64 = 2.0;
/// A pass is published when it has moved by less than this many standard errors,
const NEAR: f64 = 1.0;
/// and has converged when by less than this: the next one waits for news.
const CONVERGED: f64 = 0.1;
/// Standard errors over the size of what is known.
const KNOWN: f64 = 0.05;
/// After this many passes an estimate that is still not good will not become so.
const LONG_TRIED: u32 = 100;
/// News: this share of the blocks.
const NEWS: f64 = 0.1;
/// A reference may cost this much more than the one before it (the data grow), and this share.
const WORSE: f64 = 0.3;
const WORSE_SHARE: f64 = 1.2;
/// over data that have not grown by more than this.
const GROWN: f64 = 1.03;
/// A fit whose errors are this many times their variance is bad, and starts anew after some passes.
const BAD: f64 = 4.0;
const PATIENCE: u32 = 8;
/// By how much the criterion must speak for another law: 10 is very strong (Kass & Raftery 1995).
const MARGIN: f64 = 10.0;
/// Passes of one mode after which two are tried.
const ONE_MODE_FIRST: u32 = 3;
/// Where two modes start from one: factors on its rate, each fast one with each slow one.
const FASTER: [f64; 3] = [1.5, 4.0, 12.0];
const SLOWER: [f64; 3] = [0.7, 0.3, 0.1];
/// Forgetting of what left the history (6000 blocks, 50 000 samples).
const ANCHOR_BETA: f64 = 0.99984;

/// Laws that a method chooses from, the simplest first.
fn laws(method: Method) -> &'static [LawKind] {
    match method {
        Method::ZenerBank => &[LawKind::Zener],
        Method::QuasiLinearBank2 => &[LawKind::QuasiLinear, LawKind::QuasiLinear2],
        Method::Selection => &[
            LawKind::KelvinVoigt,
            LawKind::HuntCrossley,
            LawKind::Zener,
            LawKind::QuasiLinear,
        ],
        _ => &[LawKind::QuasiLinear],
    }
}

const MOST_LAWS: usize = 4;

/// A law and where its passes stand.
#[derive(Clone, Debug)]
struct Contender<T: Real> {
    law: LawKind,
    /// What is known of the blocks that have left the history, and the memory at its beginning.
    anchor: Fit<T>,
    /// The last reference that was accepted and what it costs at best; `None`: starts anew.
    accepted: Option<(Theta<T>, T)>,
    /// The next reference.
    proposed: Theta<T>,
    rejected: u32,
    /// Passes since it started anew, and how often it did.
    passes: u32,
    starts: u32,
    /// Number of the block at which it last finished a pass.
    finished: u32,
    /// Blocks that the accepted reference was compared over.
    compared: T,
    /// The start that is being tried, where there are several, and the best so far with its cost.
    origin: Theta<T>,
    trial: usize,
    tried: Option<(Theta<T>, T)>,
    /// Its parameters are known well enough for a gradient to hold.
    straight: bool,
    /// The last step in standard errors, what was left, and how many blocks it was over.
    step: T,
    left: T,
    blocks: T,
}

impl<T: Real> Contender<T> {
    fn new(law: LawKind) -> Self {
        Contender {
            law,
            anchor: Fit::new(law, &Theta::repeat(T::one()), T::zero()),
            accepted: None,
            proposed: Theta::repeat(T::zero()),
            rejected: 0,
            passes: 0,
            starts: 0,
            finished: 0,
            straight: false,
            compared: T::zero(),
            origin: Theta::repeat(T::zero()),
            trial: 0,
            tried: None,
            step: T::from_f64(1e9),
            left: T::from_f64(1e9),
            blocks: T::zero(),
        }
    }

    /// A block leaves the history.
    fn let_go(
        &mut self,
        block: &Block<T>,
        noise_raw: T,
        surface_error: T,
        simpler: Option<&Theta<T>>,
    ) {
        let good = self.accepted.is_some() && self.left < T::from_f64(BAD);
        if self.accepted.is_some() {
            self.anchor = self.anchor.again(self.law, &self.proposed, surface_error);
        } else if let Some(simpler) = simpler {
            let start = split(simpler, FASTER.len() + 1);
            self.anchor = self.anchor.again(self.law, &start, surface_error);
        }
        if good && self.straight && self.step < T::from_f64(NEAR) {
            self.anchor
                .absorb(block, noise_raw, T::from_f64(ANCHOR_BETA));
        } else {
            self.anchor.pass(block);
        }
    }

    fn converged(&self) -> bool {
        self.accepted.is_some() && self.step < T::from_f64(CONVERGED)
    }

    /// Whether a reference is no worse than the one before, by what it costs at best; else the next
    /// one is halfway. Costs over other data cannot be compared: there every reference is accepted.
    fn accepts(&mut self, pass: &Fit<T>) -> bool {
        let (cost, blocks) = (pass.left(), pass.blocks());
        let grown = blocks > T::from_f64(GROWN) * self.compared;
        let worse = match self.accepted {
            Some((_, before)) if !grown => {
                cost > T::from_f64(WORSE_SHARE) * before + T::from_f64(WORSE)
            }
            _ => false,
        };
        if pass.is_sound() && (!worse || self.rejected >= 3) {
            self.rejected = 0;
            self.accepted = Some((pass.reference(), cost));
            self.compared = blocks;
            return true;
        }
        self.rejected += 1;
        match self.accepted {
            Some((reference, _)) => {
                self.proposed = (reference + self.proposed) * T::from_f64(0.5);
            }
            None => self.passes = PATIENCE,
        }
        false
    }

    /// Whether it is looking for a start among several.
    fn is_trying(&self) -> bool {
        self.law == LawKind::QuasiLinear2 && self.accepted.is_none()
    }

    /// Takes the cost of a start; after the last one, the best is the next reference.
    fn tried(&mut self, pass: &Fit<T>) {
        let cost = pass.left();
        let better = self.tried.is_none_or(|(_, kept)| cost < kept);
        if pass.is_sound() && better {
            self.tried = Some((pass.reference(), cost));
        }
        self.trial += 1;
        if self.trial >= FASTER.len() * SLOWER.len() {
            self.accepted = self.tried;
            self.compared = T::zero();
            if let Some((reference, _)) = self.tried {
                self.proposed = reference;
            }
            self.trial = 0;
            self.tried = None;
        }
    }

    /// Takes a finished pass over all parameters.
    fn finish(&mut self, pass: &Fit<T>, surface_error: T) {
        self.finished = pass.next();
        self.passes = self.passes.saturating_add(1);
        if pass.is_sound() {
            self.proposed = pass.stepped(surface_error);
            self.step = pass.step();
            self.straight = pass.is_straight();
            self.left = pass.left();
            self.blocks = pass.blocks();
        } else {
            self.accepted = None;
            self.step = T::from_f64(1e9);
        }
    }

    /// Schwarz's criterion: n·ln(left) + p·ln n.
    fn criterion(&self) -> T {
        let floor = T::from_f64(0.1).max_of(self.left);
        let count = self.blocks.max_of(T::one());
        let parameters = T::from_f64(fit::parameters(self.law) as f64);
        count * floor.ln() + parameters * count.ln()
    }
}

/// Bank, history and passes, scaled.
#[derive(Clone, Debug)]
pub struct HistoryFit<T: Real> {
    course: Course<T>,
    bank: Option<Bank<T>>,
    current: Option<Fit<T>>,
    /// The pass that is under way; whether it is over K, λ and B alone.
    pass: Option<Fit<T>>,
    projects: bool,
    contenders: [Option<Contender<T>>; MOST_LAWS],
    turn: usize,
    champion: usize,
    /// The first impact and its standard error.
    impact: Option<(T, T)>,
    /// Blocks that were learned from, and passes that were finished.
    learned: u32,
    passes: u32,
    /// The estimate has once been good, or nothing good could be found: from here on an error of the
    /// prediction is one of the law or a change of material, and not of an estimate still under way.
    judges: bool,
    /// The bank was searched at this sample.
    busy: bool,
    /// The memory of `current` at this sample.
    live: Memory<T>,
    estimates: [ParameterEstimate<T>; PARAMETER_SLOTS],
    /// Surface of the estimate and its standard error.
    found: Option<(T, T)>,
}

impl<T: Real> HistoryFit<T> {
    /// Before the first contact.
    pub fn new(params: &IdentifyParams<T>) -> Self {
        let mut contenders = [const { None }; MOST_LAWS];
        for (slot, law) in contenders.iter_mut().zip(laws(params.method)) {
            *slot = Some(Contender::new(*law));
        }
        HistoryFit {
            course: Course::new(),
            bank: None,
            current: None,
            pass: None,
            projects: false,
            contenders,
            turn: 0,
            champion: 0,
            impact: None,
            learned: 0,
            passes: 0,
            judges: false,
            busy: false,
            live: Memory::default(),
            estimates: [ParameterEstimate::default(); PARAMETER_SLOTS],
            found: None,
        }
    }

    /// The law of the estimate, once there is one.
    pub fn law(&self) -> Option<LawKind> {
        self.current.as_ref().map(Fit::law)
    }

    /// The surface (m) with its standard error, once there is an estimate.
    pub fn surface(&self, params: &IdentifyParams<T>) -> Option<SurfacePosition<T>> {
        let (position, error) = self.found?;
        Some(SurfacePosition {
            position_m: position * params.scale.depth_m,
            std_error_m: error * params.scale.depth_m,
        })
    }

    /// Where the material begins and how far that is off: as estimated, else the first impact.
    fn surface_found(&self) -> Option<(T, T)> {
        let error = self.impact?.1;
        match &self.current {
            Some(current) => Some((current.values()[SURFACE], error)),
            None => self.impact,
        }
    }

    /// Takes every instant, in contact or not.
    pub fn follow(&mut self, at: &Instant<T>, noise: &ForceNoise<T>, usable: bool, touching: bool) {
        if touching {
            self.impact.get_or_insert((at.surface, at.surface_error));
        }
        let depth = self
            .surface_found()
            .map(|(surface, error)| (at.position() - surface, error));
        if let Some(block) = self.course.follow(at, depth, usable, touching) {
            // Bank and passes wait: no sample pays for everything.
            self.take(&block, at, noise);
            return;
        }
        if let Some(current) = &self.current {
            let block = Block::of(at);
            let law = current.law();
            self.live = predict(&current.values(), law, &self.live, &block).memory;
        }
        let ends = |pass: &Fit<T>| pass.next() >= self.course.next();
        if self.pass.as_ref().is_some_and(ends) {
            self.finish();
        } else if !self.let_go(noise) {
            self.feed_bank();
            self.work(noise);
        }
    }

    /// A block has ended.
    fn take(&mut self, block: &Block<T>, at: &Instant<T>, noise: &ForceNoise<T>) {
        self.course.push(*block);
        if let Some(current) = &mut self.current {
            current.absorb(block, noise.raw, T::one());
            if !current.is_sound() {
                self.current = None;
            }
        }
        if block.count > T::zero() {
            self.learned = self.learned.saturating_add(1);
            if self.bank.is_none() {
                let step = at.surface_error;
                let first = at.surface - T::from_f64(SURFACES_BEFORE) * step;
                let linear = self
                    .contenders
                    .iter()
                    .flatten()
                    .all(|contender| contender.law == LawKind::Zener);
                self.bank = Some(Bank::new(first, step, linear, self.course.oldest()));
            }
        }
        self.refresh();
    }

    /// The oldest block leaves the history, for one law at a time; whether one was due.
    fn let_go(&mut self, noise: &ForceNoise<T>) -> bool {
        let surface_error = self.bank.as_ref().map_or(T::zero(), Bank::surface_step);
        let simpler = self.simplest();
        let due = self.course.next().saturating_sub(KEPT);
        for contender in self.contenders.iter_mut().flatten() {
            let number = contender.anchor.next();
            if number >= due {
                continue;
            }
            if let Some(block) = self.course.get(number) {
                contender.let_go(block, noise.raw, surface_error, simpler.as_ref());
            } else {
                contender.anchor.starts_at(self.course.oldest());
            }
            return true;
        }
        false
    }

    /// Where the simplest law stands, once it has made some passes.
    fn simplest(&self) -> Option<Theta<T>> {
        let one = self.contenders.first()?.as_ref()?;
        (one.passes >= ONE_MODE_FIRST || one.converged()).then_some(one.proposed)
    }

    fn feed_bank(&mut self) {
        self.busy = false;
        let Some(bank) = &mut self.bank else { return };
        let lost = |own: &Contender<T>| own.accepted.is_none() || own.left > T::from_f64(BAD);
        let searches = self.contenders.iter().flatten().any(lost);
        if let Some(block) = self.course.get(bank.next()) {
            bank.take(block, searches);
            self.busy = searches;
        }
    }

    fn work(&mut self, noise: &ForceNoise<T>) {
        let Some(pass) = &mut self.pass else {
            self.begin();
            return;
        };
        // Searching the bank costs as much as a block.
        let blocks = if self.busy { 1 } else { BLOCKS_PER_SAMPLE };
        for taken in 0..blocks {
            match self.course.get(pass.next()) {
                Some(block) => pass.absorb(block, noise.raw, T::one()),
                None if taken > 0 => return,
                // Overtaken by the end of the history.
                None => {
                    self.pass = None;
                    return;
                }
            }
        }
    }

    /// Starts a pass of the contender whose turn it is, if there is something for it to find.
    fn begin(&mut self) {
        let Some(bank) = &self.bank else { return };
        let (low, high) = bank.span();
        if self.learned < FIRST_PASS || high < T::from_f64(FIRST_RANGE) * low {
            return;
        }
        let trying = self
            .contenders
            .get(self.turn)
            .and_then(Option::as_ref)
            .is_some_and(|own| own.is_trying() && own.trial > 0);
        if !trying {
            let laws = self.contenders.iter().flatten().count().max(1);
            self.turn = (self.turn + 1) % laws;
        }
        let simpler = self.simplest();
        let Some(Some(contender)) = self.contenders.get_mut(self.turn) else {
            return;
        };
        let news = T::from_f64(f64::from(
            self.course.next().saturating_sub(contender.finished),
        ));
        let waits = contender.converged() && news < T::from_f64(NEWS) * contender.blocks;
        if waits && contender.left < T::from_f64(BAD) {
            return;
        }
        let bad = contender.left > T::from_f64(BAD) && contender.passes >= PATIENCE;
        if bad {
            contender.accepted = None;
        }
        if contender.is_trying() {
            let Some(one) = simpler else { return };
            if contender.trial == 0 {
                contender.passes = 0;
                contender.origin = if bad && contender.starts % 2 == 1 {
                    contender.proposed
                } else {
                    one
                };
                contender.starts = contender.starts.wrapping_add(1);
            }
            contender.proposed = split(&contender.origin, contender.trial);
        } else if contender.accepted.is_none() {
            let linear = matches!(contender.law, LawKind::Zener | LawKind::KelvinVoigt);
            let Some(start) = bank.found(linear) else {
                return;
            };
            contender.proposed = start;
            contender.passes = 0;
            contender.starts = contender.starts.wrapping_add(1);
        }
        // What has left the history is known for all parameters together.
        let own = contender.anchor.is_informed() && !contender.is_trying();
        self.projects = !own;
        self.pass = Some(if own {
            contender
                .anchor
                .again(contender.law, &contender.proposed, bank.surface_step())
        } else {
            contender
                .anchor
                .projected(contender.law, &contender.proposed)
        });
    }

    /// A pass has come to the newest block.
    fn finish(&mut self) {
        let Some(pass) = self.pass.take() else { return };
        let surface_error = self.bank.as_ref().map_or(T::zero(), Bank::surface_step);
        let Some(Some(contender)) = self.contenders.get_mut(self.turn) else {
            return;
        };
        if self.projects {
            if contender.is_trying() {
                contender.tried(&pass);
            } else if contender.accepts(&pass) {
                self.projects = false;
                self.pass = Some(contender.anchor.again(
                    contender.law,
                    &pass.values(),
                    surface_error,
                ));
            }
            return;
        }
        contender.finish(&pass, surface_error);
        self.passes = self.passes.saturating_add(1);
        if !pass.is_sound() {
            return;
        }
        if contender.accepted.is_none() {
            contender.accepted = Some((pass.reference(), pass.cost()));
        }
        let (step, passes, criterion) = (contender.step, contender.passes, contender.criterion());
        let champion = self.contenders.get(self.champion).and_then(Option::as_ref);
        let near = step < T::from_f64(NEAR);
        let takes = match (&self.current, champion) {
            (None, _) | (_, None) => near || passes >= PATIENCE / 2,
            (Some(current), _) if self.turn == self.champion => {
                near || pass.left() < T::from_f64(0.7) * current.left()
            }
            (Some(_), Some(champion)) => {
                let margin = if self.turn > self.champion {
                    T::from_f64(MARGIN)
                } else {
                    T::zero()
                };
                near && criterion + margin < champion.criterion()
            }
        };
        let good = near && pass.left() < T::from_f64(BAD);
        if takes {
            self.champion = self.turn;
            self.current = Some(pass);
            self.refresh();
            self.judges |= good && self.knows();
        }
    }

    /// Every parameter to a few percent; or enough has been tried.
    fn knows(&self) -> bool {
        let known = |estimates: &ParameterEstimate<T>| {
            estimates.std_error <= T::from_f64(KNOWN) * estimates.scale
        };
        self.estimates.iter().all(known)
    }

    /// After `current` has changed.
    fn refresh(&mut self) {
        let Some(current) = &self.current else {
            self.estimates = [ParameterEstimate::default(); PARAMETER_SLOTS];
            self.found = None;
            return;
        };
        self.estimates = estimates(current);
        self.found = Some((current.values()[SURFACE], current.std_errors()[SURFACE]));
        self.live = current.memory();
        // From the end of the last block to this sample.
        if let Some(open) = self.course.open() {
            let law = current.law();
            self.live = predict(&current.values(), law, &self.live, &open).memory;
        }
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

/// The parameters of the law with their standard errors, in the order of its slots.
fn estimates<T: Real>(fit: &Fit<T>) -> [ParameterEstimate<T>; PARAMETER_SLOTS] {
    let theta = fit.values();
    let stiffness = theta[STIFFNESS];
    let unit = |slot: usize| {
        let mut gradient = Theta::repeat(T::zero());
        if let Some(own) = gradient.get_mut(slot) {
            *own = T::one();
        }
        gradient
    };
    let mut estimates = [ParameterEstimate::default(); PARAMETER_SLOTS];
    let mut put = |index: usize, value: T, gradient: &Theta<T>, scale: T| {
        if let Some(slot) = estimates.get_mut(index) {
            *slot = ParameterEstimate {
                value,
                std_error: fit.variance(gradient).sqrt(),
                scale,
            };
        }
    };
    put(0, stiffness, &unit(STIFFNESS), size(stiffness, stiffness));
    match fit.law() {
        LawKind::KelvinVoigt | LawKind::HuntCrossley => {
            let damping = theta[DAMPING];
            put(1, damping, &unit(DAMPING), size(damping, stiffness));
            put(2, theta[EXPONENT], &unit(EXPONENT), T::one());
        }
        LawKind::Zener => {
            let (relaxing, log_rate) = MODES[0];
            let (share, rate) = (theta[relaxing] / stiffness, theta[log_rate].exp());
            // c = κ₁/(κ₁ + κ₂): κ₂ = κ₁²/B − κ₁, λ = κ₁²/(Bν).
            let second = stiffness / share - stiffness;
            let mut gradient = unit(STIFFNESS) * (T::from_f64(2.0) / share - T::one());
            gradient[relaxing] = -(T::one() / (share * share));
            put(1, second, &gradient, size(second, stiffness));
            let damping = stiffness / (share * rate) * T::from_f64(SPEED_PER_DEPTH);
            let mut gradient = unit(STIFFNESS) * (T::from_f64(2.0) * damping / stiffness);
            gradient[relaxing] = -(damping / theta[relaxing]);
            gradient[log_rate] = -damping;
            put(2, damping, &gradient, size(damping, stiffness));
        }
        law => {
            put(1, theta[EXPONENT], &unit(EXPONENT), T::one());
            // Fast to slow.
            let mut order = MODES;
            if modes(law) == 2 && theta[MODES[0].1] < theta[MODES[1].1] {
                order.reverse();
            }
            for (index, (relaxing, log_rate)) in order.into_iter().take(modes(law)).enumerate() {
                let (rate, share) = (theta[log_rate].exp(), theta[relaxing] / stiffness);
                let of_share = (unit(relaxing) - unit(STIFFNESS) * share) / stiffness;
                put(2 + 2 * index, share, &of_share, T::one());
                put(3 + 2 * index, rate, &(unit(log_rate) * rate), rate);
            }
        }
    }
    estimates
}

impl<T: Real> Identify<T> for HistoryFit<T> {
    fn predict(&self, at: &Instant<T>, _noise: &ForceNoise<T>, _surface_error: T) -> (T, T) {
        let Some(current) = &self.current else {
            return (at.force, T::zero());
        };
        let law = current.law();
        let predicted = predict(&current.values(), law, &self.live, &Block::of(at));
        let variance = current.variance(&predicted.gradient);
        // A material that has not recovered is not there yet: it does not pull.
        let force = T::zero().max_of(predicted.force);
        if self.judges || self.passes >= LONG_TRIED {
            return (force, variance);
        }
        let error = at.force - force;
        (force, variance.max_of(error * error))
    }

    fn learn(
        &mut self,
        _params: &IdentifyParams<T>,
        _at: &Instant<T>,
        _noise: &ForceNoise<T>,
        _beta: T,
    ) -> Option<T> {
        // Learning is done in `follow`, which sees every instant.
        self.current.is_some().then(T::one)
    }

    fn reset_covariance(&mut self, params: &IdentifyParams<T>) {
        // Another material has been touched: what this touch has said already holds.
        let mut anew = HistoryFit::new(params);
        anew.learned = self.course.keep_last_touch();
        anew.course = self.course.clone();
        let first = anew.course.oldest();
        for contender in anew.contenders.iter_mut().flatten() {
            contender.anchor.starts_at(first);
        }
        *self = anew;
    }

    fn estimates(
        &self,
        _noise: &ForceNoise<T>,
        _surface_error: T,
    ) -> [ParameterEstimate<T>; PARAMETER_SLOTS] {
        self.estimates
    }
}
