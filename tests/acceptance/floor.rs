//! What no unbiased estimator can undercut: the Cramér–Rao bound of a case.
//!
//! Fisher information of the true law along the true motion, with the noise and the steps of both
//! sensors: each instant in contact tells ∇F·∇Fᵀ/R, R = σ² + q_F²/12 + (∂F/∂x)²·q_x²/12. The resting
//! force is unknown too; each instant in free air tells it. A told surface is known to a count of
//! the encoder, q_x/√12.

use nalgebra::{Matrix5, Vector5};

use super::cases::{Case, SECONDS};

/// Steps and noise of the default sensors: N, N, m.
const FORCE_NOISE_N: f64 = 0.02;
const FORCE_STEP_N: f64 = 0.005;
const COUNT_M: f64 = 1e-6;
/// Samples between two looks at how much is known.
const EVERY: usize = 10;
/// Half a 95 % interval, in standard deviations.
const SURE: f64 = 1.96;

/// The bound of one case.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Floor {
    /// Standard deviations of K, λ, n (relative) and of the surface (m).
    pub(crate) sigma: [f64; 4],
    /// From the first touch until 95 % intervals of K, λ, n are within 5 % (s).
    pub(crate) settles_s: f64,
}

impl Floor {
    /// Of a case, its surface told if `known`.
    pub(crate) fn of(case: &Case, known: bool) -> Floor {
        let white = FORCE_NOISE_N.powi(2) + FORCE_STEP_N.powi(2) / 12.0;
        let count_m2 = COUNT_M.powi(2) / 12.0;
        let mut information = Matrix5::zeros();
        if known {
            information[(3, 3)] = 1.0 / count_m2;
        }
        let mut settles_s = SECONDS;
        for index in 0..case.run.time_s.len() {
            match gradient(case, index) {
                None => information[(4, 4)] += 1.0 / white,
                Some(by) => information += by * by.transpose() / (white + by[3].powi(2) * count_m2),
            }
            if settles_s == SECONDS && index % EVERY == 0 {
                let sigma = bound(information);
                if sigma.iter().take(3).all(|sigma| SURE * sigma < 0.05) {
                    settles_s = case.run.time_s[index] - case.touched_s;
                }
            }
        }
        let mut sigma = bound(information);
        // Where the surface is in true metres, the encoder leaves open by its count.
        sigma[3] = sigma[3].hypot(if known { 0.0 } else { count_m2.sqrt() });
        Floor { sigma, settles_s }
    }

    /// Probability of K, λ and n within `bound`, as if they were independent: λ decides.
    pub(crate) fn within(&self, bound: f64) -> f64 {
        let each = self.sigma.iter().take(3);
        each.map(|sigma| libm::erf(bound / sigma / std::f64::consts::SQRT_2))
            .product()
    }
}

/// ∂F by ln K, ln λ, ln n, x₀ and the resting force; `None` in free air.
fn gradient(case: &Case, index: usize) -> Option<Vector5<f64>> {
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
    Some(Vector5::new(
        spring,
        damper,
        force * depth.ln() * exponent,
        by_surface,
        1.0,
    ))
}

fn bound(information: Matrix5<f64>) -> [f64; 4] {
    // Scaled to a unit diagonal: metres and logarithms differ by 10⁷.
    let scale = information
        .diagonal()
        .map(|d| if d > 0.0 { d.sqrt() } else { 1.0 });
    let scaled = Matrix5::from_fn(|i, j| information[(i, j)] / (scale[i] * scale[j]));
    match scaled.try_inverse() {
        Some(inverse) => std::array::from_fn(|i| inverse[(i, i)].abs().sqrt() / scale[i]),
        None => [f64::INFINITY; 4],
    }
}
