//! The least squares of a rig to logs.

use estimator_core::physics::effect::EffectId;

use crate::gap::data::scales::Scales;
use crate::gap::model::{
    problem::Problem,
    shape::{Free, Owner, Shape, Term},
};
use crate::lsq::minimize::{Minimizer, System};

/// Most steps of a fit.
pub(crate) const MOST_STEPS: usize = 40;
/// A fit has converged if a step promises less than this share of Σ w r², or less than `LEAST_GAIN` of it.
const LEAST_SHARE: f64 = 3e-5;
/// A gain of 1 in Σ w r² is worth one standard error.
const LEAST_GAIN: f64 = 1e-4;

/// What a free number costs in Σ w r² of independent residuals, of which there are so many `samples` over the
/// `correlation`: Schwarz's criterion (BIC).
pub(in crate::gap) fn cost_of_number(samples: f64, correlation: f64) -> f64 {
    (samples / correlation).max(2.0).ln()
}

/// Smallest ridge of the inverse of a curvature.
pub(crate) const RIDGE: f64 = 1e-12;

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

    /// The effects that the base model does not have, in the order of their terms.
    pub(crate) fn added_ids(&self) -> Vec<EffectId> {
        let added = self.added().into_iter();
        added.map(|at| self.shape.terms[at].id).collect()
    }

    /// For each free number, whether it is at a bound.
    pub(crate) fn at_bound(&self) -> Vec<bool> {
        let each = self.shape.free.iter().zip(&self.numbers);
        each.map(|(free, number)| free.is_at_bound(*number))
            .collect()
    }

    /// Whether the second number of an effect is free and somewhere.
    pub(in crate::gap) fn is_second_at(
        &self,
        term: usize,
        is_at: impl Fn(&Free, f64) -> bool,
    ) -> bool {
        self.is_at(Owner::Effect(term, 1), is_at)
    }

    /// Whether a number is free and somewhere.
    pub(in crate::gap) fn is_at(&self, owner: Owner, is_at: impl Fn(&Free, f64) -> bool) -> bool {
        let mut each = self.shape.free.iter().zip(&self.numbers);
        each.any(|(free, number)| free.owner == owner && is_at(free, *number))
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
        let minimizer = Minimizer {
            limits: shape.limits(),
            system: System::Scaled,
            most_steps,
            least_gain: LEAST_GAIN,
            least_share: LEAST_SHARE,
            most_damping: 1e6,
            raise: (10.0, 1e-5),
        };
        let normal = |numbers: &[f64]| self.normal_equations(&self.linearize(shape, numbers));
        let minimum = minimizer.minimum(start, |numbers| self.cost(shape, numbers), normal);
        Fit {
            shape: shape.clone(),
            numbers: minimum.numbers,
            cost: minimum.cost,
        }
    }
}
