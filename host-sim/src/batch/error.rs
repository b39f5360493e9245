//! Standard errors that hold when the residuals do not forget from sample to sample.
//!
//! White residuals would give C = H⁻¹·max(1, χ²/(N − p)), H = Σ w JJᵀ: not less than what the noise
//! and the steps of the encoder leave, see the weights in `select`. Residuals of a law that does not fit,
//! of hum, or of an encoder's steps smoothed are correlated, and C then promises too much: the
//! sandwich H⁻¹MH⁻¹ with Newey & West's M = Σ κ(l)Σ s(h)s(h−l)ᵀ, s = w r J, κ Bartlett's window,
//! counts what the neighbours repeat. Of both the larger variance is reported.

use estimator_core::estimate::Estimated;
use estimator_core::maths::Dual;

use super::{family::natural, fit::Problem};
use crate::dense;
use crate::stats::correlation;

/// Lags of the sandwich, in correlation times; and their bounds.
const LAGS: f64 = 3.0;
const FEWEST_LAGS: usize = 4;
const MOST_LAGS: usize = 150;

/// Covariances of the free numbers.
#[derive(Clone, Debug)]
pub(super) struct Covariance {
    size: usize,
    white: Vec<f64>,
    sandwich: Vec<f64>,
    /// √(χ²/(N − p)): residuals over what they should be.
    pub(super) misfit: f64,
}

impl Problem<'_> {
    /// √w·r of every node that counts.
    pub(super) fn residuals(&self, free: &[f64]) -> Vec<f64> {
        let mut weights = self.weights.iter();
        let mut residuals = Vec::new();
        let law = natural(self.family, free, self.scales);
        law.along(self.family, self.nodes, |node, force| {
            let weight = weights.next().copied().unwrap_or(0.0);
            if weight > 0.0 {
                residuals.push(weight.sqrt() * (node.force_n - force));
            }
        });
        residuals
    }

    /// Covariances at a minimum.
    pub(super) fn covariance(&self, free: &[f64]) -> Covariance {
        match self.family.free() {
            4 => self.covariance_of::<4>(free),
            5 => self.covariance_of::<5>(free),
            6 => self.covariance_of::<6>(free),
            8 => self.covariance_of::<8>(free),
            10 => self.covariance_of::<10>(free),
            _ => self.covariance_of::<12>(free),
        }
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
        let inverse = regular_inverse(&normal.curvature, N, self.fixed);
        let lags = (LAGS * correlation).ceil() as usize;
        let lags = lags.clamp(FEWEST_LAGS, MOST_LAGS).min(scores.len() / 4);
        let middle = newey_west(&scores, lags);
        Covariance {
            size: N,
            sandwich: dense::product(&dense::product(&inverse, &middle, N), &inverse, N),
            white: inverse
                .iter()
                .map(|c| c * misfit.max(1.0).powi(2))
                .collect(),
            misfit,
        }
    }

    /// The parameters with their standard errors at a reference depth; then the offset and the skew.
    pub(super) fn reported(
        &self,
        free: &[f64],
        covariance: &Covariance,
        depth_m: f64,
    ) -> Vec<Estimated<f64>> {
        match self.family.free() {
            4 => self.reported_of::<4>(free, covariance, depth_m),
            5 => self.reported_of::<5>(free, covariance, depth_m),
            6 => self.reported_of::<6>(free, covariance, depth_m),
            8 => self.reported_of::<8>(free, covariance, depth_m),
            10 => self.reported_of::<10>(free, covariance, depth_m),
            _ => self.reported_of::<12>(free, covariance, depth_m),
        }
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
    /// Standard error of a quantity with this gradient by the free numbers.
    fn std_error(&self, gradient: &[f64]) -> f64 {
        debug_assert_eq!(gradient.len(), self.size);
        let white = dense::quadratic(&self.white, gradient);
        let sandwich = dense::quadratic(&self.sandwich, gradient);
        white.max(sandwich).max(0.0).sqrt()
    }
}

/// The inverse, with nothing known of directions that the data do not touch, and everything of what
/// is fixed.
fn regular_inverse(curvature: &[f64], n: usize, fixed: &[usize]) -> Vec<f64> {
    let scale: Vec<f64> = (0..n)
        .map(|i| curvature[i * n + i].max(f64::MIN_POSITIVE).sqrt())
        .collect();
    let mut ridge = 1e-13;
    loop {
        let mut scaled: Vec<f64> = (0..n * n)
            .map(|at| curvature[at] / (scale[at / n] * scale[at % n]))
            .collect();
        for i in 0..n {
            scaled[i * n + i] = if fixed.contains(&i) { 1.0 } else { 1.0 + ridge };
        }
        if let Some(factor) = dense::cholesky(&scaled, n) {
            let mut inverse = dense::inverse(&factor, n);
            for (at, entry) in inverse.iter_mut().enumerate() {
                let (row, column) = (at / n, at % n);
                *entry = if fixed.contains(&row) || fixed.contains(&column) {
                    0.0
                } else {
                    *entry / (scale[row] * scale[column])
                };
            }
            return inverse;
        }
        ridge *= 10.0;
    }
}

/// Σ over lags of the products of scores, weighted by 1 − lag/(lags + 1).
fn newey_west<const N: usize>(scores: &[[f64; N]], lags: usize) -> Vec<f64> {
    let mut middle = vec![0.0; N * N];
    for lag in 0..=lags {
        let window = 1.0 - lag as f64 / (lags + 1) as f64;
        let window = if lag == 0 { 0.5 } else { window };
        for (now, then) in scores.get(lag..).unwrap_or_default().iter().zip(scores) {
            for row in 0..N {
                for column in 0..N {
                    let both = now[row] * then[column] + now[column] * then[row];
                    middle[row * N + column] += window * both;
                }
            }
        }
    }
    middle
}
