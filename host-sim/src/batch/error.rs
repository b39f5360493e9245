//! Standard errors that hold when the residuals do not forget from sample to sample.
//!
//! White residuals would give C = H⁻¹·max(1, χ²/(N − p)), H = Σ w JJᵀ: not less than what the noise
//! and the steps of the encoder leave, see the weights in `select`. Residuals of a law that does not fit,
//! of hum, or of an encoder's steps smoothed are correlated, and C then promises too much: the
//! sandwich H⁻¹MH⁻¹ with Newey & West's M = Σ κ(l)Σ s(h)s(h−l)ᵀ, s = w r J, κ Bartlett's window,
//! counts what the neighbours repeat. Where a law leaves more than noise, its remainder is no noise at
//! all but a curve that lasts for as long as the correlation time τ, of which the sandwich sees too few
//! periods: a fit then has N/τ independent residuals, and C·τ. Of all the largest variance is reported.

use estimator_core::estimate::Estimated;
use estimator_core::maths::Dual;

use super::{blocks::Node, fit::Problem, fit::of_size, natural::natural};
use crate::estimate::NOISE_ALONE;
use crate::lsq::{covariance::inverse, covariance::newey_west, dense};
use crate::stats::{correlation, rms};

/// Lags of the sandwich, in correlation times; and their bounds.
const LAGS: f64 = 3.0;
const FEWEST_LAGS: usize = 4;
const MOST_LAGS: usize = 150;
/// Smallest ridge of the inverse.
const RIDGE: f64 = 1e-13;

/// Covariances of the free numbers.
#[derive(Clone, Debug)]
pub(super) struct Covariance {
    size: usize,
    white: Vec<f64>,
    /// What the variances of a coloured remainder are over the white ones.
    coloured: f64,
    sandwich: Vec<f64>,
    /// What is left open besides the data.
    open: Vec<f64>,
    /// √(χ²/(N − p)): residuals over what they should be.
    pub(super) misfit: f64,
}

