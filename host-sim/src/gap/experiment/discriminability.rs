//! Which effects a motion shows, and which of them it discriminates, before or without another log.
//!
//! An effect changes the force by d(t). What base and noise leave of it is detected: |W^½ d|² after the
//! projection off the Jacobian of the base is the χ² that the effect adds. A rival imitates it with its
//! own force and its own Jacobian, beside that of the base: what is left after that projection is the χ²
//! by which the two differ. All of it is linear, at the best of the rival's starts. A rival that could
//! imitate only beyond its bounds counts as one all the same, so that the answer is on the careful side.

use estimator_core::physics::effect::{EffectId, MOST_PARAMETERS, Repeats};
use estimator_core::physics::fit_range::Scale;
use rayon::prelude::*;

use crate::gap::model::{
    dataset::Dataset, fit::Fit, shape::Shape, shape::Term, simulate::depths, simulate::forces,
    start::is_possible, start::starts, start::whole,
};
use crate::lsq::basis::{add_column, dot, project_out};

/// Samples on either side of a touch that a thinned motion says nothing of.
const UNRESOLVED: usize = 3;
/// The share of a change that must be left beyond the base for the effect to be detected at all: the
/// rest is rounding.
const LEAST_REMAINDER: f64 = 1e-9;

/// A base with fixed numbers, motions, and the noise on them.
pub(super) struct Discriminability<'a> {
    shape: &'a Shape,
    numbers: &'a [f64],
    dataset: Dataset<'a>,
    /// Samples of the rig with a weight, all repeats counted.
    samples: f64,
    /// √(repeats)/σ (1/N) for each sample.
    roots: Vec<f64>,
    /// The forces (N) of the base.
    forces: Vec<f64>,
    /// Orthonormal columns: the changes that the numbers of the base can make.
    basis: Vec<Vec<f64>>,
}

/// What an effect with its numbers does to the force.
pub(super) struct EffectSignature {
    pub(super) term: Term,
    /// The change of the force in units of the noise, beyond what the base can do.
    change: Vec<f64>,
    /// Orthonormal columns: the changes by the effect's numbers, and `change` itself.
    span: Vec<Vec<f64>>,
}

