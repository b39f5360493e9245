//! What a motion can tell apart, before or without another log.
//!
//! An effect changes the force by d(t). What base and noise leave of it is seen: |W^½ d|² after the
//! projection off the base's Jacobian is the χ² that it adds. A rival imitates it with its own force
//! and its own Jacobian, next to the base's: what is left after that projection is the χ² by which
//! the two differ. Linear, at the best of the rival's starts; a rival that could imitate only beyond
//! its bounds counts as one all the same, so that the answer is on the careful side.

use estimator_core::physics::effect::{EffectId, MOST_PARAMETERS};
use rayon::prelude::*;

use crate::gap::data::fit_data::Course;
use crate::gap::data::scales::Scales;
use crate::gap::decide::evidence::depths;
use crate::gap::model::basis::{extend, remove};
use crate::gap::model::fit::{Fit, Problem, dot, forces};
use crate::gap::model::shape::{Shape, Term};
use crate::gap::model::start::{is_possible, starts, whole};
use crate::gap::model::weights::{variances, weights};
use crate::gap::noise::floor::Floor;

/// A difference of χ² that counts, like the search's price: 5 σ, and the catalogue's size.
pub(in crate::gap) fn least(catalogue: usize) -> f64 {
    25.0 + 2.0 * (catalogue as f64).ln()
}

/// A base at its numbers, with motions and the noise on them.
pub(in crate::gap) struct Bench<'a> {
    pub(in crate::gap) shape: &'a Shape,
    pub(in crate::gap) numbers: &'a [f64],
    pub(in crate::gap) courses: &'a [Course],
    pub(in crate::gap) scales: &'a Scales,
    /// Samples of the rig that count, all repeats counted.
    samples: f64,
    /// √(repeats)/σ per sample.
    roots: Vec<f64>,
    forces: Vec<f64>,
    /// What the base's own numbers can do, orthonormal.
    basis: Vec<Vec<f64>>,
}

/// An effect, somewhere in its range of numbers.
pub(in crate::gap) struct Presence {
    pub(in crate::gap) term: Term,
    /// What it does to the force in units of the noise, beyond what the base can do.
    change: Vec<f64>,
    /// The same for its numbers, and the change itself, orthonormal.
    span: Vec<Vec<f64>>,
}

/// Samples on either side of a touch that a thinned motion says nothing of.
const UNRESOLVED: usize = 3;

/// Between two of its samples a thinned motion has no touch where the rig's has one, and what follows
/// at once (a lag's answer to it, a delay's) would count for all the samples that were left out.
fn leave_out_touches(weights: &mut [f64], fit: &Fit, courses: &[Course], repeats: &[f64]) {
    let mut from = 0;
    for (depths, repeats) in depths(fit, courses).iter().zip(repeats) {
        let own = &mut weights[from..from + depths.len()];
        from += depths.len();
        let touches = (1..depths.len()).filter(|at| (depths[*at] > 0.0) != (depths[at - 1] > 0.0));
        for at in touches.filter(|_| *repeats > 1.0) {
            let last = (at + UNRESOLVED).min(own.len());
            own[at.saturating_sub(UNRESOLVED)..last].fill(0.0);
        }
    }
}

