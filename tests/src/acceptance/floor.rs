//! The Cramér–Rao bound of a case, below which no unbiased estimator gets.
//!
//! Fisher information of the true law along the true motion, with the noise and the steps of both
//! sensors: each instant in contact adds ∇F·∇Fᵀ/R with R = σ² + q_F²/12 + (∂F/∂x)²·q_x²/12. The resting
//! force is unknown too, and each instant in free air adds 1/R for it. A surface that is told is known to
//! a count of the encoder, q_x/√12.

use nalgebra::{Matrix6, Vector6};

use super::cases::{Case, SECONDS};
use crate::tolerance::{CLOSE, SURE};

/// The step of the default force sensor (N).
const FORCE_STEP_N: f64 = 0.005;
/// The count of the default encoder (m).
const COUNT_M: f64 = 1e-6;
/// The bound is calculated at every sample of this many.
const EVERY: usize = 10;

/// The bound of one case.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Floor {
    /// Standard deviations of K, λ, n (relative) and of the surface (m).
    pub(crate) sigma: [f64; 4],
    /// The time (s) from the first touch until the 95 % intervals of K, λ, n are within 5 %.
    pub(crate) settles_s: f64,
}

impl Floor {
    /// The bound of a case whose surface is told if `known`.
    pub(crate) fn of(case: &Case, known: bool) -> Floor {
        Floor::skewed(case, known, 0.0)
    }

    /// The same where the skew of the sensors is unknown, too (`asked` 1).
    pub(crate) fn skewed(case: &Case, known: bool, asked: f64) -> Floor {
        let white = case.force_noise_n.powi(2) + FORCE_STEP_N.powi(2) / 12.0;
        let count_m2 = COUNT_M.powi(2) / 12.0;
        let mut information = Matrix6::zeros();
        if known {
            information[(3, 3)] = 1.0 / count_m2;
        }
        let mut settles_s = SECONDS;
        for index in 0..case.run.time_s.len() {
            match gradient(case, index, asked) {
                None => information[(4, 4)] += 1.0 / white,
                Some(by) => information += by * by.transpose() / (white + by[3].powi(2) * count_m2),
            }
            if settles_s == SECONDS && index % EVERY == 0 {
                let sigma = bound(information);
                if sigma.iter().take(3).all(|sigma| SURE * sigma < CLOSE) {
                    settles_s = case.run.time_s[index] - case.touched_s;
                }
            }
        }
        let mut sigma = bound(information);
        // The encoder leaves the true position of the surface open by a count.
        sigma[3] = sigma[3].hypot(if known { 0.0 } else { count_m2.sqrt() });
        Floor { sigma, settles_s }
    }

    /// The probability that K, λ and n are within `bound`, as if they were independent: λ decides.
    pub(crate) fn within(&self, bound: f64) -> f64 {
        let each = self.sigma.iter().take(3);
        each.map(|sigma| libm::erf(bound / sigma / std::f64::consts::SQRT_2))
            .product()
    }
}

/// The derivatives of F by ln K, ln λ, ln n, x₀, the resting force and, if `asked`, the skew (ms); `None` in free air.
fn gradient(case: &Case, index: usize, asked: f64) -> Option<Vector6<f64>> {
    let [stiffness, damping, exponent, surface_m] = case.truth;
    let depth = (case.run.position_m[index] - surface_m) / 1e-3;
    if depth <= 0.0 || case.run.force_n[index] <= 0.0 {
        return None;
    }
    let shape = depth.powf(exponent);
    let spring = stiffness * 1e-3 * shape;
    let damper = damping * case.run.velocity_mps[index] * shape;
    let force = spring + damper;
    let by_surface = -(exponent * force / depth / 1e-3);
    let next = (index + 1).min(case.run.force_n.len() - 1);
    let by_skew = -0.5 * asked * (case.run.force_n[next] - case.run.force_n[index.max(1) - 1]);
    Some(Vector6::new(
        spring,
        damper,
        force * depth.ln() * exponent,
        by_surface,
        1.0,
        by_skew,
    ))
}

fn bound(information: Matrix6<f64>) -> [f64; 4] {
    // Scaled to a unit diagonal: metres and logarithms differ by 10⁷.
    let scale = information
        .diagonal()
        .map(|d| if d > 0.0 { d.sqrt() } else { 1.0 });
    let scaled = Matrix6::from_fn(|i, j| match i == j {
        true => 1.0,
        false => information[(i, j)] / (scale[i] * scale[j]),
    });
    match scaled.try_inverse() {
        Some(inverse) => std::array::from_fn(|i| inverse[(i, i)].abs().sqrt() / scale[i]),
        None => [f64::INFINITY; 4],
    }
}
