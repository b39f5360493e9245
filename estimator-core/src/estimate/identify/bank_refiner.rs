//! Hunt–Crossley with an unknown surface: a bank of fits gives the start, a refiner makes it exact,
//! and the bank supervises the refiner.
//!
//! Both learn from pools of eight instants, and a second of contact stays in memory. A refiner whose
//! linearization is not good enough is succeeded by one that learns from that memory at a better
//! reference, three pools per sample, and takes over when it has caught up, so that nothing that was
//! measured is lost. (Successors that began without the memory needed 0.5–2.6 s to settle instead of
//! 0.2–0.7 s, and ended 1.5–3 times above the Cramér–Rao bound instead of 1.0–1.3 times.)

mod claims;
mod left_out;
mod previous;
mod quarantine;
mod successor;
mod supervision;

use nalgebra::Vector2;

use claims::Claims;
use previous::{Previous, RECONSIDERED};
use quarantine::Quarantine;
use successor::{CHALLENGE_EVERY, REFINER_BETA, Successor};

use super::{Bank, ForceNoise, Identify, Instant, Pool, PoolRing, Pooled, Prior, Refiner};
use super::{params::IdentifyParams, slots::damper, slots::in_slots, slots::spring};
use crate::estimate::method::{Method, MethodInfo, Offer, methods};
use crate::estimate::misfit::Excess;
use crate::estimate::monitor::ParameterEstimate;
use crate::estimate::record::PARAMETER_SLOTS;
use crate::estimate::rls::Excitation;
use crate::estimate::status::{Doubt, Reason};
use crate::maths::scalar::Real;

/// The grid of surfaces begins this many uncertainties of the impact before it, and reaches two
/// beyond: a force threshold is late, never early.
const SURFACES_BEFORE: f64 = 4.0;
/// Pools between two searches of the bank: solving all its cells costs as much as updating them.
const SEARCH_EVERY: u32 = 4;
/// Prior standard deviation of the exponent.
const EXPONENT_PRIOR: f64 = 0.2;
/// Forgetting factor of the bank per pool of 8: a memory of 2000 samples.
const BANK_BETA: f64 = 0.996;
/// The filter's window is inside the material when the variance of the position in it is less than
/// the share `INSIDE` of the square of the depth, less `SURELY` standard errors of the surface: 2.2²
/// = 1/0.2.
const SURELY: f64 = 3.0;
const INSIDE: f64 = 0.2;
/// Prior standard deviation of the skew (s), and what it is taken for where it is not estimated: no two
/// converters start at once, and on a log where they are 23 µs apart K is off by three of its
/// standard errors if the skew is held at 0. With 10 µs λ of plastic, which a skew imitates, loses
/// its last per cent.
const SKEW_S: f64 = 3e-3;
const ALIGNED_S: f64 = 4e-6;
/// What an error of the skew is compared with (s).
const SKEW_SIZE_S: f64 = 1e-3;

methods! {
    /// Hunt–Crossley by a bank of exact fits and a recursive Gauss–Newton refiner, the surface among
    /// the parameters.
    HUNT_CROSSLEY_BANK = 5, HuntCrossley, "bank", "Bank of exact fits and refiner, surface included",
        offer: Offer::Default, finds_surface: true, alpha_1: 0.03;
    /// [`Method::HUNT_CROSSLEY_BANK`] with the skew, by how much the force is read later than the
    /// position, among the parameters.
    HUNT_CROSSLEY_BANK_SKEW = 8, HuntCrossleySkew, "skew",
        "The same with the skew of the sensors, by how much the force is read later",
        finds_surface: true, alpha_1: 0.03;
}

/// Bank and refiner, scaled: θ = (K, λ, n, x₀, τ), where the skew τ is held near 0 unless the method
/// estimates it.
#[derive(Clone, Debug)]
pub struct BankRefiner<T: Real> {
    bank: Option<Bank<T>>,
    refiner: Option<Refiner<T>>,
    /// Whether the refiner began from the material before, on a range of force that tells little.
    began_early: bool,
    successor: Option<Successor<T>>,
    claims: Claims<T>,
    prior: Prior<T>,
    skew_size: T,
    surface_known: bool,
    pool: Pool<T>,
    memory: PoolRing<T>,
    /// The pool that the bank takes at the next sample.
    for_bank: Option<Pooled<T>>,
    until_search: u32,
    /// Number of pools at which the next challenger starts, and until which the last one that won raises
    /// doubt.
    next_challenge: u32,
    doubted_until: u32,
    /// Whether the last instant moved, so that it was learned from.
    moves: bool,
    quarantine: Quarantine<T>,
    previous: Option<Previous<T>>,
    /// Whether they have come back, and that has not been asked yet.
    came_back: bool,
    excitation: Excitation<T, 2>,
}

