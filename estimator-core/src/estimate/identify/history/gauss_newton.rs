//! Recursive Gauss–Newton on whichever parameters a law has, at a reference that stays.
//!
//! A short contact tells the product of B and ν, not the two: a step that is straight in both leaves
//! the valley. So each step of Gauss–Newton is two passes: one that finds K, λ and B for the n, x₀
//! and ν of the reference, exactly, since the force is linear in them, and says what these three
//! cost at best; and one for all of θ from there (variable projection, Golub & Pereyra 1973).

use super::block::Block;
use super::predict::{RelaxationState, predict};
use super::theta::{
    DAMPING, EXPONENT, MODES, SLOTS, STIFFNESS, SURFACE, Theta, bounded, has, modes,
};
use crate::estimate::rls::Ud;
use crate::maths::scalar::Real;
use crate::physics::law::LawKind;

/// Prior standard deviations of n and ln ν, and of K, λ and B over K.
const PRIOR_EXPONENT: f64 = 0.2;
const PRIOR_LOG_RATE: f64 = 0.7;
const PRIOR_LINEAR: f64 = 0.5;
/// The same of a pass that finds K, λ and B alone.
const PRIOR_PROJECTED: f64 = 3.0;
/// Longest step in n, in ln ν, and in x₀ over its prior standard deviation.
const LONGEST_EXPONENT: f64 = 0.3;
const LONGEST_LOG_RATE: f64 = 1.1;
const LONGEST_SURFACE: f64 = 2.0;
/// Standard deviations beyond which an error loses weight (Huber 1964).
const HUBER: f64 = 5.0;
/// A block is worth no more than this many samples: what its position is off by is the same for all
/// of them (1 µm of encoder steps on 6 N/mm are 2 mN, what is left of 20 mN by a mean of 100).
const MOST_COUNTED: f64 = 100.0;
/// Largest standard error of ln ν over which a gradient holds.
const LINEAR_WITHIN: f64 = 0.2;
/// Memory of the recent errors (blocks).
const RECENT: f64 = 16.0;

/// A fit to blocks that were taken one after the other, linearized at a reference.
///
/// The covariance is in units of the prior standard deviations and of the noise of the raw force, so
/// that P(0) = I.
#[derive(Clone, Debug)]
pub(super) struct GaussNewton<T: Real> {
    pub(super) law: LawKind,
    pub(super) reference: Theta<T>,
    /// (θ − reference)/prior
    deviation: Theta<T>,
    prior: Theta<T>,
    covariance: Ud<T, SLOTS>,
    relaxation: RelaxationState<T>,
    /// Number of the next block.
    pub(super) next: u32,
    /// Sums of squared errors at the reference, and of squared residuals, over their variance.
    cost: T,
    residual: T,
    /// The number of blocks that were learned from.
    pub(super) blocks: T,
    recent: T,
    /// Whether anything was learned, by this fit or by the one that it goes on from.
    pub(super) informed: bool,
}

impl<T: Real> GaussNewton<T> {
    /// A fit that has seen nothing; `surface_error` is the prior standard deviation of x₀, 0 if it is
    /// known.
    pub(super) fn new(law: LawKind, reference: &Theta<T>, surface_error: T) -> Self {
        let reference = bounded(law, *reference);
        let (damps, curves) = has(law);
        let only = |is: bool, value: T| if is { value } else { T::zero() };
        let linear = T::from_f64(PRIOR_LINEAR) * reference[STIFFNESS];
        let mut prior = Theta::<T>::repeat(T::zero());
        prior[STIFFNESS] = linear;
        prior[DAMPING] = only(damps, linear);
        prior[EXPONENT] = only(curves, T::from_f64(PRIOR_EXPONENT));
        prior[SURFACE] = surface_error;
        for (relaxing, log_rate) in MODES.into_iter().take(modes(law)) {
            prior[relaxing] = linear;
            prior[log_rate] = T::from_f64(PRIOR_LOG_RATE);
        }
        GaussNewton {
            law,
            reference,
            deviation: Theta::repeat(T::zero()),
            prior,
            covariance: Ud::new(T::one()),
            relaxation: RelaxationState::default(),
            next: 0,
            cost: T::zero(),
            residual: T::zero(),
            blocks: T::zero(),
            recent: T::one(),
            informed: false,
        }
    }

    /// A fit at another reference that knows what this one knew and goes on where it stands.
    pub(super) fn at_reference(
        &self,
        law: LawKind,
        reference: &Theta<T>,
        surface_error: T,
    ) -> Self {
        let mut fit = self.goes_on(GaussNewton::new(law, reference, surface_error));
        if self.informed && self.law == law {
            let away = self.reference + self.deviation.component_mul(&self.prior) - fit.reference;
            fit.deviation = away.zip_map(&self.prior, |away, prior| {
                if prior > T::zero() {
                    away / prior
                } else {
                    T::zero()
                }
            });
            fit.prior = self.prior;
            fit.covariance = self.covariance.clone();
            fit.informed = true;
        }
        fit
    }

    /// A fit of K, λ and B alone at another reference, that goes on where this one stands.
    pub(super) fn projected(&self, law: LawKind, reference: &Theta<T>) -> Self {
        let mut fit = self.goes_on(GaussNewton::new(law, reference, T::zero()));
        fit.prior *= T::from_f64(PRIOR_PROJECTED / PRIOR_LINEAR);
        fit.prior[EXPONENT] = T::zero();
        for (_, log_rate) in MODES {
            fit.prior[log_rate] = T::zero();
        }
        fit
    }

    fn goes_on(&self, mut fit: Self) -> Self {
        fit.relaxation = self.relaxation.moved(&(fit.reference - self.reference));
        fit.next = self.next;
        fit
    }

