//! The weighted least squares of a law to the course: one pass over its nodes accumulates the normal
//! equations, with the exact gradients of dual numbers.

use estimator_core::maths::{Dual, scalar::Scalar};

use super::{blocks::Node, family::Family, natural::natural, scales::Scales};
use crate::lsq::NormalEquations;
use crate::lsq::minimize::{Limits, Minimizer, Stop, System};

/// Most steps. Typical are 6 to 15 from a start of `start`.
const MOST_STEPS: usize = 60;
/// Converged: a step promises less than this of Σ w r²; 1 is worth one standard error.
pub(super) const STILL: f64 = 1e-6;
/// And less than this share of Σ w r²: where no law fits, Σ w r² is large, and so is its rounding.
const LEAST_SHARE: f64 = 1e-10;
/// Where the free numbers may go: e^15 of the scales are no contact.
const LIMITS: Limits = Limits {
    lowest: -15.0,
    highest: 15.0,
    longest_step: 2.0,
};

/// Calls a method for as many dual numbers as the problem has free ones.
macro_rules! of_size {
    ($problem:ident, $method:ident($($argument:expr),*)) => {
        match $problem.family.free() {
            4 => $problem.$method::<4>($($argument),*),
            5 => $problem.$method::<5>($($argument),*),
            6 => $problem.$method::<6>($($argument),*),
            8 => $problem.$method::<8>($($argument),*),
            10 => $problem.$method::<10>($($argument),*),
            _ => $problem.$method::<12>($($argument),*),
        }
    };
}
pub(super) use of_size;

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

impl Problem<'_> {
    /// Calls `each` with every node that counts, its weight, its residual (N) and the gradient of the
    /// force by the free numbers.
    pub(super) fn gradients<const N: usize>(
        &self,
        free: &[f64],
        mut each: impl FnMut(&Node, f64, f64, &[f64; N]),
    ) {
        let dual: [Dual<f64, N>; N] = std::array::from_fn(|i| match self.fixed.contains(&i) {
            true => Dual::constant(free[i]),
            false => Dual::parameter(free[i], i),
        });
        self.along(&dual, |node, weight, force| {
            each(node, weight, node.force_n - force.value, &force.gradient);
        });
    }

    /// Calls `each` with every node that counts, its weight and the force (N) of the law.
    pub(super) fn along<S: Scalar>(&self, free: &[S], mut each: impl FnMut(&Node, f64, S)) {
        let mut weights = self.weights.iter();
        let law = natural(self.family, free, self.scales);
        law.along(self.family, self.nodes, |node, force| {
            let weight = weights.next().copied().unwrap_or(0.0);
            if weight > 0.0 {
                each(node, weight, force);
            }
        });
    }

    /// The force (N) of the law at every node that counts.
    pub(super) fn forces(&self, free: &[f64]) -> Vec<f64> {
        let mut forces = Vec::new();
        self.along(free, |_, _, force| forces.push(force));
        forces
    }

    /// Σ w r².
    pub(super) fn cost(&self, free: &[f64]) -> f64 {
        let mut cost = 0.0;
        self.along(free, |node, weight, force| {
            cost += weight * (node.force_n - force).powi(2);
        });
        cost + self.prior(free)
    }

    /// What departing from what is known before costs.
    fn prior(&self, free: &[f64]) -> f64 {
        let prior = self.family.prior();
        prior.map_or(0.0, |(at, weight)| weight * free[at] * free[at])
    }

    fn normal_of<const N: usize>(&self, free: &[f64]) -> NormalEquations {
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
        NormalEquations {
            cost: cost + self.prior(free),
            downhill: downhill.to_vec(),
            curvature: (0..N * N).map(|at| entry(at / N, at % N)).collect(),
        }
    }

    /// The normal equations.
    pub(super) fn normal(&self, free: &[f64]) -> NormalEquations {
        of_size!(self, normal_of(free))
    }

    /// Walks from `start` until a step promises less than `still` of Σ w r².
    pub(super) fn fit(&self, start: Vec<f64>, still: f64) -> Fit {
        let minimizer = Minimizer {
            limits: vec![LIMITS; start.len()],
            system: System::Plain,
            most_steps: MOST_STEPS,
            least_gain: still,
            least_share: LEAST_SHARE,
            most_damping: 1e8,
            raise: (8.0, 1e-6),
        };
        let minimum = minimizer.minimum(start, |free| self.cost(free), |free| self.normal(free));
        Fit {
            family: self.family,
            free: minimum.numbers,
            cost: minimum.cost,
            converged: minimum.stop != Stop::Budget,
        }
    }
}
