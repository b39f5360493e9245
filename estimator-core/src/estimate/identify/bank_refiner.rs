//! Hunt–Crossley with an unknown surface: a bank to start from, a refiner to be exact, the bank again
//! as its supervisor.
//!
//! All of them learn from pools of eight instants, and a second of contact stays in memory. A refiner
//! whose linearisation is not good enough is succeeded by one that learns from that memory at a
//! better place, three pools a sample, and takes over when it has caught up: nothing that was
//! measured is lost. (Successors that began with an empty head needed 0.5–2.6 s to settle instead of
//! 0.2–0.7 s, and ended 1.5–3 times above the Cramér–Rao bound instead of 1.0–1.3 times.)

use nalgebra::Vector2;

use super::params::IdentifyParams;
use super::slots::{damper, in_slots, spring};
use super::{Bank, ForceNoise, Identify, Instant, Pool, PoolRing, Pooled, Prior, Refiner};
use crate::estimate::method::{Method, MethodInfo, Offer, methods};
use crate::estimate::monitor::ParameterEstimate;
use crate::estimate::record::PARAMETER_SLOTS;
use crate::estimate::rls::Excitation;
use crate::maths::scalar::Real;

/// The grid of surfaces begins this many uncertainties of the impact before it, and reaches two
/// beyond: a force threshold is late, never early.
const SURFACES_BEFORE: f64 = 4.0;
/// Pools between two looks at the bank: solving all its cells costs as much as updating them.
const LOOK_EVERY: u32 = 4;
/// Pools before the refiner starts, and the range of force that they must cover.
const START_POOLS: f64 = 3.0;
const START_RANGE: f64 = 2.0;
/// When the error energy of the refiner is this many times the bank's, the bank starts another.
const WORSE: f64 = 8.0;
/// A successor is started when the linearisation leaves out more than this share of the variance of
/// the filtered noise. Where it cannot learn from all that its predecessor knew, it takes over when
/// its standard errors are within this factor, or three quarters of the samples are its own.
const LINEARIZATION_SHARE: f64 = 0.02;
const LIKE: f64 = 1.5;
/// Pools that a successor catches up with at every sample.
const CATCH_UP: u32 = 3;
/// Forgetting of the bank (2000 samples) and of the refiner (50 000), a pool of 8: the estimates of
/// one material shall only get better; another material clears both.
const BANK_BETA: f64 = 0.996;
const REFINER_BETA: f64 = 0.99984;
/// A window is inside when the depth, less this many standard errors of the surface, squared, is
/// this many times the variance of the position in it: 2.2² = 1/0.2.
const SURELY: f64 = 3.0;
const INSIDE: f64 = 0.2;
/// Prior standard deviation of the skew (s), if it is asked for, and if it is not: no two converters
/// start at once, and on a log where they are 23 µs apart K is off by three of its standard errors if
/// the skew is held at 0. With 10 µs plastic's λ, which a skew imitates, loses its last per cent.
const SKEW_S: f64 = 3e-3;
const ALIGNED_S: f64 = 4e-6;
/// The size that an error of the skew is compared with (s).
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

/// Bank and refiner, scaled: θ = (K, λ, n, x₀) and, if asked for, the skew τ.
#[derive(Clone, Debug)]
pub struct BankRefiner<T: Real> {
    bank: Option<Bank<T>>,
    refiner: Option<Refiner<T>>,
    successor: Option<Successor<T>>,
    std_errors: [T; 5],
    prior: Prior<T>,
    skew_size: T,
    surface_known: bool,
    pool: Pool<T>,
    memory: PoolRing<T>,
    until_look: u32,
    excitation: Excitation<T, 2>,
}

/// A refiner that learns from memory what its predecessor learned live.
#[derive(Clone, Debug)]
struct Successor<T: Real> {
    refiner: Refiner<T>,
    next: u32,
    /// The memory reaches back to the first contact.
    complete: bool,
}

impl<T: Real> BankRefiner<T> {
    /// Before the first contact.
    pub fn new(params: &IdentifyParams<T>) -> Self {
        let skew = match params.method {
            Method::HUNT_CROSSLEY_BANK_SKEW => SKEW_S,
            _ => ALIGNED_S,
        };
        let per_second = params.scale.speed_mps / params.scale.depth_m;
        BankRefiner {
            bank: None,
            refiner: None,
            successor: None,
            std_errors: [T::zero(); 5],
            prior: Prior {
                surface: T::zero(),
                skew: T::from_f64(skew) * per_second,
            },
            skew_size: T::from_f64(SKEW_SIZE_S) * per_second,
            surface_known: params.surface_known,
            pool: Pool::default(),
            memory: PoolRing::default(),
            until_look: 1,
            excitation: Excitation::default(),
        }
    }

