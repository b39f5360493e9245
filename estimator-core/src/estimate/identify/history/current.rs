//! The fit in use: what it predicts now and what its law's parameters are.

use super::block::Block;
use super::gauss_newton::GaussNewton;
use super::predict::{Predicted, RelaxationState, predict};
use super::theta::{DAMPING, EXPONENT, MODES, STIFFNESS, SURFACE, Theta, modes};
use crate::estimate::identify::params::SPEED_PER_DEPTH;
use crate::estimate::identify::slots::size;
use crate::estimate::monitor::ParameterEstimate;
use crate::estimate::record::PARAMETER_SLOTS;
use crate::maths::scalar::Real;
use crate::physics::law::LawKind;

/// Standard errors of parameters that are known, over their size.
const KNOWN: f64 = 0.05;

/// The fit in use.
#[derive(Clone, Debug)]
pub(super) struct Current<T: Real> {
    pub(super) fit: GaussNewton<T>,
    /// The relaxation at the newest sample.
    live: RelaxationState<T>,
    /// The parameters of the law with their standard errors, in the order of its slots.
    pub(super) estimates: [ParameterEstimate<T>; PARAMETER_SLOTS],
    /// The surface and its standard error.
    pub(super) surface: (T, T),
    /// Whether a rate has run against a bound: what goes with it has standard errors all the same.
    pub(super) is_at_bound: bool,
}

impl<T: Real> Current<T> {
    /// A fit to all blocks that have ended; `open` is the one under way.
    pub(super) fn new(fit: GaussNewton<T>, open: Option<Block<T>>) -> Self {
        let mut current = Current {
            live: fit.relaxation(),
            estimates: estimates(&fit),
            surface: (fit.values()[SURFACE], fit.std_errors()[SURFACE]),
            is_at_bound: fit.is_at_bound(),
            fit,
        };
        // From the end of the last block to this sample.
        if let Some(open) = open {
            current.observe(&open);
        }
        current
    }

    /// Lets what came since the last sample relax the material.
    pub(super) fn observe(&mut self, block: &Block<T>) {
        self.live = self.at(block).relaxation;
    }

    /// The force at an instant and its variance.
    pub(super) fn predict(&self, at: &Block<T>) -> (T, T) {
        let predicted = self.at(at);
        let variance = self.fit.variance(&predicted.gradient);
        // A material that has not recovered is not there yet: it does not pull.
        (T::zero().max_of(predicted.force), variance)
    }

    fn at(&self, block: &Block<T>) -> Predicted<T> {
        predict(&self.fit.values(), self.fit.law, &self.live, block)
    }

    /// Whether every parameter is known to a few percent.
    pub(super) fn is_known(&self) -> bool {
        let known = |estimate: &ParameterEstimate<T>| {
            estimate.std_error <= T::from_f64(KNOWN) * estimate.scale
        };
        self.estimates.iter().all(known)
    }
}

fn estimates<T: Real>(fit: &GaussNewton<T>) -> [ParameterEstimate<T>; PARAMETER_SLOTS] {
    let mut slots = Slots {
        fit,
        theta: fit.values(),
        estimates: [ParameterEstimate::default(); PARAMETER_SLOTS],
    };
    let stiffness = slots.theta[STIFFNESS];
    slots.put(0, stiffness, &unit(STIFFNESS), size(stiffness, stiffness));
    match fit.law {
        LawKind::KelvinVoigt | LawKind::HuntCrossley => slots.put_damped(stiffness),
        LawKind::Zener => slots.put_zener(stiffness),
        law => slots.put_modes(stiffness, modes(law)),
    }
    slots.estimates
}

/// The gradient of one of the parameters.
fn unit<T: Real>(slot: usize) -> Theta<T> {
    let mut gradient = Theta::repeat(T::zero());
    if let Some(of_slot) = gradient.get_mut(slot) {
        *of_slot = T::one();
    }
    gradient
}

/// θ̂ on its way into the slots of a law.
struct Slots<'a, T: Real> {
    fit: &'a GaussNewton<T>,
    theta: Theta<T>,
    estimates: [ParameterEstimate<T>; PARAMETER_SLOTS],
}

impl<T: Real> Slots<'_, T> {
    fn put(&mut self, index: usize, value: T, gradient: &Theta<T>, scale: T) {
        if let Some(slot) = self.estimates.get_mut(index) {
            *slot = ParameterEstimate {
                value,
                std_error: self.fit.variance(gradient).sqrt(),
                scale,
            };
        }
    }

    fn put_damped(&mut self, stiffness: T) {
        let damping = self.theta[DAMPING];
        self.put(1, damping, &unit(DAMPING), size(damping, stiffness));
        self.put(2, self.theta[EXPONENT], &unit(EXPONENT), T::one());
    }

    /// With c = κ₁/(κ₁ + κ₂): κ₂ = κ₁²/B − κ₁, λ = κ₁²/(Bν).
    fn put_zener(&mut self, stiffness: T) {
        let (relaxing, log_rate) = MODES[0];
        let (share, rate) = (self.theta[relaxing] / stiffness, self.theta[log_rate].exp());
        let second = stiffness / share - stiffness;
        let mut gradient = unit(STIFFNESS) * (T::from_f64(2.0) / share - T::one());
        gradient[relaxing] = -(T::one() / (share * share));
        self.put(1, second, &gradient, size(second, stiffness));
        let damping = stiffness / (share * rate) * T::from_f64(SPEED_PER_DEPTH);
        let mut gradient = unit(STIFFNESS) * (T::from_f64(2.0) * damping / stiffness);
        gradient[relaxing] = -(damping / self.theta[relaxing]);
        gradient[log_rate] = -damping;
        self.put(2, damping, &gradient, size(damping, stiffness));
    }

    /// The exponent and the modes, fast to slow.
    fn put_modes(&mut self, stiffness: T, modes: usize) {
        self.put(1, self.theta[EXPONENT], &unit(EXPONENT), T::one());
        let mut order = MODES;
        if modes == 2 && self.theta[MODES[0].1] < self.theta[MODES[1].1] {
            order.reverse();
        }
        for (index, (relaxing, log_rate)) in order.into_iter().take(modes).enumerate() {
            let rate = self.theta[log_rate].exp();
            let share = self.theta[relaxing] / stiffness;
            let of_share = (unit(relaxing) - unit(STIFFNESS) * share) / stiffness;
            self.put(2 + 2 * index, share, &of_share, T::one());
            self.put(3 + 2 * index, rate, &(unit(log_rate) * rate), rate);
        }
    }
}