impl<T: Real> BankRefiner<T> {
    /// The estimator before the first contact.
    pub fn new(params: &IdentifyParams<T>) -> Self {
        let estimates_skew = params.method == Method::HUNT_CROSSLEY_BANK_SKEW;
        let per_second = params.scale.speed_mps / params.scale.depth_m;
        BankRefiner {
            bank: None,
            refiner: None,
            began_early: false,
            successor: None,
            claims: Claims::default(),
            prior: Prior {
                surface: T::zero(),
                exponent: T::from_f64(EXPONENT_PRIOR),
                skew: T::from_f64(SKEW_S) * per_second,
                aligned: (!estimates_skew).then(|| T::from_f64(ALIGNED_S) * per_second),
                speed_rounding: params.speed_rounding,
            },
            skew_size: T::from_f64(SKEW_SIZE_S) * per_second,
            surface_known: params.surface_known,
            pool: Pool::default(),
            memory: PoolRing::default(),
            for_bank: None,
            until_search: 1,
            next_challenge: CHALLENGE_EVERY,
            doubted_until: 0,
            moves: false,
            quarantine: Quarantine::default(),
            previous: None,
            came_back: false,
            excitation: Excitation::default(),
        }
    }

    /// Takes a pool. Once there are estimates to lose, it waits until enough others have followed: what a
    /// change of material or a fault has reached is dropped before it is learned.
    /// A hold repeats one equation and is not learned from, but its residuals count: they show what
    /// relaxes or drifts.
    fn take_pool(&mut self, pooled: &Pooled<T>, moved: bool, at: &Instant<T>) {
        if !moved {
            if let Some(refiner) = &mut self.refiner {
                refiner.observe(pooled, &at.noise);
            }
            return;
        }
        self.reconsider(pooled, at);
        if self.refiner.is_none() {
            self.absorb(pooled, at);
        } else if let Some(waited) = self.quarantine.push(*pooled) {
            self.absorb(&waited, at);
        }
    }

    /// Goes back to the estimates before a change that was none: a fault that has passed, and not
    /// another material.
    fn reconsider(&mut self, pooled: &Pooled<T>, at: &Instant<T>) {
        let Some(previous) = &mut self.previous else {
            return;
        };
        let since = self.refiner.as_ref().filter(|_| !self.claims.is_stale);
        let since = since.map(|refiner| (refiner, &self.claims));
        if let Some((shift, error)) = previous.agrees_with(pooled, &at.noise, since) {
            previous.refiner.shift_surface(shift, error);
            self.refiner = Some(previous.refiner.clone());
            self.claims = previous.claims.clone();
            self.previous = None;
            self.came_back = true;
            self.bank = None;
            self.began_early = false;
            self.successor = None;
            // What they have learned is not in memory: a successor that took it for all there is threw away at the
            // next touch what had just come back.
            self.memory.clear();
            self.next_challenge = self.memory.pushed().saturating_add(CHALLENGE_EVERY);
            self.quarantine = Quarantine::default();
        } else if self.memory.pushed() > RECONSIDERED {
            self.previous = None;
        }
    }

    /// A pool that waited before a change of material, and is of the material since.
    fn of_new_material(&mut self) -> Option<Pooled<T>> {
        match self.refiner {
            Some(_) => None,
            None => self.quarantine.take_oldest(),
        }
    }

    /// The refiner learns from a pool; the bank takes it at the next sample, so that no sample pays for both.
    fn absorb(&mut self, pooled: &Pooled<T>, at: &Instant<T>) {
        self.memory.push(*pooled);
        if let Some(refiner) = &mut self.refiner {
            refiner.learn(pooled, &at.noise, T::from_f64(REFINER_BETA));
        }
        self.for_bank = Some(*pooled);
    }

    /// The bank learns from a pool that the refiner has taken, and what it says is looked at again. A pool
    /// that another has overtaken, as short ones do, is left out.
    fn take_into_bank(&mut self, pooled: &Pooled<T>, at: &Instant<T>) {
        let bank = self.bank.get_or_insert_with(|| {
            let step = if self.surface_known {
                T::zero()
            } else {
                at.surface_error
            };
            Bank::new(at.surface - T::from_f64(SURFACES_BEFORE) * step, step)
        });
        bank.update(
            pooled.position,
            pooled.speed,
            pooled.force,
            T::from_f64(BANK_BETA),
        );
        self.prior.surface = at.surface_error.max_of(bank.surface_step);
        if let Some(refiner) = &self.refiner {
            match self.memory.pushed().is_multiple_of(2) {
                true => self.claims.renew_errors(refiner, at),
                false => self.claims.renew_doubt(refiner),
            }
        }
        self.until_search = self.until_search.saturating_sub(1);
        self.relinearize(&at.noise);
        self.challenge();
    }
}

