//! Recursive Gauss–Newton on all parameters at once, from a good start to the Cramér–Rao bound.
//!
//! The model is linearized once, at a reference that stays, and the deviations from it are found by
//! linear least squares: the result does not depend on the order of the samples, and nothing of an
//! early, wrong gradient is kept. (An extended Kalman filter, whose gradient follows the
//! estimate, ended 1–2 % off on gel at a claimed 0.13 %.) The linearization error is measured on
//! every pool; when it matters, a successor learns from memory at a better reference.

mod compliance;
mod predicted;

use nalgebra::Vector5;

use compliance::{Compliance, Step};
use predicted::predict;

use super::ForceNoise;
use super::{bank::Candidate, bounds::EXPONENT, bounds::within, pool::Pooled};
use crate::estimate::misfit::Misfit;
use crate::estimate::rls::{LastKnown, Ud};
use crate::maths::scalar::Real;

/// Memory of the mean squares (pools).
const MEAN_SQUARE_MEMORY: f64 = 8.0;
/// Standard deviations beyond which an error loses weight (Huber 1964).
const HUBER: f64 = 5.0;

/// A fit of F = (K + λw)·((x − x₀)/δ₀)ⁿ − τ·dF/dt with θ = (K, λ, n, x₀, τ), scaled, where τ is by
/// how much the force is read later than the position.
///
/// The covariance is kept in units of the prior standard deviations and of the noise of the raw
/// force (filtering makes neighbours alike: a filtered sample is worth no more than a raw one), so
/// that P(0) = I. A prior of 0 means that the parameter is known.
#[derive(Clone, Debug)]
pub struct Refiner<T: Real> {
    reference: Vector5<T>,
    /// (θ − reference)/prior
    deviation: Vector5<T>,
    prior: Vector5<T>,
    covariance: Ud<T, 5>,
    /// Variance of the skew that is taken for known to be 0, in units of its prior; `None` where it is
    /// estimated. The data say what the skew is in either case.
    aligned: Option<T>,
    /// Sum of the weighted gradients, by which a constant error of the force moves the estimate.
    moment: Vector5<T>,
    /// The same, each times the samples since the load began: how an even drift moves the estimate.
    drift_moment: Vector5<T>,
    compliance: Compliance<T>,
    /// Recent mean squared residual, scaled by F₀².
    pub(super) residual: T,
    /// Recent mean square of what the linearization leaves out, scaled by F₀².
    pub(super) linearization_error: T,
    /// By how much the residuals of this reference exceed the noise.
    misfit: Misfit<T>,
    /// Number of samples that were learned from.
    pub(super) learned: T,
    speed_rounding: T,
}

/// Prior standard deviations of surface, exponent and skew, scaled.
#[derive(Clone, Copy, Debug, Default)]
pub struct Prior<T> {
    /// Prior standard deviation of x₀.
    pub surface: T,
    /// Prior standard deviation of n.
    pub exponent: T,
    /// Prior standard deviation of τ.
    pub skew: T,
    /// Standard deviation of τ about 0 where the sensors are taken for aligned; `None` where τ is
    /// estimated.
    pub aligned: Option<T>,
    /// Variance that the steps of the position sensor give the speed over that of the position of an instant.
    pub speed_rounding: T,
}

/// What a pool costs.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cost<T> {
    /// Weight of the pool.
    pub weight: T,
    /// By how much the pool raises the smallest cost.
    pub least: T,
}

impl<T: Real> Refiner<T> {
    /// A refiner that linearizes at a start and has learned nothing.
    pub fn new(start: &Candidate<T>, skew: T, prior: &Prior<T>) -> Self {
        let half = T::from_f64(0.5) * start.stiffness;
        let aligned = prior.aligned.map(|std_dev| {
            let share = std_dev / prior.skew;
            share * share
        });
        Refiner {
            reference: Vector5::new(
                start.stiffness,
                start.damping,
                start.exponent,
                start.surface,
                skew,
            ),
            deviation: Vector5::repeat(T::zero()),
            prior: Vector5::new(half, half, prior.exponent, prior.surface, prior.skew),
            covariance: Ud::new(T::one()),
            aligned,
            moment: Vector5::repeat(T::zero()),
            drift_moment: Vector5::repeat(T::zero()),
            compliance: Compliance::default(),
            residual: start.residual,
            linearization_error: T::zero(),
            misfit: Misfit::default(),
            learned: T::zero(),
            speed_rounding: prior.speed_rounding,
        }
    }