impl<'a> Discriminability<'a> {
    /// `repeats` says how many samples of the rig each sample of a log stands for.
    pub(super) fn new(
        shape: &'a Shape,
        numbers: &'a [f64],
        dataset: Dataset<'a>,
        repeats: &[f64],
    ) -> Discriminability<'a> {
        let fit = Fit {
            shape: shape.clone(),
            numbers: numbers.to_vec(),
            cost: 0.0,
        };
        let mut roots = dataset.weights(&fit);
        let depths = depths(shape, numbers, dataset.logs);
        leave_out_touches(&mut roots, &depths, repeats);
        let of_log = dataset.logs.iter().zip(repeats);
        let each = of_log.flat_map(|(log, repeats)| std::iter::repeat_n(repeats, log.len()));
        let mut samples = 0.0;
        for (weight, repeats) in roots.iter_mut().zip(each) {
            samples += if *weight > 0.0 { *repeats } else { 0.0 };
            *weight = (*weight * repeats).sqrt();
        }
        let mut analysis = Discriminability {
            shape,
            numbers,
            samples,
            forces: forces(shape, numbers, dataset.logs),
            basis: Vec::new(),
            dataset,
            roots,
        };
        analysis.basis = analysis.columns(shape, numbers, &[]);
        analysis
    }

    /// Orthonormal columns of the Jacobian of a shape, in units of the noise and projected off `basis`.
    fn columns(&self, shape: &Shape, numbers: &[f64], basis: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let problem = self.dataset.problem(&self.roots);
        let mut columns = Vec::new();
        for mut column in problem.linearize(shape, numbers).columns {
            column
                .iter_mut()
                .zip(&self.roots)
                .for_each(|(c, root)| *c *= root);
            add_column(&mut columns, column, basis);
        }
        columns
    }

    /// JᵀWJ of the numbers of the base.
    pub(super) fn curvature(&self) -> Vec<f64> {
        let weights: Vec<f64> = self.roots.iter().map(|root| root * root).collect();
        let problem = self.dataset.problem(&weights);
        problem
            .normal_equations(&problem.linearize(self.shape, self.numbers))
            .curvature
    }

    /// The signature of an effect; `None` where its force is not finite.
    pub(super) fn signature(&self, term: Term) -> Option<EffectSignature> {
        let mut terms = self.shape.terms_at(self.numbers);
        terms.push(term.clone());
        let shape = Shape::new(&self.shape.base, terms, self.dataset.scales);
        let mut numbers = shape.start();
        numbers[..self.numbers.len()].copy_from_slice(self.numbers);
        let mut change = self.change(&forces(&shape, &numbers, self.dataset.logs));
        let whole = dot(&change, &change);
        project_out(&mut change, &self.basis);
        let left = dot(&change, &change);
        if !left.is_finite() || left <= LEAST_REMAINDER * whole {
            change.iter_mut().for_each(|value| *value = 0.0);
        }
        let mut span = self.columns(&shape, &numbers, &self.basis);
        add_column(&mut span, change.clone(), &self.basis);
        Some(EffectSignature { term, change, span }).filter(|_| left.is_finite())
    }

    /// Forces (N) minus those of the base, in units of the noise.
    fn change(&self, forces: &[f64]) -> Vec<f64> {
        forces
            .iter()
            .zip(&self.forces)
            .zip(&self.roots)
            .map(|((with, without), root)| root * (with - without))
            .collect()
    }

    /// The signatures of every effect of a catalogue, from all its starts.
    pub(super) fn signatures(&self, ids: &[EffectId]) -> Vec<Vec<EffectSignature>> {
        let starts: Vec<Vec<Term>> = ids.iter().map(|id| self.starts(*id)).collect();
        let of_effect = |terms: Vec<Term>| -> Vec<EffectSignature> {
            let each = terms.into_iter();
            each.filter_map(|term| self.signature(term)).collect()
        };
        starts.into_par_iter().map(of_effect).collect()
    }

    /// The starts of the search; for an effect that repeats, one period that no stroke has.
    fn starts(&self, id: EffectId) -> Vec<Term> {
        let (info, s) = (id.info(), self.dataset.scales);
        let period = match info.repeats {
            Repeats::Never | Repeats::EveryTurn => return starts(id, self.shape, s),
            Repeats::InTime => 37.3 / s.duration_s,
            Repeats::AlongTheWay => s.travel_m / 7.3,
        };
        let force = s.size(Scale::SmallForce);
        let amplitude = if info.stage.acts_in_free_air() {
            force
        } else {
            // It displaces.
            0.1 * (force * s.travel_m / s.force_n)
        };
        if !is_possible(id, self.shape) {
            return Vec::new();
        }
        let mut row = [0.0; MOST_PARAMETERS];
        row[..3].copy_from_slice(&[amplitude, period, 0.6]);
        vec![whole(id, row, 3)]
    }

    /// The χ² that an effect adds once the base is refitted, `times` as strong as its signature.
    pub(super) fn detection_chi2(&self, target: &EffectSignature, times: f64) -> f64 {
        times * times * dot(&target.change, &target.change)
    }

    /// The χ² that is left of it when a rival has done what it can, from the best of its starts.
    pub(super) fn discrimination_chi2(
        &self,
        target: &EffectSignature,
        times: f64,
        rival: &[EffectSignature],
    ) -> f64 {
        let each = rival.iter().map(|rival| {
            let mut left = target.change.clone();
            project_out(&mut left, &rival.span);
            times * times * dot(&left, &left)
        });
        each.fold(self.detection_chi2(target, times), f64::min)
    }

    /// The root mean square of the change that an effect makes to the force before anything is refitted,
    /// in units of the noise.
    pub(super) fn rms_change(&self, target: &EffectSignature) -> f64 {
        let mut terms = self.shape.terms_at(self.numbers);
        terms.push(target.term.clone());
        let shape = Shape {
            terms,
            ..self.shape.clone()
        };
        let change = self.change(&forces(&shape, self.numbers, self.dataset.logs));
        let square: f64 = change.iter().map(|value| value.powi(2)).sum();
        (square / self.samples.max(1.0)).sqrt()
    }
}

/// Leaves out the samples around the touches of a thinned motion. Between two of its samples it has no
/// touch where the rig's motion has one, and what follows at once (the answer of a lag to it, or of a
/// delay) would count for all the samples that were left out.
fn leave_out_touches(weights: &mut [f64], depths: &[Vec<f64>], repeats: &[f64]) {
    let mut from = 0;
    for (depths, repeats) in depths.iter().zip(repeats) {
        let of_log = &mut weights[from..from + depths.len()];
        from += depths.len();
        let touches = (1..depths.len()).filter(|at| (depths[*at] > 0.0) != (depths[at - 1] > 0.0));
        for at in touches.filter(|_| *repeats > 1.0) {
            let last = (at + UNRESOLVED).min(of_log.len());
            of_log[at.saturating_sub(UNRESOLVED)..last].fill(0.0);
        }
    }
}