impl Problem<'_> {
    /// √w·r of every node that counts.
    pub(super) fn residuals(&self, free: &[f64]) -> Vec<f64> {
        let mut residuals = Vec::new();
        self.along(free, |node, weight, force| {
            residuals.push(weight.sqrt() * (node.force_n - force));
        });
        residuals
    }

    /// Root of the mean square of the residuals over the noise alone (1).
    pub(super) fn remainder(&self, free: &[f64]) -> f64 {
        let mut residuals = Vec::new();
        self.along(free, |node, _, force| {
            residuals.push((node.force_n - force) / self.scales.noise_n);
        });
        rms(residuals)
    }

    /// Covariances at a minimum.
    pub(super) fn covariance(&self, free: &[f64]) -> Covariance {
        of_size!(self, covariance_of(free))
    }

    fn covariance_of<const N: usize>(&self, free: &[f64]) -> Covariance {
        let (mut scores, mut residuals) = (Vec::new(), Vec::new());
        self.gradients::<N>(free, |_, weight, residual, gradient| {
            scores.push(gradient.map(|slope| slope * weight * residual));
            residuals.push(weight.sqrt() * residual);
        });
        let normal = self.normal(free);
        let own = N - self.fixed.len();
        let correlation = correlation(&residuals);
        let misfit = (normal.cost / residuals.len().saturating_sub(own).max(1) as f64).sqrt();
        let fixed: [bool; N] = std::array::from_fn(|i| self.fixed.contains(&i));
        // Nothing is known of directions that the data do not touch, and everything of what is fixed.
        // Of a curvature that is not finite nothing is known at all.
        let unknown = |at: usize| {
            if at.is_multiple_of(N + 1) {
                f64::MAX
            } else {
                0.0
            }
        };
        let inverse = inverse(&normal.curvature, &fixed, RIDGE)
            .unwrap_or_else(|| (0..N * N).map(unknown).collect());
        // Behind a low-pass the noise is a curve, too.
        let is_curve = self.scales.low_pass.is_some() || self.remainder(free) > NOISE_ALONE;
        let coloured = match is_curve {
            true => correlation.max(1.0),
            false => 1.0,
        };
        let lags = (LAGS * correlation).ceil() as usize;
        let lags = lags.clamp(FEWEST_LAGS, MOST_LAGS).min(scores.len() / 4);
        let middle = newey_west(&scores, lags);
        Covariance {
            size: N,
            coloured,
            open: vec![0.0; N * N],
            sandwich: dense::product(&dense::product(&inverse, &middle, N), &inverse, N),
            white: inverse
                .iter()
                .map(|c| c * misfit.max(1.0).powi(2))
                .collect(),
            misfit,
        }
    }

    /// How far the free numbers go for what else a law does in another problem of as many nodes.
    fn moved_by<const N: usize>(
        &self,
        free: &[f64],
        covariance: &Covariance,
        other: &Problem,
    ) -> Vec<f64> {
        let other_n = other.forces(free);
        let mut slopes = Vec::new();
        self.gradients::<N>(free, |node, weight, residual, gradient| {
            slopes.push((weight, node.force_n - residual, *gradient));
        });
        let mut both = [0.0; N];
        for ((weight, own_n, gradient), other_n) in slopes.iter().zip(other_n) {
            for (sum, slope) in both.iter_mut().zip(gradient) {
                *sum += weight * slope * (other_n - own_n);
            }
        }
        // What is white is the inverse times the square of the misfit, where that is above 1.
        let scale = covariance.misfit.max(1.0).powi(2);
        let inverse = covariance.white.chunks(N);
        inverse
            .map(|row| row.iter().zip(&both).map(|(a, b)| a * b).sum::<f64>() / scale)
            .collect()
    }

    /// The parameters with their standard errors at a reference depth; then the offset and the skew.
    pub(super) fn reported(
        &self,
        free: &[f64],
        covariance: &Covariance,
        depth_m: f64,
    ) -> Vec<Estimated<f64>> {
        of_size!(self, reported_of(free, covariance, depth_m))
    }

    fn reported_of<const N: usize>(
        &self,
        free: &[f64],
        covariance: &Covariance,
        depth_m: f64,
    ) -> Vec<Estimated<f64>> {
        let dual: [Dual<f64, N>; N] = std::array::from_fn(|i| Dual::parameter(free[i], i));
        let law = natural(self.family, &dual, self.scales);
        let mut values = law.reported(self.family, depth_m);
        values.extend([law.offset_n, law.skew_s]);
        let estimated = values.into_iter().map(|value| Estimated {
            value: value.value,
            std_error: covariance.std_error(&value.gradient),
        });
        estimated.collect()
    }
}

impl Covariance {
    /// Adds what leaves a free number open besides the data: a standard deviation, which moves the others
    /// with it as their covariance has it.
    pub(super) fn widened(mut self, at: usize, by: f64) -> Covariance {
        let n = self.size;
        let own = self.white[at * n + at];
        if by > 0.0 && own > 0.0 && own.is_finite() {
            let moves: Vec<f64> = (0..n).map(|i| self.white[i * n + at] / own).collect();
            for (i, entry) in self.open.iter_mut().enumerate() {
                *entry += by * by * moves[i / n] * moves[i % n];
            }
        }
        self
    }

    /// Adds what a law leaves open that may have gone anything between its own nodes and others, which are as likely.
    pub(super) fn opened(self, problem: &Problem, free: &[f64], others: &[Node]) -> Covariance {
        let other = Problem {
            nodes: others,
            ..*problem
        };
        self.opened_by(problem, free, &other, 1.0 / 3.0)
    }

    /// Adds what is left open between a problem and another: a variance of so much of the square of the way between them.
    pub(super) fn opened_by(
        mut self,
        problem: &Problem,
        free: &[f64],
        other: &Problem,
        share: f64,
    ) -> Covariance {
        let moves = of_size!(problem, moved_by(free, &self, other));
        let n = self.size;
        for (i, entry) in self.open.iter_mut().enumerate() {
            *entry += share * moves[i / n] * moves[i % n];
        }
        self
    }

    /// Standard error of a quantity with this gradient by the free numbers.
    fn std_error(&self, gradient: &[f64]) -> f64 {
        debug_assert_eq!(gradient.len(), self.size);
        let white = self.coloured * dense::quadratic(&self.white, gradient);
        let sandwich = dense::quadratic(&self.sandwich, gradient);
        let open = dense::quadratic(&self.open, gradient);
        (white.max(sandwich) + open).max(0.0).sqrt()
    }
}