    /// The covariance with the skew known, unless it is estimated.
    fn known(&self) -> LastKnown<'_, T, 5> {
        self.covariance.last_known(self.aligned)
    }

    /// (θ − reference)/prior, with the skew known where it is.
    fn held(&self) -> Vector5<T> {
        self.known().held(&self.deviation)
    }

    /// Skew τ that the data speak for, whether it is estimated or not, and its standard error.
    pub fn skew(&self) -> (T, T) {
        let error = self.covariance.variances()[4].sqrt();
        (
            self.reference[4] + self.deviation[4] * self.prior[4],
            error * self.prior[4],
        )
    }

    /// Whether the skew is among the estimates, and not taken for 0.
    pub fn is_estimating_skew(&self) -> bool {
        self.aligned.is_none()
    }

    /// By how much K, λ, n, x₀ and τ would move if the skew were `skew` instead of 0.
    pub fn moved_by_skew(&self, skew: T) -> [T; 5] {
        (self.known().moved_by_last() * (skew / self.prior[4]))
            .component_mul(&self.prior)
            .into()
    }

    /// Compliance of a spring in series that the data speak for, and its standard error, scaled.
    pub fn compliance(&self) -> Option<(T, T)> {
        self.compliance.found()
    }

    /// By how much K, λ, n, x₀ and τ are moved by a compliance that the law leaves out.
    pub fn moved_by_compliance(&self, compliance: T) -> [T; 5] {
        let moved = self.compliance.moved_by(compliance);
        self.known().held(&moved).component_mul(&self.prior).into()
    }

    /// A refiner that linearizes at the estimates of this one and has learned nothing.
    pub fn successor(&self, prior: &Prior<T>) -> Self {
        let [stiffness, damping, exponent, surface, skew] = self.values();
        let residual = self.residual;
        let start = Candidate {
            stiffness,
            damping,
            exponent,
            surface,
            residual,
        };
        // A skew that is taken for 0 must not walk there reference by reference.
        let skew = if self.is_estimating_skew() {
            skew
        } else {
            T::zero()
        };
        Refiner::new(&start, skew, prior)
    }

    /// The estimates of K, λ, n, x₀ and τ, scaled.
    pub fn values(&self) -> [T; 5] {
        self.values_at(&self.held())
    }

    /// K, λ, n, x₀ and τ, scaled, that deviate from the reference by so many priors.
    fn values_at(&self, deviation: &Vector5<T>) -> [T; 5] {
        let [stiffness, damping, exponent, surface, skew]: [T; 5] =
            (self.reference + deviation.component_mul(&self.prior)).into();
        [
            stiffness,
            damping,
            within(exponent, EXPONENT),
            surface,
            skew,
        ]
    }

    /// Standard errors of K, λ, n, x₀ and τ, scaled, for a standard error of the resting force, a drift of
    /// it per sample, and a noise of the force.
    pub fn std_errors(&self, rest_error: T, rest_drift: T, noise: &ForceNoise<T>) -> [T; 5] {
        let known = self.known();
        let mut variances = known.variances();
        // A wrong resting force is not noise: it moves every sample the same way (Schmidt 1966).
        for (moment, error) in [(&self.moment, rest_error), (&self.drift_moment, rest_drift)] {
            if error > T::zero() {
                let shift = known.times(moment) * (error / noise.raw);
                variances += shift.component_mul(&shift);
            }
        }
        self.prior.component_mul(&variances.map(T::sqrt)).into()
    }

    /// Whether every standard error is at most `factor` times that of another refiner.
    pub fn knows_as_well_as(&self, other: &Self, factor: T) -> bool {
        let known = |refiner: &Self| {
            let variances = refiner.known().variances();
            variances.component_mul(&refiner.prior.component_mul(&refiner.prior))
        };
        let square = factor * factor;
        known(self)
            .iter()
            .zip(known(other).iter())
            .all(|(this, other)| *this <= square * *other)
    }

    /// The slope dF̂/dx.
    pub fn slope(&self, at: &Pooled<T>) -> T {
        -predict(&self.values(), at).gradient.w
    }

    /// The position at which the force of a pool is that of its speed.
    pub fn position_of(&self, at: &Pooled<T>) -> T {
        let [stiffness, damping, exponent, surface, _] = self.values();
        let pressure = stiffness + damping * at.speed;
        if pressure <= T::zero() || at.force <= T::zero() {
            return surface;
        }
        surface + ((at.force / pressure).ln() / exponent).exp()
    }

    /// The same estimates of a surface that lies `by` deeper, to a standard deviation.
    pub fn shift_surface(&mut self, by: T, std_dev: T) {
        self.reference.w += by;
        if self.prior.w > T::zero() {
            let share = std_dev / self.prior.w;
            self.covariance.widen(3, share * share);
        }
    }

    /// The force F̂ and its variance from the errors of the parameters, scaled.
    pub fn predict(&self, at: &Pooled<T>) -> (T, T) {
        let values = self.values();
        let predicted = predict(&values, at);
        let phi = predicted.gradient.component_mul(&self.prior);
        // P is in units of the noise of the raw force: φ/σ and P·σ² cancel.
        // Not the linearization error: a misfit would hide behind it.
        let model = self.known().variance(&phi);
        (
            predicted.force,
            model + self.rounding_variance(values[1], &predicted.gradient, at),
        )
    }

    /// Variance of a predicted force by the steps of the position sensor: in the depth, and in the speed, which
    /// rounding makes no larger than it is.
    fn rounding_variance(&self, damping: T, gradient: &Vector5<T>, at: &Pooled<T>) -> T {
        let (by_position, by_speed) = (gradient.w, damping * gradient.x);
        let speed = (self.speed_rounding * at.quantization_variance).min_of(at.speed * at.speed);
        by_position * by_position * at.quantization_variance + by_speed * by_speed * speed
    }

    /// Learns from a pool of instants with forgetting factor β. Gives the weight of the pool and by how much
    /// it raises the smallest cost Σw·e²/σ² of this reference.
    pub fn learn(&mut self, at: &Pooled<T>, noise: &ForceNoise<T>, beta: T) -> Cost<T> {
        let there = predict(&self.reference.into(), at);
        if there.gradient.x == T::zero() {
            // A force above the surface is a misfit; where the window is too wide there is no saying.
            if there.force == T::zero() {
                self.observe_residual(at.force, T::zero(), at, noise);
            }
            return Cost::default();
        }
        let phi = there.gradient.component_mul(&self.prior);
        let linear = there.force + phi.dot(&self.deviation);
        let error = at.force - linear;
        let slope = there.gradient.w;
        let weight =
            at.count * self.weight(error, &phi, slope * slope * at.quantization_variance, noise);
        // The UD update of P is for unit noise; dividing φ by σ and e by σ is the same as this.
        let phi_noise = phi / noise.raw;
        let update = self.covariance.update(&phi_noise, beta, weight);
        let error_noise = error / noise.raw;
        self.deviation += update.gain * error_noise;
        // The recursive identity for the cost at the minimum: prior times posterior error, 1 − φᵀg = β/(β + wφᵀPφ).
        let posterior = weight * beta / (beta + weight * update.prior_variance);
        let by_compliance = Compliance::gradient(&there, self.reference.y, at) / noise.raw;
        self.compliance.learn(
            by_compliance,
            &Step {
                phi: phi_noise,
                gain: update.gain,
                error: error_noise,
                weight: posterior,
                beta,
            },
        );
        let moment = phi_noise * weight;
        self.moment = self.moment * beta + moment;
        self.drift_moment = self.drift_moment * beta + moment * at.loaded;
        let held = self.held();
        let here = predict(&self.values_at(&held), at).force;
        let linearization_error = here - there.force - phi.dot(&held);
        let left = at.force - here;
        let share = T::from_f64(1.0 / MEAN_SQUARE_MEMORY);
        self.residual += share * (left * left - self.residual);
        let rounding = self.rounding_variance(self.reference.y, &there.gradient, at);
        self.observe_residual(left, rounding, at, noise);
        self.linearization_error +=
            share * (linearization_error * linearization_error - self.linearization_error);
        self.learned += at.count;
        Cost {
            weight,
            least: posterior * error_noise * error_noise,
        }
    }

    /// The cost w·e²/σ² of a pool at the estimates.
    pub fn cost(&self, at: &Pooled<T>, weight: T, noise: &ForceNoise<T>) -> T {
        let left = at.force - predict(&self.values(), at).force;
        weight * left * left / (noise.raw * noise.raw)
    }

    /// Takes the residual of a pool that is not learned from.
    pub fn observe(&mut self, at: &Pooled<T>, noise: &ForceNoise<T>) {
        let values = self.values();
        let predicted = predict(&values, at);
        let rounding = self.rounding_variance(values[1], &predicted.gradient, at);
        self.observe_residual(at.force - predicted.force, rounding, at, noise);
    }

    fn observe_residual(&mut self, left: T, rounding: T, at: &Pooled<T>, noise: &ForceNoise<T>) {
        let variance = noise.filtered * noise.filtered;
        let gain = variance / (noise.raw * noise.raw);
        let normalized = left / (variance + rounding).sqrt();
        self.misfit.update(normalized, at.count, gain);
    }

    /// By how much the residuals exceed the noise, since this reference was taken and over what it
    /// learned again from memory.
    pub fn misfit(&self) -> &Misfit<T> {
        &self.misfit
    }

    /// Weight of a sample: less than 1 where the quantization of the position makes its force less
    /// certain (`quantization` is the variance of the force by it), and for an error that is not to
    /// be expected: where the motion jumps between two samples, force and speed do not belong
    /// together.
    fn weight(&self, error: T, phi: &Vector5<T>, quantization: T, noise: &ForceNoise<T>) -> T {
        let variance = noise.raw * noise.raw;
        let certain = variance / (variance + quantization);
        let model = self.known().variance(phi);
        let left = noise.filtered * noise.filtered / certain + model + self.linearization_error;
        let expected = T::from_f64(HUBER) * left.sqrt();
        let size = error.abs();
        if size > expected {
            certain * expected / size
        } else {
            certain
        }
    }

    /// Whether the estimates can be a contact: finite, and a spring that pushes.
    pub fn is_sound(&self) -> bool {
        let values = self.values();
        values.iter().all(|value| value.is_finite())
            && values[0] > T::zero()
            && self.residual.is_finite()
    }
}

#[cfg(test)]
mod tests;
