//! Non-linear least squares: Levenberg–Marquardt on normal equations that one pass over the course
//! accumulates, with the exact gradients of dual numbers.
//!
//! A kept crate wants the whole Jacobian at once: 100 000 rows of 12 are 10 MB a step, and the normal
//! equations of them are all that a step needs.

use estimator_core::maths::Dual;

use super::{course::Node, course::Scales, family::Family, family::natural};
use crate::dense;

/// Most steps. Typical are 6 to 15 from a start of `start`.
const MOST_STEPS: usize = 60;
/// Converged: a step promises less than this of Σ w r²; 1 is worth one standard error.
const STILL: f64 = 1e-6;
/// And less than this share of it: where no law fits, Σ w r² is large, and so is its rounding.
const LEAST_SHARE: f64 = 1e-10;
/// Free numbers stay within this: e^15 of the scales are no contact.
const BOUND: f64 = 15.0;

/// What is fitted to what.
#[derive(Clone, Copy, Debug)]
pub(super) struct Problem<'a> {
    /// The law.
    pub(super) family: Family,
    /// Block means.
    pub(super) nodes: &'a [Node],
    /// A weight (1/N²) per node.
    pub(super) weights: &'a [f64],
    /// Sizes of the log.
    pub(super) scales: &'a Scales,
    /// Free numbers that stay, in order.
    pub(super) fixed: &'a [usize],
}

/// A minimum.
#[derive(Clone, Debug)]
pub(super) struct Fit {
    /// The law.
    pub(super) family: Family,
    /// The free numbers.
    pub(super) free: Vec<f64>,
    /// Σ w r².
    pub(super) cost: f64,
    /// Whether the steps came to an end.
    pub(super) converged: bool,
}

/// Cost, −½ of its gradient, and ½ of its second derivative (Gauss–Newton), row by row.
pub(super) struct Normal {
    pub(super) cost: f64,
    pub(super) downhill: Vec<f64>,
    pub(super) curvature: Vec<f64>,
}

impl Problem<'_> {
    /// Calls `each` with every node that counts, its weight, its residual (N) and the gradient of the
    /// force by the free numbers.
    pub(super) fn gradients<const N: usize>(
        &self,
        free: &[f64],
        mut each: impl FnMut(&Node, f64, f64, &[f64; N]),
    ) {
        let dual: [Dual<f64, N>; N] = std::array::from_fn(|i| {
            if self.fixed.contains(&i) {
                Dual::constant(free[i])
            } else {
                Dual::parameter(free[i], i)
            }
        });
        let mut weights = self.weights.iter();
        let law = natural(self.family, &dual, self.scales);
        law.along(self.family, self.nodes, |node, force| {
            let weight = weights.next().copied().unwrap_or(0.0);
            if weight > 0.0 {
                each(node, weight, node.force_n - force.value, &force.gradient);
            }
        });
    }

    /// Σ w r².
    pub(super) fn cost(&self, free: &[f64]) -> f64 {
        let mut weights = self.weights.iter();
        let mut cost = 0.0;
        let law = natural(self.family, free, self.scales);
        law.along(self.family, self.nodes, |node, force| {
            let weight = weights.next().copied().unwrap_or(0.0);
            if weight > 0.0 {
                cost += weight * (node.force_n - force).powi(2);
            }
        });
        cost + self.prior(free)
    }

    /// What departing from what is known before costs.
    fn prior(&self, free: &[f64]) -> f64 {
        let prior = self.family.prior();
        prior.map_or(0.0, |(at, weight)| weight * free[at] * free[at])
    }

    fn normal_of<const N: usize>(&self, free: &[f64]) -> Normal {
        let (mut cost, mut downhill, mut curvature) = (0.0, [0.0; N], [[0.0; N]; N]);
        self.gradients::<N>(free, |_, weight, residual, gradient| {
            cost += weight * residual * residual;
            for row in 0..N {
                let weighted = weight * gradient[row];
                downhill[row] += weighted * residual;
                for column in 0..=row {
                    curvature[row][column] += weighted * gradient[column];
                }
            }
        });
        if let Some((at, weight)) = self.family.prior()
            && !self.fixed.contains(&at)
        {
            downhill[at] -= weight * free[at];
            curvature[at][at] += weight;
        }
        let entry = |row: usize, column: usize| curvature[row.max(column)][row.min(column)];
        Normal {
            cost: cost + self.prior(free),
            downhill: downhill.to_vec(),
            curvature: (0..N * N).map(|at| entry(at / N, at % N)).collect(),
        }
    }

    /// The normal equations.
    pub(super) fn normal(&self, free: &[f64]) -> Normal {
        match self.family.free() {
            4 => self.normal_of::<4>(free),
            5 => self.normal_of::<5>(free),
            6 => self.normal_of::<6>(free),
            8 => self.normal_of::<8>(free),
            10 => self.normal_of::<10>(free),
            _ => self.normal_of::<12>(free),
        }
    }

    /// Walks from `start` to a minimum.
    pub(super) fn fit(&self, start: Vec<f64>) -> Fit {
        self.fit_to(start, STILL)
    }

    /// Walks from `start` until a step promises less than `still` of Σ w r².
    pub(super) fn fit_to(&self, start: Vec<f64>, still: f64) -> Fit {
        let mut free = start;
        let mut damping = 1e-3;
        let mut converged = false;
        let mut normal = self.normal(&free);
        for _ in 0..MOST_STEPS {
            let (step, promised) = self.step(&normal, damping);
            if promised <= still.max(LEAST_SHARE * normal.cost) {
                converged = true;
                break;
            }
            let moved: Vec<f64> = free
                .iter()
                .zip(&step)
                .map(|(value, step)| (value + step.clamp(-2.0, 2.0)).clamp(-BOUND, BOUND))
                .collect();
            let cost = self.cost(&moved);
            if cost < normal.cost {
                let gained = (normal.cost - cost) / promised;
                damping *= if gained > 0.75 { 0.1 } else { 0.5 };
                free = moved;
                normal = self.normal(&free);
            } else if damping > 1e8 {
                // No way down: rounding, or a jump of the law at a sample on the surface.
                converged = true;
                break;
            } else {
                damping = (damping * 8.0).max(1e-6);
            }
        }
        Fit {
            family: self.family,
            free,
            cost: normal.cost,
            converged,
        }
    }

    /// The step of damped normal equations, and what it promises to take from the cost.
    fn step(&self, normal: &Normal, damping: f64) -> (Vec<f64>, f64) {
        let n = normal.downhill.len();
        let mut damping = damping;
        let largest = (0..n)
            .map(|i| normal.curvature[i * n + i])
            .fold(0.0, f64::max);
        loop {
            let mut damped = normal.curvature.clone();
            for i in 0..n {
                let own = damped[i * n + i];
                // A number that changes nothing stays where it is.
                damped[i * n + i] = own * (1.0 + damping) + 1e-13 * largest + f64::MIN_POSITIVE;
            }
            if let Some(factor) = dense::cholesky(&damped, n) {
                let step = dense::solve(&factor, n, &normal.downhill);
                let along: f64 = step.iter().zip(&normal.downhill).map(|(s, g)| s * g).sum();
                let promised = 2.0 * along - dense::quadratic(&normal.curvature, &step);
                return (step, promised.max(0.0));
            }
            damping = (damping * 10.0).max(1e-9);
            if damping > 1e12 {
                return (vec![0.0; n], 0.0);
            }
        }
    }
}