    /// Learns from a block, if it may be learned from; `beta` is the forgetting factor.
    pub(super) fn learn(&mut self, block: &Block<T>, noise_raw: T, beta: T) {
        self.next = self.next.wrapping_add(1);
        let there = predict(&self.reference, self.law, &self.relaxation, block);
        self.relaxation = there.relaxation;
        if block.count <= T::zero() || there.gradient[STIFFNESS] == T::zero() {
            return;
        }
        let per_count = T::one() / block.count + T::from_f64(1.0 / MOST_COUNTED);
        let per_sigma = T::one() / (noise_raw * per_count.sqrt());
        let phi = there.gradient.component_mul(&self.prior) * per_sigma;
        let at_reference = (block.force - there.force) * per_sigma;
        let error = at_reference - phi.dot(&self.deviation);
        let weight = self.weight(error, &phi);
        let update = self.covariance.update(&phi, beta, weight);
        self.deviation += update.gain * error;
        let after = error - phi.dot(&update.gain) * error;
        self.cost += huber_loss(at_reference);
        self.residual += weight * error * after;
        self.blocks += T::one();
        let share = T::from_f64(1.0 / RECENT);
        self.recent += share * (after * after - self.recent);
        self.informed = true;
    }

    /// The weight of an error: 1, or less where it is not to be expected.
    fn weight(&self, error: T, phi: &Theta<T>) -> T {
        let size = error.abs();
        let typical = T::one().max_of(self.recent);
        if size * size <= T::from_f64(HUBER * HUBER) * typical {
            return T::one();
        }
        let model = self.covariance.variance(phi);
        let expected = T::from_f64(HUBER) * (typical + model).sqrt();
        if size > expected {
            expected / size
        } else {
            T::one()
        }
    }

    /// Lets a block relax the material and learns nothing from it.
    pub(super) fn observe(&mut self, block: &Block<T>) {
        self.next = self.next.wrapping_add(1);
        self.relaxation = predict(&self.reference, self.law, &self.relaxation, block).relaxation;
    }

    fn unbounded(&self) -> Theta<T> {
        self.reference + self.deviation.component_mul(&self.prior)
    }

    /// The estimate θ̂.
    pub(super) fn values(&self) -> Theta<T> {
        bounded(self.law, self.unbounded())
    }

    /// θ̂, or as far towards it as a step may go.
    pub(super) fn stepped(&self, surface_error: T) -> Theta<T> {
        let to = self.values();
        let step = to - self.reference;
        let [(_, fast), (_, slow)] = MODES;
        let longest = [
            (EXPONENT, T::from_f64(LONGEST_EXPONENT)),
            (SURFACE, T::from_f64(LONGEST_SURFACE) * surface_error),
            (fast, T::from_f64(LONGEST_LOG_RATE)),
            (slow, T::from_f64(LONGEST_LOG_RATE)),
        ];
        let mut share = T::one();
        for (slot, longest) in longest {
            let size = step.get(slot).copied().unwrap_or_default().abs();
            if size * share > longest {
                share = longest / size;
            }
        }
        bounded(self.law, self.reference + step * share)
    }

    /// The relaxation that goes with [`GaussNewton::values`].
    pub(super) fn relaxation(&self) -> RelaxationState<T> {
        self.relaxation.moved(&(self.values() - self.reference))
    }

    /// Variance of a quantity from its gradient by θ; of a force, without the noise.
    pub(super) fn variance(&self, gradient: &Theta<T>) -> T {
        self.covariance
            .variance(&gradient.component_mul(&self.prior))
    }

    /// Standard errors of θ̂.
    pub(super) fn std_errors(&self) -> Theta<T> {
        let variances = self.covariance.variances();
        self.prior
            .zip_map(&variances, |prior, variance| prior * variance.sqrt())
    }

    /// Mean squared error at the reference over its variance.
    pub(super) fn cost(&self) -> T {
        self.cost / self.blocks.max_of(T::one())
    }

    /// Mean squared residual over its variance.
    pub(super) fn residual(&self) -> T {
        self.residual / self.blocks.max_of(T::one())
    }

    /// The largest step from the reference to θ̂, in standard errors.
    pub(super) fn step(&self) -> T {
        let variances = self.covariance.variances();
        let mut most = T::zero();
        for (deviation, variance) in self.deviation.iter().zip(variances.iter()) {
            if *variance > T::zero() {
                most = most.max_of(deviation.abs() / variance.sqrt());
            }
        }
        most
    }

    /// Whether the gradient holds over the standard errors.
    pub(super) fn is_linear(&self) -> bool {
        let errors = self.std_errors();
        MODES.into_iter().all(|(_, log_rate)| {
            let error = errors.get(log_rate).copied().unwrap_or_default();
            error < T::from_f64(LINEAR_WITHIN)
        })
    }

    /// Whether a rate has run against a bound.
    pub(super) fn is_at_bound(&self) -> bool {
        let (unbounded, values) = (self.unbounded(), self.values());
        MODES
            .into_iter()
            .take(modes(self.law))
            .any(|(_, log_rate)| unbounded.get(log_rate) != values.get(log_rate))
    }

    /// Whether the values can be a contact: finite, and a spring that pushes.
    pub(super) fn is_sound(&self) -> bool {
        let values = self.unbounded();
        values.iter().all(|value| value.is_finite())
            && values[STIFFNESS] > T::zero()
            && self.residual.is_finite()
            && self.cost.is_finite()
    }
}

/// e² near zero, 2·HUBER·|e| far from it.
fn huber_loss<T: Real>(error: T) -> T {
    let (size, edge) = (error.abs(), T::from_f64(HUBER));
    if size > edge {
        edge * (size + size - edge)
    } else {
        size * size
    }
}
