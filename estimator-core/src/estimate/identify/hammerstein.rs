//! The quasi-linear law by two recursive least squares in cascade, (39)–(42).
//!
//! Γ₁ estimates the elastic response F⁽ᵉ⁾ = γ₁δ^γ₂ from y₁ = ln F, φ₁ = [1, ln δ], θ₁ = [ln γ₁, γ₂],
//! weighted, from the samples that press faster than δ̇*: there nothing has relaxed yet.
//! Γ₂ estimates the filter from y₂ = F − F̂⁽ᵉ⁾ and φ₂ = [F(h−1)…, F̂⁽ᵉ⁾(h−1)…] of all the others.
//!
//! Γ₂ is written in differences of z = F − F̂⁽ᵉ⁾, the same model for the same data; for r = 1
//! (z(h) − z(h−1))/T = −α·z(h−1) + β·F̂⁽ᵉ⁾(h−1), a₁ = αT − 1, b₁ = βT − 1 + αT.
//! At 1 kHz a mode of 0.1/s is a pole at 0.9999, whose distance from 1 single precision keeps to
//! three digits. And it looks at means over half of the filter's memory (r = 1, 10 ms by default) or
//! ten times as long (r = 2, whose second differences amplify noise with 1/T²).

mod block;

use block::Block;
use nalgebra::{Matrix2, SVector, Vector2, Vector3};

use super::equation_error::{Equation, EquationError};
use super::hunt_crossley::LOG_SIGMAS;
use super::kelvin_voigt::size;
use super::modes::{Pace, Relaxing, one_mode, two_modes};
use super::params::{IdentifyParams, SPEED_PER_DEPTH};
use super::{ForceNoise, Identify, Instant};
use crate::estimate::config::Weight;
use crate::estimate::monitor::ParameterEstimate;
use crate::estimate::record::PARAMETER_SLOTS;
use crate::maths::{Dual, Real, Scalar};
use crate::physics::law::RelaxationMode;

/// Periods of r = 2 over those of r = 1. Measured on modes of 2/s and 0.1/s in a hold of 50 s: noise
/// in the regressors makes the fast rate 65 % too high at ten times, 48 % at twenty, 16 % at forty.
const SLOWER_FOR_TWO: u32 = 40;
/// F̂⁽ᵉ⁾ is a power within these bounds, so that no start makes a number that single precision
/// cannot hold.
const EXPONENT: (f64, f64) = (0.3, 4.0);
/// |ln γ₁| in units of the reference force is at most this.
const LOG_STIFFNESS: f64 = 20.0;

/// Γ₁ takes depths of at least this many half windows of the filter: there the mean of δⁿ over the
/// window exceeds the power of the mean δ by n(n−1)/2·0.2/16, 0.5 % at n = 3/2.
const WINDOWS: f64 = 4.0;
/// Variance of the filter's window over the square of its half width: ⅕ of a parabola.
const WINDOW_VARIANCE: f64 = 0.2;

/// What is not noise but wrong in every sample alike, as Γ₂ sees it: ln γ₁, γ₂ and the surface.
const CONSIDERED: usize = 3;

/// The chapter's estimator with `R` modes, scaled; `N` = 2R. See [`Cascade1`] and [`Cascade2`].
#[derive(Clone, Debug)]
pub struct Cascade<T: Real, const R: usize, const N: usize> {
    gamma_1: EquationError<T, 2, 3>,
    gamma_2: EquationError<T, N, CONSIDERED>,
    relaxing: Relaxing<T>,
    modes: Option<[RelaxationMode<T>; R]>,
    pace: Pace<T>,
    weight: Weight,
    loading_speed: T,
    /// Half of what the filter remembers, by which a speed is a depth.
    window: T,
    pushed: bool,
    /// Samples that the filter remembers.
    memory: u32,
    /// Nothing has been touched yet.
    fresh: bool,
    /// The last periods, newest first.
    past: [Block<T>; R],
    /// How many of them belong to this run of samples.
    known: usize,
    /// The sum of the period that is under way, and the samples in it.
    sum: Block<T>,
    summed: u32,
}