    /// Everything learns from a pool.
    fn absorb(&mut self, pooled: &Pooled<T>, at: &Instant<T>) {
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
        self.memory.push(*pooled);
        if let Some(refiner) = &mut self.refiner {
            refiner.learn(pooled, &at.noise, T::from_f64(REFINER_BETA));
            self.std_errors = refiner.std_errors(at.rest_error, &at.noise);
        }
        self.until_look = self.until_look.saturating_sub(1);
        self.relinearize(&at.noise);
    }

    /// Starts from the bank: the first refiner, or one in the place of another that has gone astray.
    fn supervise(&mut self, noise: &ForceNoise<T>) {
        let Some(bank) = &self.bank else { return };
        let (low, high) = bank.span;
        let ready =
            bank.weight >= T::from_f64(START_POOLS) && high > T::from_f64(START_RANGE) * low;
        if !ready || self.successor.is_some() {
            return;
        }
        let Some(candidate) = bank.best() else { return };
        if let Some(refiner) = self.refiner.as_ref().filter(|refiner| refiner.is_sound()) {
            let floor = candidate.residual + noise.filtered * noise.filtered;
            if refiner.energy <= T::from_f64(WORSE) * floor {
                return;
            }
        }
        self.begin(Refiner::new(&candidate, T::zero(), &self.prior));
    }

    /// Starts a refiner at a better place when the present one's linearisation matters.
    fn relinearize(&mut self, noise: &ForceNoise<T>) {
        let Some(refiner) = &self.refiner else { return };
        let tolerated = T::from_f64(LINEARIZATION_SHARE) * noise.filtered * noise.filtered;
        if self.successor.is_none() && refiner.is_sound() && refiner.linearization_error > tolerated
        {
            self.begin(refiner.successor(&self.prior));
        }
    }

    fn begin(&mut self, refiner: Refiner<T>) {
        let next = self.memory.oldest();
        let complete = next == 0;
        self.successor = Some(Successor {
            refiner,
            next,
            complete,
        });
    }

    /// The successor learns from memory, and takes over once it knows what its predecessor does.
    fn catch_up(&mut self, at: &Instant<T>) {
        let Some(successor) = &mut self.successor else {
            return;
        };
        for _ in 0..CATCH_UP {
            if let Some(pooled) = self.memory.get(successor.next) {
                successor
                    .refiner
                    .learn(pooled, &at.noise, T::from_f64(REFINER_BETA));
                successor.next += 1;
            }
        }
        if successor.next < self.memory.pushed() {
            return;
        }
        let knows = match &self.refiner {
            Some(refiner) if refiner.is_sound() && !successor.complete => {
                takes_over(&successor.refiner, refiner)
            }
            _ => true,
        };
        if !successor.refiner.is_sound() {
            self.successor = None;
        } else if knows {
            self.refiner = self.successor.take().map(|successor| successor.refiner);
            if let Some(refiner) = &self.refiner {
                self.std_errors = refiner.std_errors(at.rest_error, &at.noise);
            }
        }
    }
}

fn takes_over<T: Real>(successor: &Refiner<T>, refiner: &Refiner<T>) -> bool {
    let most = successor.learned > T::from_f64(0.75) * refiner.learned;
    most || successor.knows_like(refiner, T::from_f64(LIKE))
}

impl<T: Real> Identify<T> for BankRefiner<T> {
    const METHODS: &'static [MethodInfo] = METHODS;

    fn surface(&self, _noise: &ForceNoise<T>) -> Option<(T, T)> {
        let ([.., position, _], [.., error, _]) =
            (self.refiner.as_ref()?.values(), self.std_errors);
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
        if !self.excitation.admits(&phi, params.excitation_step) {
            return None;
        }
        // One of the three a sample: together they would be the worst step by far.
        if let Some(pooled) = self.pool.take(at) {
            self.absorb(&pooled, at);
        } else if self.until_look == 0 {
            let started = self.refiner.is_some();
            self.until_look = if started { LOOK_EVERY } else { 1 };
            self.supervise(&at.noise);
        } else {
            self.catch_up(at);
        }
        self.refiner.is_some().then_some(T::from_f64(REFINER_BETA))
    }

    fn observe(&mut self, _at: &Instant<T>, _in_contact: bool) {
        self.pool.close();
    }

    fn reset_covariance(&mut self, params: &IdentifyParams<T>) {
        *self = BankRefiner::new(params);
    }

    fn estimates(&self, _at: &Instant<T>) -> [ParameterEstimate<T>; PARAMETER_SLOTS] {
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
        ] = self.std_errors;
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