impl<T: Real> Identify<T> for BankRefiner<T> {
    const METHODS: &'static [MethodInfo] = METHODS;

    fn surface(&self, _noise: &ForceNoise<T>) -> Option<(T, T)> {
        let ([.., position, _], [.., error, _]) =
            (self.refiner.as_ref()?.values(), self.claims.std_errors);
        Some((position, error))
    }

    /// The window of a steady motion reaches 2.1 standard deviations of the position to either side.
    fn is_inside(&self, at: &Instant<T>) -> bool {
        let Some((surface, error)) = self.surface(&at.noise) else {
            return false;
        };
        let depth = at.position() - surface - T::from_f64(SURELY) * error;
        depth > T::zero()
            && at.position_variance > T::zero()
            && at.position_variance < T::from_f64(INSIDE) * depth * depth
    }

    fn predict(&self, at: &Instant<T>) -> (T, T) {
        match &self.refiner {
            Some(refiner) => refiner.predict(&Pooled::of(at)),
            None => (at.force, T::zero()),
        }
    }

    fn learn(&mut self, params: &IdentifyParams<T>, at: &Instant<T>, _beta: T) -> Option<T> {
        let phi = Vector2::new(at.depth, at.speed);
        let moves = self.excitation.admits(&phi, params.excitation_step);
        let moved = core::mem::replace(&mut self.moves, moves);
        if moves != moved {
            self.pool.close();
        }
        let pooled = self.pool.take(at);
        let outdated = self.refiner.as_ref().filter(|_| self.claims.is_stale);
        // One of the five per sample: together they would make the longest step by far.
        if let Some(pooled) = &pooled {
            self.take_pool(pooled, moved, at);
        } else if let Some(pooled) = self.for_bank.take() {
            self.take_into_bank(&pooled, at);
        } else if !moves {
            return None;
        } else if let Some(refiner) = outdated {
            self.claims.renew(refiner, at);
        } else if let Some(pooled) = self.of_new_material() {
            self.absorb(&pooled, at);
        } else if self.until_search == 0 {
            let started = self.refiner.is_some();
            self.until_search = if started { SEARCH_EVERY } else { 1 };
            self.supervise(&at.noise);
        } else {
            self.catch_up(&at.noise);
        }
        if !moves {
            return None;
        }
        self.refiner.is_some().then_some(T::from_f64(REFINER_BETA))
    }

    fn excess(&self) -> Option<Excess<T>> {
        self.refiner.as_ref().map(|_| self.claims.excess)
    }

    fn doubt(&self, _at: &Instant<T>) -> Option<Doubt> {
        if self.memory.pushed() < self.doubted_until {
            return Some(Doubt::Against(Reason::Residual));
        }
        (self.claims.doubt).or(self
            .lacks_range()
            .then_some(Doubt::NotYetRuledOut(Reason::Excitation)))
    }

    fn observe(&mut self, _at: &Instant<T>, _in_contact: bool) {
        self.pool.close();
    }

    fn reset_covariance(&mut self, params: &IdentifyParams<T>, since_touch: bool) {
        let refiner = self.refiner.take();
        let previous = refiner.map(|refiner| Previous::new(refiner, self.claims.clone()));
        // The eight samples or less in the pool that is not complete are of the material since: a change is noticed
        // three pools after it, the filter's window is two long. What waited is dropped, unless it is of it, too.
        let pool = core::mem::take(&mut self.pool);
        let mut quarantine = core::mem::take(&mut self.quarantine);
        quarantine.keep_last_touch();
        *self = BankRefiner::new(params);
        self.pool = pool;
        if since_touch {
            self.quarantine = quarantine;
        }
        self.previous = previous;
    }

    fn has_come_back(&mut self) -> bool {
        core::mem::take(&mut self.came_back)
    }

    fn estimates(&self, at: &Instant<T>) -> [ParameterEstimate<T>; PARAMETER_SLOTS] {
        let Some(refiner) = &self.refiner else {
            return [ParameterEstimate::default(); PARAMETER_SLOTS];
        };
        let [stiffness, damping, exponent, _, skew] = refiner.values();
        let exponent = (exponent, T::one());
        let [
            stiffness_error,
            damping_error,
            exponent_error,
            _,
            skew_error,
        ] = self.claims.std_errors;
        // A speed that is too large by a share makes the damping too small by it.
        let of_speed = at.speed_error * damping;
        let damping_error = (damping_error * damping_error + of_speed * of_speed).sqrt();
        let values = [
            spring(stiffness),
            damper(damping, stiffness),
            exponent,
            (skew, self.skew_size),
        ];
        let errors = [stiffness_error, damping_error, exponent_error, skew_error];
        in_slots(&values, errors.iter())
    }
}