/// One relaxation mode.
pub type Cascade1<T> = Cascade<T, 1, 2>;
/// Two relaxation modes.
pub type Cascade2<T> = Cascade<T, 2, 4>;

impl<T: Real, const R: usize, const N: usize> Cascade<T, R, N> {
    /// θ̂(0) and P(0) from the configuration; nothing relaxes to begin with.
    pub fn new(params: &IdentifyParams<T>) -> Self {
        let start = params.start;
        let least = T::from_f64(libm::exp(-LOG_STIFFNESS));
        let log_stiffness = least.max_of(start.stiffness).ln();
        let filter = Pace::new(params);
        let pace = if R == 1 {
            filter
        } else {
            filter.slower(SLOWER_FOR_TWO)
        };
        Cascade {
            gamma_1: EquationError::new(
                Vector2::new(log_stiffness, start.exponent),
                start.covariance,
            ),
            gamma_2: EquationError::new(SVector::repeat(T::zero()), start.covariance),
            relaxing: Relaxing::new(pace),
            modes: None,
            pace,
            weight: params.cascade.weight,
            loading_speed: params.cascade.loading_speed,
            window: filter.period_s() * T::from_f64(SPEED_PER_DEPTH),
            pushed: false,
            memory: params.memory_samples,
            fresh: true,
            past: [Block::empty(); R],
            known: 0,
            sum: Block::empty(),
            summed: 0,
        }
    }

    /// cᵢ and νᵢ (1/s), fast to slow; `None` while the poles of Γ₂ are not those of a relaxation.
    pub fn modes(&self) -> Option<[RelaxationMode<T>; R]> {
        self.modes
    }

    /// ln γ̂₁ and γ̂₂ within their bounds.
    fn elastic_law(&self) -> (T, T) {
        let theta = &self.gamma_1.rls.theta;
        let within = |value: T, low: f64, high: f64| {
            let raised = T::from_f64(low).max_of(value);
            let high = T::from_f64(high);
            if raised > high { high } else { raised }
        };
        (
            within(theta.x, -LOG_STIFFNESS, LOG_STIFFNESS),
            within(theta.y, EXPONENT.0, EXPONENT.1),
        )
    }

    /// F̂⁽ᵉ⁾ at a depth d > 0 and what is left of the force there.
    fn block(&self, at: &Instant<T>) -> Block<T> {
        let (log_stiffness, exponent) = self.elastic_law();
        let log_depth = at.depth.ln();
        let elastic = (log_stiffness + exponent * log_depth).exp();
        Block {
            relaxed: at.force - elastic,
            elastic,
            gradient: Vector3::new(
                elastic,
                elastic * log_depth,
                -(exponent * elastic / at.depth),
            ),
        }
    }

    /// What φ₂ is made of: derivatives of z, and of F̂⁽ᵉ⁾, highest first. The delta operator looks
    /// forward: all of them are those of the oldest period.
    fn derivatives(&self, now: &Block<T>, per_s: T) -> ([Block<T>; R], [Block<T>; R]) {
        let (mut of_z, mut of_elastic) = (self.past, self.past);
        if let ([newest, oldest], [e_newest, e_oldest]) =
            (of_z.as_mut_slice(), of_elastic.as_mut_slice())
        {
            let (rate, rate_after) = (newest.rate(oldest, per_s), now.rate(newest, per_s));
            // F̂⁽ᵉ⁾ in the middle of the step: a fast mode would be off by νT/2 without.
            *e_oldest = oldest.middle(newest);
            *e_newest = rate.middle(&rate_after);
            *newest = rate;
        }
        (of_z, of_elastic)
    }

    fn regressor(of_z: &[Block<T>; R], of_elastic: &[Block<T>; R]) -> SVector<T, N> {
        let relaxed = of_z.iter().map(|block| -block.relaxed);
        let elastic = of_elastic.iter().map(|block| block.elastic);
        let mut phi = SVector::<T, N>::repeat(T::zero());
        for (slot, value) in phi.iter_mut().zip(relaxed.chain(elastic)) {
            *slot = value;
        }
        phi
    }

