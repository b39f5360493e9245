//! Non-linear least squares of a rig to logs: Levenberg–Marquardt within bounds.
//!
//! It is written here because a crate for it has neither bounds nor a Jacobian that dual numbers fill a few
//! columns at a time.

use crate::dense;
use crate::gap::data::scales::Scales;
use crate::gap::model::{problem::NormalEquations, problem::Problem, shape::Shape, shape::Term};

/// Most steps of a fit.
pub(crate) const MOST_STEPS: usize = 40;
/// A fit has converged if a step promises less than this share of Σ w r², or less than `LEAST_GAIN` of it.
const LEAST_SHARE: f64 = 3e-5;
/// A gain of 1 in Σ w r² is worth one standard error.
const LEAST_GAIN: f64 = 1e-4;

/// The result of a fit.
#[derive(Clone, Debug)]
pub(crate) struct Fit {
    pub(crate) shape: Shape,
    /// The values of the free numbers of the shape.
    pub(crate) numbers: Vec<f64>,
    /// Σ w r².
    pub(crate) cost: f64,
}

impl Fit {
    /// The indices of the terms that the base model does not have.
    pub(crate) fn added(&self) -> Vec<usize> {
        (0..self.shape.terms.len())
            .filter(|at| !self.shape.terms[*at].given)
            .collect()
    }

    /// The law with other terms, and where a fit of them starts: the environment keeps its values.
    pub(crate) fn with_terms(&self, terms: Vec<Term>, scales: &Scales) -> (Shape, Vec<f64>) {
        let shape = Shape::new(&self.shape.base, terms, scales);
        let mut start = shape.start();
        let environment = shape.environment_count();
        start[..environment].copy_from_slice(&self.numbers[..environment]);
        (shape, start)
    }

    /// The law without one of its terms, and where a fit of it starts.
    pub(crate) fn without(&self, at: usize, scales: &Scales) -> (Shape, Vec<f64>) {
        let mut terms = self.shape.terms_at(&self.numbers);
        terms.remove(at);
        self.with_terms(terms, scales)
    }
}

impl Problem<'_> {
    /// Fits the free numbers of a shape from `start` on, within their bounds.
    pub(crate) fn fit(&self, shape: &Shape, start: Vec<f64>) -> Fit {
        self.fit_briefly(shape, start, MOST_STEPS)
    }

    /// The same with at most `most_steps` steps.
    pub(crate) fn fit_briefly(&self, shape: &Shape, start: Vec<f64>, most_steps: usize) -> Fit {
        let mut numbers = start;
        let mut damping = 1e-3;
        let mut linear = self.linearize(shape, &numbers);
        let mut cost = self.weighted_square(&linear.residuals);
        let mut normal = self.normal_equations(&linear);
        let mut steps = 0;
        while steps < most_steps {
            let blocked = blocked(shape, &numbers, &normal.downhill);
            let (step, promised) = damped_step(&normal, &blocked, damping);
            if promised <= LEAST_GAIN.max(LEAST_SHARE * cost) {
                break;
            }
            let moved = moved(shape, &numbers, &step);
            let new_cost = self.cost(shape, &moved);
            steps += 1;
            if new_cost < cost {
                let gained = (cost - new_cost) / promised;
                damping *= if gained > 0.75 { 0.1 } else { 0.5 };
                numbers = moved;
                linear = self.linearize(shape, &numbers);
                cost = self.weighted_square(&linear.residuals);
                normal = self.normal_equations(&linear);
            } else if damping > 1e6 {
                break;
            } else {
                damping = (damping * 10.0).max(1e-5);
            }
        }
        Fit {
            shape: shape.clone(),
            numbers,
            cost,
        }
    }
}

/// For each free number, whether it is at a bound that the gradient pushes it against.
pub(crate) fn blocked(shape: &Shape, numbers: &[f64], downhill: &[f64]) -> Vec<bool> {
    let each = shape.free.iter().zip(numbers).zip(downhill);
    each.map(|((free, number), down)| {
        (*number <= free.lowest && *down < 0.0) || (*number >= free.highest && *down > 0.0)
    })
    .collect()
}

/// The numbers after a step, within their bounds. A logarithm moves by 2 at most, a factor of 7.
fn moved(shape: &Shape, numbers: &[f64], step: &[f64]) -> Vec<f64> {
    let each = shape.free.iter().zip(numbers).zip(step);
    each.map(|((free, number), step)| {
        let step = if free.logarithmic {
            step.clamp(-2.0, 2.0)
        } else {
            *step
        };
        (number + step).clamp(free.lowest, free.highest)
    })
    .collect()
}

/// The step of the damped normal equations without the blocked numbers, and the gain that it promises.
fn damped_step(normal: &NormalEquations, blocked: &[bool], mut damping: f64) -> (Vec<f64>, f64) {
    let n = normal.downhill.len();
    // In units of the columns' magnitudes, so that one damping suits all.
    let size: Vec<f64> = (0..n)
        .map(|i| normal.curvature[i * n + i].max(f64::MIN_POSITIVE).sqrt())
        .collect();
    while damping <= 1e12 {
        if let Some(step) = solved(normal, blocked, &size, damping) {
            let along: f64 = step.iter().zip(&normal.downhill).map(|(s, g)| s * g).sum();
            let promised = 2.0 * along - dense::quadratic(&normal.curvature, &step);
            return (step, promised.max(0.0));
        }
        damping = (damping * 10.0).max(1e-9);
    }
    (vec![0.0; n], 0.0)
}

/// Solves the damped normal equations; `None` where they are not positive definite to rounding.
fn solved(
    normal: &NormalEquations,
    blocked: &[bool],
    size: &[f64],
    damping: f64,
) -> Option<Vec<f64>> {
    let (n, curvature) = (size.len(), &normal.curvature);
    let mut scaled: Vec<f64> = (0..n * n)
        .map(|at| match (at / n, at % n) {
            (row, column) if blocked[row] || blocked[column] => 0.0,
            (row, column) => curvature[at] / (size[row] * size[column]),
        })
        .collect();
    for i in 0..n {
        scaled[i * n + i] = 1.0 + damping + 1e-12;
    }
    let factor = dense::cholesky(&scaled, n)?;
    let right: Vec<f64> = (0..n)
        .map(|i| match blocked[i] {
            true => 0.0,
            false => normal.downhill[i] / size[i],
        })
        .collect();
    let mut step = dense::solve(&factor, n, &right);
    for (at, step) in step.iter_mut().enumerate() {
        *step = if blocked[at] || curvature[at * n + at] <= 0.0 {
            0.0
        } else {
            *step / size[at]
        };
    }
    Some(step)
}
