//! Γ₂, the relaxation filter, from means over periods of the force and its elastic part, (41)–(42).

use nalgebra::{Matrix2, SVector, Vector2};

use super::split_force::SplitForce;
use crate::estimate::identify::contract::{ForceNoise, Instant};
use crate::estimate::identify::equation_error::{Equation, EquationError};
use crate::estimate::identify::modes::{ModelPeriod, RelaxationExcitation, one_mode, two_modes};
use crate::estimate::identify::params::IdentifyParams;
use crate::estimate::monitor::ParameterEstimate;
use crate::maths::{Dual, Real, Scalar};
use crate::physics::law::RelaxationMode;

/// Periods for two modes over those for one. Measured on modes of 2/s and 0.1/s in a hold of 50 s:
/// noise in the regressors makes the fast rate 65 % too high at ten times, 48 % at twenty, 16 % at
/// forty.
const SLOWER_FOR_TWO: u32 = 40;

/// What is wrong in every period alike: ln γ₁, γ₂ and the surface.
const CONSIDERED: usize = 3;

/// The second stage for `R` modes: recursive least squares on differences of z, `N` = 2R parameters.
#[derive(Clone, Debug)]
pub(super) struct RelaxationStage<T: Real, const R: usize, const N: usize> {
    gamma_2: EquationError<T, N, CONSIDERED>,
    excitation: RelaxationExcitation<T>,
    modes: Option<[RelaxationMode<T>; R]>,
    period: ModelPeriod<T>,
    /// Means of the last periods, newest first.
    past: [SplitForce<T>; R],
    /// Number of periods in `past` that belong to this run of samples.
    known: usize,
    /// Sum over the samples of the current period, and their number.
    sum: SplitForce<T>,
    summed: u32,
}

impl<T: Real, const R: usize, const N: usize> RelaxationStage<T, R, N> {
    /// The stage before the first sample: nothing relaxes to begin with.
    pub(super) fn new(params: &IdentifyParams<T>, half_window: ModelPeriod<T>) -> Self {
        let period = if R == 1 {
            half_window
        } else {
            half_window.slower(SLOWER_FOR_TWO)
        };
        RelaxationStage {
            gamma_2: EquationError::new(SVector::repeat(T::zero()), params.start.covariance),
            excitation: RelaxationExcitation::new(period),
            modes: None,
            period,
            past: [SplitForce::zero(); R],
            known: 0,
            sum: SplitForce::zero(),
            summed: 0,
        }
    }

    pub(super) fn modes(&self) -> Option<[RelaxationMode<T>; R]> {
        self.modes
    }

    /// Σcᵢνᵢ (1/s), the rate at which the force of a step relaxes at first.
    pub(super) fn decay_per_s(&self) -> T {
        let mut decay = T::zero();
        for mode in self.modes.iter().flatten() {
            decay += mode.fraction * mode.rate_per_s;
        }
        decay
    }

    fn per_s(&self) -> T {
        T::one() / self.period.seconds()
    }

    /// The last period, once there is one in this run of samples.
    pub(super) fn last(&self) -> Option<&SplitForce<T>> {
        self.past.first().filter(|_| self.known > 0)
    }

    /// Change of z from the middle of the last period to `now`.
    pub(super) fn change(&self, now: &SplitForce<T>) -> T {
        let half = T::from_f64(0.5);
        let since = T::from_u32(self.summed + 1);
        let elapsed_s = self.period.sample_s * since + half * self.period.seconds();
        let slope = if self.known < R {
            T::zero()
        } else {
            let (of_z, of_elastic) = self.derivatives(now, self.per_s());
            let phi = Self::regressor(&of_z, &of_elastic);
            let highest = self.gamma_2.rls.predict(&phi);
            match of_z.as_slice() {
                [rate, _] => rate.relaxed + highest * self.period.seconds(),
                _ => highest,
            }
        };
        slope * elapsed_s
    }

