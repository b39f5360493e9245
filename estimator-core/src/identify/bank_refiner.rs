//! Hunt–Crossley with an unknown surface: a bank to start from, a refiner to be exact, the bank again
//! as its supervisor.

use nalgebra::Vector2;

use super::kelvin_voigt::{damper, judged, spring};
use super::{Bank, ForceNoise, Identify, Instant, Refiner};
use crate::config::Params;
use crate::contact::SurfacePosition;
use crate::estimate::PARAMETER_SLOTS;
use crate::rls::Excitation;
use crate::scalar::Real;
use crate::status::Judged;

/// The grid of surfaces begins this many uncertainties of the impact before it, and reaches two
/// beyond: a force threshold is late, never early.
const SURFACES_BEFORE: f64 = 4.0;
/// Samples between two looks at the bank: solving all its cells costs as much as updating them.
const LOOK_EVERY: u32 = 8;
/// Samples before the refiner starts, and the range of force that they must cover.
const START_SAMPLES: f64 = 24.0;
const START_RANGE: f64 = 2.0;
/// When the error energy of a refiner that has had this many samples is this many times the bank's,
/// the bank starts another: in its place while it is young, as its successor once it has settled.
const WORSE: f64 = 8.0;
const PATIENCE: u32 = 128;
const SETTLED: u32 = 300;
/// A successor is started when the linearisation leaves out more than this share of the variance of
/// the filtered noise, from this many samples on; it takes over when its standard errors are within
/// this factor of its predecessor's, or three quarters of the samples are its own.
const BEND: f64 = 0.02;
const FIRST_SUCCESSOR: u32 = 32;
const LIKE: f64 = 1.5;
/// Forgetting of the bank (2000 samples) and of the refiner (50 000): the estimates of one material
/// shall only get better; another material clears both.
const BANK_BETA: f64 = 0.9995;
const REFINER_BETA: f64 = 0.99998;

/// Bank and refiner, scaled: θ = (K, λ, n, x₀).
#[derive(Clone, Debug)]
pub struct BankRefiner<T: Real> {
    bank: Option<Bank<T>>,
    refiner: Option<Refiner<T>>,
    successor: Option<Refiner<T>>,
    until_look: u32,
    excitation: Excitation<T, 2>,
}

impl<T: Real> BankRefiner<T> {
    /// Before the first contact.
    pub fn new() -> Self {
        BankRefiner {
            bank: None,
            refiner: None,
            successor: None,
            until_look: LOOK_EVERY,
            excitation: Excitation::default(),
        }
    }

    /// The surface (m) with its standard error, once the refiner runs.
    pub fn surface(&self, params: &Params<T>) -> Option<SurfacePosition<T>> {
        let refiner = self.refiner.as_ref()?;
        let ([_, _, _, value], [_, _, _, error]) = (refiner.values(), refiner.std_errors());
        Some(SurfacePosition {
            position_m: value * params.scale.depth_m,
            std_error_m: error * params.scale.depth_m,
        })
    }

    fn supervise(&mut self, noise: &ForceNoise<T>) {
        let Some(bank) = &self.bank else { return };
        let (low, high) = bank.span();
        let ready =
            bank.weight() >= T::from_f64(START_SAMPLES) && high > T::from_f64(START_RANGE) * low;
        if !ready {
            return;
        }
        let Some(candidate) = bank.best() else { return };
        let started = || Some(Refiner::new(&candidate, bank.surface_step()));
        let settled = match &self.refiner {
            Some(refiner) if refiner.is_sound() => {
                let floor = candidate.residual + noise.filtered * noise.filtered;
                let worse = refiner.energy() > T::from_f64(WORSE) * floor;
                if !worse || refiner.learned() <= PATIENCE {
                    return;
                }
                refiner.learned() >= SETTLED
            }
            _ => false,
        };
        if !settled {
            self.refiner = started();
            self.successor = None;
        } else if self.successor.is_none() {
            self.successor = started();
        }
    }

    /// Starts a refiner at a better place when the present one's linearisation matters, and lets it
    /// take over once it knows enough.
    fn succeed(&mut self, noise: &ForceNoise<T>, surface_error: T) {
        let Some(refiner) = &self.refiner else { return };
        match &self.successor {
            Some(successor) if takes_over(successor, refiner) => {
                self.refiner = self.successor.take();
            }
            Some(_) => {}
            None => {
                let tolerated = T::from_f64(BEND) * noise.filtered * noise.filtered;
                if refiner.learned() >= FIRST_SUCCESSOR && refiner.bend() > tolerated {
                    self.successor = Some(refiner.successor(surface_error));
                }
            }
        }
    }
}

fn takes_over<T: Real>(successor: &Refiner<T>, refiner: &Refiner<T>) -> bool {
    let most = successor.learned() / 3 >= refiner.learned() / 4;
    successor.is_sound() && (most || successor.knows_like(refiner, T::from_f64(LIKE)))
}

impl<T: Real> Default for BankRefiner<T> {
    fn default() -> Self {
        BankRefiner::new()
    }
}

impl<T: Real> Identify<T> for BankRefiner<T> {
    fn predict(&self, at: &Instant<T>, _noise: &ForceNoise<T>, _surface_error: T) -> (T, T) {
        match &self.refiner {
            Some(refiner) => refiner.predict(at),
            None => (at.force, T::nil()),
        }
    }

    fn learn(
        &mut self,
        params: &Params<T>,
        at: &Instant<T>,
        noise: &ForceNoise<T>,
        _beta: T,
    ) -> Option<T> {
        let phi = Vector2::new(at.depth, at.speed);
        if !self.excitation.admits(&phi, params.excitation_step) {
            return None;
        }
        let bank = self.bank.get_or_insert_with(|| {
            let step = at.surface_error;
            Bank::new(at.surface - T::from_f64(SURFACES_BEFORE) * step, step)
        });
        bank.update(at.position(), at.speed, at.force, T::from_f64(BANK_BETA));
        let surface_step = bank.surface_step();
        self.until_look = self.until_look.saturating_sub(1);
        if self.until_look == 0 {
            self.until_look = LOOK_EVERY;
            self.supervise(noise);
        }
        for refiner in self.refiner.iter_mut().chain(self.successor.iter_mut()) {
            refiner.learn(at, noise, T::from_f64(REFINER_BETA));
        }
        self.succeed(noise, surface_step);
        self.refiner.is_some().then_some(T::from_f64(REFINER_BETA))
    }

    fn reopen(&mut self, _params: &Params<T>) {
        *self = BankRefiner::new();
    }

    fn judged(&self, _noise: &ForceNoise<T>, _surface_error: T) -> [Judged<T>; PARAMETER_SLOTS] {
        let Some(refiner) = &self.refiner else {
            return [Judged::default(); PARAMETER_SLOTS];
        };
        let [stiffness, damping, exponent, _] = refiner.values();
        let exponent = (exponent, T::unit());
        let values = [spring(stiffness), damper(damping, stiffness), exponent];
        judged(&values, refiner.std_errors().iter())
    }
}
