//! Where a candidate effect starts, and what it promises: the change it makes to the force, projected
//! off what the model can do already, compared with the residuals.

use estimator_core::physics::effect::{EffectId, Role, Sign};
use rayon::prelude::*;

use crate::gap::data::scales::Scales;
use crate::gap::model::{
    basis::add_column, basis::dot, basis::project_out, fit::Fit, problem::Problem, shape::Shape,
    shape::Term, start::starts,
};
use crate::lsq::minimize::blocked;

/// An effect with numbers to start from.
#[derive(Clone, Debug)]
pub(crate) struct Proposal {
    pub(crate) term: Term,
    /// What the effect takes off Σ w r², to first order.
    pub(crate) gain: f64,
}

/// A fit and its linearization: an orthonormal basis of the changes that its numbers can make.
pub(crate) struct LinearizedModel<'a> {
    pub(super) problem: Problem<'a>,
    pub(super) fit: &'a Fit,
    pub(super) scales: &'a Scales,
    /// Predicted forces (N).
    forces: Vec<f64>,
    /// √w r, projected off the basis.
    pub(super) residuals: Vec<f64>,
    /// Orthonormal columns, in units of √w r.
    pub(super) basis: Vec<Vec<f64>>,
    /// √w for each sample.
    pub(super) roots: Vec<f64>,
}

impl<'a> LinearizedModel<'a> {
    pub(crate) fn new(
        problem: Problem<'a>,
        fit: &'a Fit,
        scales: &'a Scales,
    ) -> LinearizedModel<'a> {
        let linear = problem.linearize(&fit.shape, &fit.numbers);
        let roots: Vec<f64> = problem.weights.iter().map(|w| w.sqrt()).collect();
        let weighted = |column: &[f64]| -> Vec<f64> {
            column.iter().zip(&roots).map(|(c, w)| c * w).collect()
        };
        let normal = problem.normal_equations(&linear);
        let blocked = blocked(&fit.shape.limits(), &fit.numbers, &normal.downhill);
        let mut basis: Vec<Vec<f64>> = Vec::new();
        // A number that its bound keeps from moving can do nothing: a damping of 0 that a lag would have
        // negative.
        let columns = linear.columns.iter().zip(&blocked);
        for (column, _) in columns.filter(|(_, blocked)| !**blocked) {
            add_column(&mut basis, weighted(column), &[]);
        }
        let mut residuals = weighted(&linear.residuals);
        project_out(&mut residuals, &basis);
        LinearizedModel {
            problem,
            fit,
            scales,
            forces: problem.forces(&fit.shape, &fit.numbers),
            residuals,
            basis,
            roots,
        }
    }

    /// The two best starts of every effect, the best effects first. An effect whose size would be negative
    /// promises `wrong_sign` times as much.
    pub(crate) fn proposals(&self, ids: &[EffectId], wrong_sign: f64) -> Vec<Vec<Proposal>> {
        let mut starts: Vec<Term> = ids
            .iter()
            .flat_map(|id| starts(*id, &self.fit.shape, self.scales))
            .collect();
        starts.extend(self.periodic_starts(ids));
        let mut scored: Vec<Proposal> = starts
            .into_par_iter()
            .map(|term| self.proposal(term, wrong_sign))
            .collect();
        scored.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        let mut ranked: Vec<Vec<Proposal>> = Vec::new();
        for proposal in scored {
            let same = |starts: &&mut Vec<Proposal>| starts[0].term.id == proposal.term.id;
            match ranked.iter_mut().find(same) {
                Some(starts) if starts.len() < 2 => starts.push(proposal),
                Some(_) => {}
                None => ranked.push(vec![proposal]),
            }
        }
        ranked
    }

    /// What a start promises, its size fitted where the force is proportional to one.
    fn proposal(&self, term: Term, wrong_sign: f64) -> Proposal {
        let mut change = self.change_by(&term);
        let whole = dot(&change, &change);
        project_out(&mut change, &self.basis);
        let left = dot(&change, &change);
        // A change that the model can make as well promises nothing.
        if !left.is_finite() || left <= 1e-9 * whole || left <= 0.0 {
            return Proposal { term, gain: 0.0 };
        }
        let along = dot(&change, &self.residuals);
        let share = along / left;
        let mut gain = along * along / left;
        if share < 0.0 && term.id.info().sign != Sign::Either {
            gain *= wrong_sign;
        }
        Proposal {
            term: scaled(term, share),
            gain,
        }
    }

    /// The change (√w N) that an effect makes to the predicted force.
    fn change_by(&self, term: &Term) -> Vec<f64> {
        let mut terms = self.fit.shape.terms_at(&self.fit.numbers);
        terms.push(term.clone());
        let shape = Shape {
            terms,
            ..self.fit.shape.clone()
        };
        let changed = self.problem.forces(&shape, &self.fit.numbers);
        changed
            .iter()
            .zip(&self.forces)
            .zip(&self.roots)
            .map(|((with, without), root)| root * (with - without))
            .collect()
    }
}

/// Multiplies the sizes of an effect by what the residuals ask for, where its force is proportional to them.
fn scaled(mut term: Term, share: f64) -> Term {
    let facts = term.id.info();
    if facts.is_proportional(&term.row) {
        let share = if facts.sign == Sign::Either {
            share
        } else {
            share.max(0.05)
        };
        let factor = share.signum() * share.abs().clamp(0.02, 50.0);
        for (value, fit) in term.row.iter_mut().zip(facts.fits) {
            match fit.role {
                Role::Size => *value *= factor,
                Role::SizeUpTo(most) => *value = (*value * factor).min(most),
                Role::Shape | Role::Form(..) | Role::Switch(_) => {}
            }
        }
    }
    term
}