    /// Takes one sample; learns at the end of a period.
    pub(super) fn learn(
        &mut self,
        params: &IdentifyParams<T>,
        sample: &SplitForce<T>,
        noise: &ForceNoise<T>,
        beta: T,
    ) {
        self.sum = self.sum.plus(sample, T::one());
        self.summed += 1;
        if self.summed < self.period.samples {
            return;
        }
        let share = T::one() / T::from_u32(self.summed);
        let now = SplitForce::zero().plus(&self.sum, share);
        self.sum = SplitForce::zero();
        self.summed = 0;
        if self.known >= R {
            self.learn_period(params, &now, noise, beta);
        }
        self.past.rotate_right(1);
        if let Some(first) = self.past.first_mut() {
            *first = now;
        }
        self.known = (self.known + 1).min(R);
    }

    fn learn_period(
        &mut self,
        params: &IdentifyParams<T>,
        now: &SplitForce<T>,
        noise: &ForceNoise<T>,
        beta: T,
    ) {
        let equation = self.equation(now);
        let force = now.relaxed + now.elastic;
        let phi = [force, now.elastic, T::zero()];
        let sigma = self.period.variance(noise).sqrt();
        let gate = self
            .excitation
            .admits(phi, force, params.excitation_step, sigma, beta);
        if let Some(beta) = gate {
            self.gamma_2.update(&equation, beta, T::one());
            self.modes = modes(self.gamma_2.rls.theta.as_slice(), self.period.seconds());
        } else {
            self.gamma_2.break_off();
        }
    }

    fn equation(&self, now: &SplitForce<T>) -> Equation<T, N, CONSIDERED> {
        let per_s = self.per_s();
        let (of_z, of_elastic) = self.derivatives(now, per_s);
        let phi = Self::regressor(&of_z, &of_elastic);
        let y = self.output(now, per_s);
        // ε = y − φᵀθ; an error of F̂⁽ᵉ⁾ is an error of z with the other sign.
        let mut by_considered = -y.gradient;
        let terms = of_z.iter().chain(&of_elastic);
        for (coefficient, term) in self.gamma_2.rls.theta.iter().zip(terms) {
            by_considered -= term.gradient * *coefficient;
        }
        Equation {
            phi,
            y: y.relaxed,
            by_noise: self.by_noise(per_s),
            by_considered,
        }
    }

    /// The terms of φ₂: derivatives of z, and of F̂⁽ᵉ⁾, highest first. The delta operator looks
    /// forward: all of them are those of the oldest period.
    fn derivatives(
        &self,
        now: &SplitForce<T>,
        per_s: T,
    ) -> ([SplitForce<T>; R], [SplitForce<T>; R]) {
        let (mut of_z, mut of_elastic) = (self.past, self.past);
        if let ([newest, oldest], [e_newest, e_oldest]) =
            (of_z.as_mut_slice(), of_elastic.as_mut_slice())
        {
            let (rate, rate_after) = (newest.rate(oldest, per_s), now.rate(newest, per_s));
            // F̂⁽ᵉ⁾ in the middle of the step: without it a fast mode would be off by νT/2.
            *e_oldest = oldest.midpoint(newest);
            *e_newest = rate.midpoint(&rate_after);
            *newest = rate;
        }
        (of_z, of_elastic)
    }

    fn regressor(of_z: &[SplitForce<T>; R], of_elastic: &[SplitForce<T>; R]) -> SVector<T, N> {
        let relaxed = of_z.iter().map(|term| -term.relaxed);
        let elastic = of_elastic.iter().map(|term| term.elastic);
        let mut phi = SVector::<T, N>::repeat(T::zero());
        for (slot, value) in phi.iter_mut().zip(relaxed.chain(elastic)) {
            *slot = value;
        }
        phi
    }

    /// The highest difference quotient of z that ends with `now`: ż for one mode, z̈ for two.
    fn output(&self, now: &SplitForce<T>, per_s: T) -> SplitForce<T> {
        match self.past.as_slice() {
            [last, before] => now.rate(last, per_s).rate(&last.rate(before, per_s), per_s),
            [last, ..] => now.rate(last, per_s),
            [] => *now,
        }
    }