impl<'a> Bench<'a> {
    /// `floors` are the courses' noises; `repeats` says how many samples of the rig each of theirs
    /// stands for.
    pub(in crate::gap) fn new(
        shape: &'a Shape,
        numbers: &'a [f64],
        courses: &'a [Course],
        scales: &'a Scales,
        floors: &[Floor],
        repeats: &[f64],
    ) -> Bench<'a> {
        let fit = Fit {
            shape: shape.clone(),
            numbers: numbers.to_vec(),
            cost: 0.0,
        };
        let mut roots = weights(&variances(&fit, courses, floors, None));
        leave_out_touches(&mut roots, &fit, courses, repeats);
        let of_course = courses.iter().zip(repeats);
        let each =
            of_course.flat_map(|(course, repeats)| std::iter::repeat_n(repeats, course.len()));
        let mut samples = 0.0;
        for (weight, repeats) in roots.iter_mut().zip(each) {
            samples += if *weight > 0.0 { *repeats } else { 0.0 };
            *weight = (*weight * repeats).sqrt();
        }
        let mut bench = Bench {
            shape,
            numbers,
            courses,
            scales,
            samples,
            forces: forces(shape, numbers, courses),
            basis: Vec::new(),
            roots,
        };
        bench.basis = bench.columns(shape, numbers, &[]);
        bench
    }

    /// Orthonormal columns of a shape's Jacobian, off `basis` and in units of the noise.
    fn columns(&self, shape: &Shape, numbers: &[f64], basis: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let problem = Problem {
            courses: self.courses,
            weights: &self.roots,
            low_pass: None,
        };
        let mut own = Vec::new();
        for mut column in problem.linear(shape, numbers).columns {
            column
                .iter_mut()
                .zip(&self.roots)
                .for_each(|(c, root)| *c *= root);
            extend(&mut own, column, basis);
        }
        own
    }

    /// JᵀWJ of the base's numbers.
    pub(in crate::gap) fn curvature(&self) -> Vec<f64> {
        let weights: Vec<f64> = self.roots.iter().map(|root| root * root).collect();
        let problem = Problem {
            courses: self.courses,
            weights: &weights,
            low_pass: None,
        };
        problem.normal(&problem.linear(self.shape, self.numbers)).0
    }

    /// An effect with its numbers.
    pub(in crate::gap) fn presence(&self, term: Term) -> Option<Presence> {
        let mut terms = self.shape.terms_at(self.numbers);
        terms.push(term.clone());
        let shape = Shape::new(&self.shape.base, terms, self.scales);
        let mut numbers = shape.start();
        numbers[..self.numbers.len()].copy_from_slice(self.numbers);
        let mut change: Vec<f64> = forces(&shape, &numbers, self.courses)
            .iter()
            .zip(&self.forces)
            .zip(&self.roots)
            .map(|((with, without), root)| root * (with - without))
            .collect();
        let whole = dot(&change, &change);
        remove(&mut change, &self.basis);
        let left = dot(&change, &change);
        if !left.is_finite() || left <= 1e-9 * whole {
            change.iter_mut().for_each(|own| *own = 0.0);
        }
        let mut span = self.columns(&shape, &numbers, &self.basis);
        extend(&mut span, change.clone(), &self.basis);
        Some(Presence { term, change, span }).filter(|_| left.is_finite())
    }

    /// Every effect of a catalogue from all its starts.
    pub(in crate::gap) fn presences(&self, ids: &[EffectId]) -> Vec<Vec<Presence>> {
        let starts: Vec<Vec<Term>> = ids.iter().map(|id| self.starts(*id)).collect();
        starts
            .into_par_iter()
            .map(|own| {
                own.into_iter()
                    .filter_map(|term| self.presence(term))
                    .collect()
            })
            .collect()
    }

    /// The search's starts; for what repeats, one period that no stroke has.
    fn starts(&self, id: EffectId) -> Vec<Term> {
        use EffectId as E;
        let s = self.scales;
        let force = 0.05 * s.force_n;
        let length = force * s.travel_m / s.force_n;
        let (amplitude, period) = match id {
            E::PeriodicDisturbance => (force, 37.3 / s.duration_s),
            E::SurfaceMotion => (0.1 * length, 37.3 / s.duration_s),
            E::Cogging => (force, s.travel_m / 7.3),
            E::EncoderPeriodicError => (0.1 * length, s.travel_m / 7.3),
            _ => return starts(id, self.shape, s),
        };
        if !is_possible(id, self.shape) {
            return Vec::new();
        }
        let mut row = [0.0; MOST_PARAMETERS];
        row[..3].copy_from_slice(&[amplitude, period, 0.6]);
        vec![whole(id, row, 3)]
    }

    /// χ² that an effect adds, `times` as strong, if the base is refitted.
    pub(in crate::gap) fn seen(&self, target: &Presence, times: f64) -> f64 {
        times * times * dot(&target.change, &target.change)
    }

    /// χ² that is left of it when the rival has done what it can, from its best start.
    pub(in crate::gap) fn apart(&self, target: &Presence, times: f64, rivals: &[Presence]) -> f64 {
        let each = rivals.iter().map(|rival| {
            let mut left = target.change.clone();
            remove(&mut left, &rival.span);
            times * times * dot(&left, &left)
        });
        each.fold(self.seen(target, times), f64::min)
    }

    /// Root mean square of the change an effect makes to the force, in units of the noise, before
    /// anything is refitted.
    pub(in crate::gap) fn strength(&self, target: &Presence) -> f64 {
        let mut terms = self.shape.terms_at(self.numbers);
        terms.push(target.term.clone());
        let shape = Shape {
            terms,
            ..self.shape.clone()
        };
        let with = forces(&shape, self.numbers, self.courses);
        let each = with.iter().zip(&self.forces).zip(&self.roots);
        let square: f64 = each
            .map(|((with, without), root)| (root * (with - without)).powi(2))
            .sum();
        (square / self.samples.max(1.0)).sqrt()
    }
}