    /// The highest difference quotient of z that ends with `now`: ẏ for r = 1, z̈ for r = 2.
    fn output(&self, now: &Block<T>, per_s: T) -> Block<T> {
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

    fn equation(&self, now: &Block<T>, per_s: T) -> Equation<T, N, CONSIDERED> {
        let (of_z, of_elastic) = self.derivatives(now, per_s);
        let phi = Self::regressor(&of_z, &of_elastic);
        let y = self.output(now, per_s);
        // ε = y − φᵀθ; an error of F̂⁽ᵉ⁾ is one of z with the other sign.
        let mut by_considered = -y.gradient;
        let wrong = of_z.iter().chain(&of_elastic);
        for (coefficient, block) in self.gamma_2.rls.theta.iter().zip(wrong) {
            by_considered -= block.gradient * *coefficient;
        }
        Equation {
            phi,
            y: y.relaxed,
            by_noise: self.by_noise(per_s),
            by_considered,
        }
    }

    /// ∂ε of Γ₁ by what it neglects: the surface; Σcᵢνᵢ, since δ ∝ t and F⁽ᵉ⁾ ∝ tⁿ lose Σcᵢνᵢ·t/(n+1)
    /// on the way; and the filter's window, over which the mean of δⁿ is more than (the mean of δ)ⁿ.
    fn wrong_with_elastic(&self, at: &Instant<T>) -> Vector3<T> {
        let n = self.elastic_law().1;
        let time_s = at.depth / (at.speed * T::from_f64(SPEED_PER_DEPTH));
        let window = at.speed * self.window / at.depth;
        Vector3::new(
            n / at.depth,
            -time_s / (n + T::one()),
            T::from_f64(0.5 * WINDOW_VARIANCE) * n * (n - T::one()) * window * window,
        )
    }

    /// Covariance of θ̂₁ by noise and by what Γ₁ neglects, without the surface.
    fn elastic_covariance(&self, noise: &ForceNoise<T>) -> Matrix2<T> {
        let covariance = self.gamma_1.covariance(noise.raw * noise.raw);
        let shift = self.gamma_1.shift();
        let mut decay = T::zero();
        for mode in self.modes.iter().flatten() {
            decay += mode.fraction * mode.rate_per_s;
        }
        let relaxed = shift.column(1) * decay;
        let window = shift.column(2);
        covariance + relaxed * relaxed.transpose() + window * window.transpose()
    }

    /// Γ₁, (39)–(40).
    fn learn_elastic(
        &mut self,
        params: &IdentifyParams<T>,
        at: &Instant<T>,
        noise: &ForceNoise<T>,
    ) {
        // The filter takes means of F and of δ; of a power that is the same only where the window
        // is short against the depth.
        let window = at.speed * self.window;
        let short = window * T::from_f64(WINDOWS) < at.depth;
        if !short || at.force <= T::from_f64(LOG_SIGMAS) * noise.filtered {
            return;
        }
        let weight = match self.weight {
            Weight::Force => at.force,
            Weight::ForceSquared => at.force * at.force,
        };
        let per_force = T::one() / at.force;
        let equation = Equation {
            phi: Vector2::new(T::one(), at.depth.ln()),
            y: at.force.ln(),
            by_noise: [per_force, T::zero(), T::zero()],
            by_considered: self.wrong_with_elastic(at),
        };
        // Γ₁ forgets by its own error: F̂ of the cascade follows F whatever the elastic response.
        let error = self.block(at).relaxed;
        let beta = params.forgetting.beta(
            error * params.scale.force_n,
            noise.raw * params.scale.force_n,
        );
        self.gamma_1.update(&equation, beta, weight);
    }

    /// Γ₂, (41)–(42), at the end of a period.
    fn learn_filter(
        &mut self,
        params: &IdentifyParams<T>,
        now: &Block<T>,
        noise: &ForceNoise<T>,
        beta: T,
    ) {
        let period_s = self.pace.period_s();
        let per_s = T::one() / period_s;
        let equation = self.equation(now, per_s);
        let force = now.relaxed + now.elastic;
        let phi = [force, now.elastic, T::zero()];
        let sigma = self.pace.variance(noise).sqrt();
        let gate = self
            .relaxing
            .admits(phi, force, params.excitation_step, sigma, beta);
        if let Some(beta) = gate {
            self.gamma_2.update(&equation, beta, T::one());
            self.modes = modes(self.gamma_2.rls.theta.as_slice(), period_s);
        } else {
            self.gamma_2.break_off();
        }
    }

    /// Closes the period that is under way, if it is full.
    fn take_period(&mut self) -> Option<Block<T>> {
        if self.summed < self.pace.samples {
            return None;
        }
        let share = T::one() / T::from_f64(f64::from(self.summed));
        let mean = Block::empty().plus(&self.sum, share);
        self.sum = Block::empty();
        self.summed = 0;
        Some(mean)
    }

    /// Two modes are told apart by how the relaxation sets in: the first touch starts from a free
    /// material, F = F⁽ᵉ⁾ = 0, which is also what the filter's window still held of it.
    fn start_at_rest(&mut self) {
        self.fresh = false;
        self.past = [Block::empty(); R];
        self.known = R;
        self.summed = self.memory;
    }

    fn forget_run(&mut self) {
        if self.known > 0 {
            self.gamma_2.break_off();
        }
        self.known = 0;
        self.sum = Block::empty();
        self.summed = 0;
    }

    fn is_loading(&self, at: &Instant<T>) -> bool {
        at.speed > self.loading_speed
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

impl<T: Real, const R: usize, const N: usize> Identify<T> for Cascade<T, R, N> {
    /// F̂ = F̂⁽ᵉ⁾ + ẑ, with z from the last period on.
    fn predict(&self, at: &Instant<T>, noise: &ForceNoise<T>, surface_error: T) -> (T, T) {
        if at.depth <= T::zero() {
            return (T::zero(), T::zero());
        }
        let block = self.block(at);
        let elastic = self.elastic_covariance(noise);
        let gradient = Vector2::new(block.gradient.x, block.gradient.y);
        let by_surface = block.gradient.z * surface_error;
        let of_elastic = gradient.dot(&(elastic * gradient)) + by_surface * by_surface;
        let Some(last) = self.past.first().filter(|_| self.known > 0) else {
            return (block.elastic, of_elastic);
        };
        // From the middle of the last period.
        let half = T::from_f64(0.5);
        let since = T::from_f64(f64::from(self.summed + 1));
        let elapsed_s = self.pace.sample_s * since + half * self.pace.period_s();
        let per_s = T::one() / self.pace.period_s();
        let slope = if self.known < R {
            T::zero()
        } else {
            let (of_z, of_elastic) = self.derivatives(&block, per_s);
            let phi = Self::regressor(&of_z, &of_elastic);
            let highest = self.gamma_2.rls.predict(&phi);
            match of_z.as_slice() {
                [rate, _] => rate.relaxed + highest * self.pace.period_s(),
                _ => highest,
            }
        };
        // What F̂⁽ᵉ⁾ is off by is in z as well, and cancels where the depth stays.
        let moved = T::one() - last.elastic / block.elastic;
        (
            block.elastic + last.relaxed + slope * elapsed_s,
            noise.filtered * noise.filtered + of_elastic * moved * moved,
        )
    }

    fn learn(
        &mut self,
        params: &IdentifyParams<T>,
        at: &Instant<T>,
        noise: &ForceNoise<T>,
        beta: T,
    ) -> Option<T> {
        if at.depth <= T::zero() || !self.pushed {
            return None;
        }
        if self.is_loading(at) {
            self.learn_elastic(params, at, noise);
            if R == 1 {
                // While θ̂₁ moves, z of two periods would belong to two elastic responses.
                self.forget_run();
                return Some(beta);
            }
        }
        if R > 1 && self.fresh {
            self.start_at_rest();
        }
        self.sum = self.sum.plus(&self.block(at), T::one());
        self.summed += 1;
        if let Some(now) = self.take_period() {
            if self.known >= R {
                self.learn_filter(params, &now, noise, beta);
            }
            self.past.rotate_right(1);
            if let Some(first) = self.past.first_mut() {
                *first = now;
            }
            self.known = (self.known + 1).min(R);
        }
        // A prediction over two long periods is none for a stroke that is over in less.
        let told = R == 1 || at.speed.abs() < self.loading_speed;
        told.then_some(beta)
    }

    fn admit(&mut self, pushed: bool) {
        self.pushed = pushed;
        if !pushed {
            self.forget_run();
        }
    }

    fn reset_covariance(&mut self, params: &IdentifyParams<T>) {
        self.gamma_1.reset_covariance(params.start.covariance);
        self.gamma_2.reset_covariance(params.start.covariance);
        self.forget_run();
    }

    fn estimates(
        &self,
        noise: &ForceNoise<T>,
        surface_error: T,
    ) -> [ParameterEstimate<T>; PARAMETER_SLOTS] {
        let mut estimates = [ParameterEstimate::default(); PARAMETER_SLOTS];
        let elastic = self.elastic_covariance(noise);
        let moved = self.gamma_1.shift().column(0) * surface_error;
        let (log_stiffness, exponent) = self.elastic_law();
        let theta = &self.gamma_1.rls.theta;
        let stiffness = log_stiffness.exp();
        let sizes = [
            (stiffness, stiffness, size(stiffness, stiffness)),
            (exponent, T::one(), T::one()),
        ];
        let bounded = log_stiffness != theta.x || exponent != theta.y;
        let blind = self.gamma_1.ignorance() > T::from_f64(0.1);
        for (i, (slot, (value, gain, scale))) in estimates.iter_mut().zip(sizes).enumerate() {
            let variance = elastic.get((i, i)).copied().unwrap_or_default();
            let shift = moved.get(i).copied().unwrap_or_default();
            *slot = ParameterEstimate {
                value,
                std_error: gain * (variance + shift * shift).sqrt(),
                scale: if bounded || blind { T::zero() } else { scale },
            };
        }
        self.estimate_modes(
            estimates.get_mut(2..).unwrap_or_default(),
            noise,
            surface_error,
        );
        estimates
    }
}

impl<T: Real, const R: usize, const N: usize> Cascade<T, R, N> {
    /// cᵢ and νᵢ with the errors that noise, Γ₁ and the surface give them.
    fn estimate_modes(
        &self,
        estimates: &mut [ParameterEstimate<T>],
        noise: &ForceNoise<T>,
        surface_error: T,
    ) {
        let mut index = 0..N;
        let dual = self
            .gamma_2
            .rls
            .theta
            .map(|value| Dual::<T, N>::parameter(value, index.next().unwrap_or(N)));
        let Some(found) = modes::<_, R>(dual.as_slice(), Dual::constant(self.pace.period_s()))
        else {
            return;
        };
        let covariance = self.gamma_2.covariance(self.pace.variance(noise));
        let shift = self.gamma_2.shift();
        let elastic = self.elastic_covariance(noise);
        let by_surface = self.gamma_1.shift();
        let parameters = found.iter().flat_map(|mode| {
            [
                (mode.fraction, T::one()),
                (mode.rate_per_s, mode.rate_per_s.value),
            ]
        });
        for (slot, (dual, scale)) in estimates.iter_mut().zip(parameters) {
            let gradient = SVector::<T, N>::from(dual.gradient);
            let considered = shift.tr_mul(&gradient);
            let by_elastic = Vector2::new(considered.x, considered.y);
            let moved = (considered.z + by_elastic.dot(&by_surface.column(0))) * surface_error;
            let variance = gradient.dot(&(covariance * gradient))
                + by_elastic.dot(&(elastic * by_elastic))
                + moved * moved;
            *slot = ParameterEstimate {
                value: dual.value,
                std_error: T::zero().max_of(variance).sqrt(),
                scale,
            };
        }
    }
}

#[cfg(test)]
mod tests;