    /// How noise enters Γ₂: the coefficients of n(h−R), …, n(h) in ε, oldest first.
    fn by_noise(&self, per_s: T) -> [T; 3] {
        let theta = &self.gamma_2.rls.theta;
        let coefficient = |i: usize| theta.get(i).copied().unwrap_or_default();
        if R == 1 {
            [coefficient(0) - per_s, per_s, T::zero()]
        } else {
            let (a_1, a_0) = (coefficient(0), coefficient(1));
            let squared = per_s * per_s;
            [
                squared - a_1 * per_s + a_0,
                a_1 * per_s - squared - squared,
                squared,
            ]
        }
    }

    /// Begins a run of samples at the first touch of a material at rest, F = F⁽ᵉ⁾ = 0, which the
    /// filter's window of `memory_samples` still contains: two modes are told apart by how the
    /// relaxation sets in.
    pub(super) fn start_at_rest(&mut self, memory_samples: u32) {
        self.past = [SplitForce::zero(); R];
        self.known = R;
        self.summed = memory_samples;
    }

    /// Ends a run of samples: the next sample does not follow the last one.
    pub(super) fn break_off(&mut self) {
        if self.known > 0 {
            self.gamma_2.break_off();
        }
        self.known = 0;
        self.sum = SplitForce::zero();
        self.summed = 0;
    }

    pub(super) fn reset_covariance(&mut self, covariance: T) {
        self.gamma_2.reset_covariance(covariance);
        self.break_off();
    }

    /// Writes cᵢ and νᵢ with the errors that noise, Γ₁ (its covariance, and how the surface moves it) and
    /// the surface give them; leaves the slots as they are while the poles are not those of a relaxation.
    pub(super) fn estimate(
        &self,
        slots: &mut [ParameterEstimate<T>],
        (elastic_covariance, elastic_by_surface): (&Matrix2<T>, &Vector2<T>),
        at: &Instant<T>,
    ) {
        let mut index = 0..N;
        let dual = self
            .gamma_2
            .rls
            .theta
            .map(|value| Dual::<T, N>::parameter(value, index.next().unwrap_or(N)));
        let Some(found) = modes::<_, R>(dual.as_slice(), Dual::constant(self.period.seconds()))
        else {
            return;
        };
        let covariance = self.gamma_2.covariance(self.period.variance(&at.noise));
        let shift = self.gamma_2.shift();
        let parameters = found.iter().flat_map(|mode| {
            [
                (mode.fraction, T::one()),
                (mode.rate_per_s, mode.rate_per_s.value),
            ]
        });
        for (slot, (dual, scale)) in slots.iter_mut().zip(parameters) {
            let gradient = SVector::<T, N>::from(dual.gradient);
            let considered = shift.tr_mul(&gradient);
            let by_elastic = Vector2::new(considered.x, considered.y);
            let moved = (considered.z + by_elastic.dot(elastic_by_surface)) * at.surface_error;
            let variance = gradient.dot(&(covariance * gradient))
                + by_elastic.dot(&(elastic_covariance * by_elastic))
                + moved * moved;
            *slot = ParameterEstimate {
                value: dual.value,
                std_error: T::zero().max_of(variance).sqrt(),
                scale,
            };
        }
    }
}

/// The modes of θ₂ = [α…, β…].
fn modes<S: Scalar, const R: usize>(theta: &[S], period_s: S) -> Option<[RelaxationMode<S>; R]> {
    let mut found = [RelaxationMode {
        fraction: S::zero(),
        rate_per_s: S::zero(),
    }; R];
    match (theta, found.as_mut_slice()) {
        ([alpha, beta], [mode]) => *mode = one_mode(*alpha, *beta, period_s)?,
        ([a_1, a_0, b_1, b_0], [fast, slow]) => {
            [*fast, *slow] = two_modes([*a_1, *a_0], [*b_1, *b_0], period_s)?;
        }
        _ => return None,
    }
    Some(found)
}
