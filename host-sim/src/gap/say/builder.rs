//! A decision as what is said of it.

use std::ops::Range;

use estimator_core::physics::effect::{Bounds, EffectId, MOST_PARAMETERS};

use crate::gap::data::fit_data::Course;
use crate::gap::decide::evidence::{ADEQUATE, Decision, Evidence, depths};
use crate::gap::experiment::advise::advice;
use crate::gap::finding::{Curves, Finding, Known, Named, Tried, Verdict};
use crate::gap::finding::{Region, words};
use crate::gap::model::error::std_errors;
use crate::gap::model::fit::{Fit, Problem};
use crate::gap::model::shape::Owner;
use crate::gap::model::weights::weights;
use crate::gap::options::Options;
use crate::gap::say::regions::{Sorted, regions};
use crate::model::{self, Model};

/// All that is said.
pub(in crate::gap) fn finding(
    model: &Model,
    evidence: &Evidence<'_>,
    decision: Decision,
    ladder: Vec<Tried>,
    options: &Options,
) -> Finding {
    let weights = weights(&decision.variances);
    let problem = Problem {
        courses: evidence.courses,
        weights: &weights,
        low_pass: evidence.low_pass,
    };
    let told = Told {
        problem,
        evidence,
        decision: &decision,
        depths: depths(&decision.best, evidence.courses),
    };
    let before_n = problem.forces(&decision.base.shape, &decision.base.numbers);
    let after_n = problem.forces(&decision.best.shape, &decision.best.numbers);
    let known = told.known(&decision.best, &decision.std_errors);
    let disagreement = told.regions(&before_n);
    // Where what is left is what noise leaves, its regions are shares of nothing.
    let remaining = match decision.verdict {
        Verdict::Unexplained => told.regions(&after_n),
        _ => Vec::new(),
    };
    let effects = told.effects(&known, &after_n);
    let noise_floor_n = told.floor_n();
    // Where no part of the log stands out, held-out parts that are a little off show how well the others
    // told the numbers, and nothing that is missing.
    let nowhere = remaining.is_empty() && effects.is_empty() && decision.ratio.1 <= ADEQUATE;
    let verdict = match decision.verdict {
        Verdict::Unexplained if nowhere => Verdict::NoMissingEffect,
        own => own,
    };
    let mut finding = Finding {
        verdict,
        rmse_before_n: decision.rmse_n.0,
        rmse_after_n: decision.rmse_n.1,
        noise_floor_n,
        floors: evidence.floors.to_vec(),
        ratio_before: decision.ratio.0,
        ratio_after: decision.ratio.1,
        base_before: base(
            &decision.base,
            &told.known(&decision.base, &std_errors(&problem, &decision.base)),
        ),
        base_after: base(&decision.best, &known),
        disagreement,
        remaining,
        advice: String::new(),
        advised: None,
        ladder,
        model: after(model, &decision.best, &known),
        bandwidth_hz: options.bandwidth_hz,
        curves: told.curves(&before_n, &after_n),
        notes: Vec::new(),
        effects,
    };
    (finding.advice, finding.advised) = advice(&finding, evidence, &decision);
    finding
}

/// A parameter of a fit, with its owner.
type Owned = (Owner, Known);

struct Told<'a> {
    problem: Problem<'a>,
    evidence: &'a Evidence<'a>,
    decision: &'a Decision,
    depths: Vec<Vec<f64>>,
}

impl Told<'_> {
    /// Rows of each log in what stands log after log.
    fn rows(&self) -> Vec<Range<usize>> {
        let mut from = 0;
        let each = self.evidence.courses.iter().map(Course::len);
        each.map(|len| {
            from += len;
            from - len..from
        })
        .collect()
    }

    /// Every parameter of a fit with its standard error, from those of its free numbers.
    fn known(&self, fit: &Fit, errors: &[Option<f64>]) -> Vec<Owned> {
        let free = fit.shape.free.iter().zip(&fit.numbers).zip(errors);
        let fitted = |owner: Owner| free.clone().find(|((free, _), _)| free.owner == owner);
        let error_of = |owner: Owner| *fitted(owner)?.1;
        let is_at_bound =
            |owner: Owner| fitted(owner).is_some_and(|((free, at), _)| free.is_at_bound(*at));
        let values = fit.shape.environment_at(&fit.numbers);
        let environment = fit
            .shape
            .base
            .parameters()
            .into_iter()
            .zip(values)
            .enumerate();
        let mut known: Vec<Owned> = environment
            .map(|(at, (parameter, value))| {
                let owner = Owner::Environment(at);
                let own = Known {
                    name: parameter.name,
                    value,
                    std_error: error_of(owner),
                    at_bound: is_at_bound(owner),
                    unit: parameter.unit,
                };
                (owner, own)
            })
            .collect();
        for (number, term) in fit.shape.terms_at(&fit.numbers).iter().enumerate() {
            let row = canonical(term.id, term.row);
            for (at, info) in term.id.info().parameters.iter().enumerate() {
                // An optional number that is not part of this form is not said.
                if info.default == Some(row[at]) && !term.free[at] {
                    continue;
                }
                let owner = Owner::Effect(number, at);
                let own = Known {
                    name: info.name.into(),
                    value: row[at],
                    std_error: error_of(owner),
                    at_bound: is_at_bound(owner),
                    unit: info.unit.symbol(),
                };
                known.push((owner, own));
            }
        }
        known
    }

    fn effects(&self, known: &[Owned], after_n: &[f64]) -> Vec<Named> {
        let decision = self.decision;
        let terms = decision
            .best
            .shape
            .terms
            .iter()
            .enumerate()
            .filter(|(_, term)| !term.given);
        let judged = decision
            .alternatives
            .iter()
            .zip(&decision.gains)
            .zip(&decision.without);
        let mut effects: Vec<Named> = terms
            .zip(judged)
            .map(|((number, term), ((alternatives, gain), without))| {
                let own = |owned: &&Owned| matches!(owned.0, Owner::Effect(of, _) if of == number);
                let forces = self.problem.forces(&without.shape, &without.numbers);
                Named {
                    id: term.id,
                    parameters: known
                        .iter()
                        .filter(own)
                        .map(|owned| owned.1.clone())
                        .collect(),
                    alternatives: alternatives.clone(),
                    place: self.place(&forces, after_n),
                    held_out_gain: *gain,
                }
            })
            .collect();
        effects.sort_by(|a, b| b.held_out_gain.total_cmp(&a.held_out_gain));
        effects
    }

    /// Where the residuals without an effect exceed those with it, in words.
    fn place(&self, without_n: &[f64], with_n: &[f64]) -> String {
        let measured: Vec<f64> = self
            .evidence
            .courses
            .iter()
            .flat_map(|own| own.force_n.clone())
            .collect();
        let residuals: Vec<f64> = measured
            .iter()
            .zip(without_n)
            .map(|(f, own)| f - own)
            .collect();
        // What is left with the effect stands for what would be there anyway.
        let allowed: Vec<f64> = measured
            .iter()
            .zip(with_n)
            .zip(&self.decision.variances)
            .map(|((f, own), v)| {
                if *v > 0.0 {
                    v.max((f - own).powi(2))
                } else {
                    0.0
                }
            })
            .collect();
        words(&self.sorted(&residuals, &allowed))
    }

    fn regions(&self, forces: &[f64]) -> Vec<Region> {
        let measured = self.evidence.courses.iter().flat_map(|own| &own.force_n);
        let residuals: Vec<f64> = measured.zip(forces).map(|(f, own)| f - own).collect();
        self.sorted(&residuals, &self.decision.variances)
    }

    fn sorted(&self, residuals: &[f64], variances: &[f64]) -> Vec<Region> {
        let logs: Vec<Sorted<'_>> = self
            .rows()
            .into_iter()
            .zip(self.evidence.courses)
            .zip(&self.depths)
            .map(|((rows, course), depth_m)| Sorted {
                course,
                depth_m,
                residuals: &residuals[rows.clone()],
                variances: &variances[rows],
            })
            .collect();
        regions(&logs, self.decision.correlation)
    }

    /// Noise (N) of the force that was fitted, all logs together.
    fn floor_n(&self) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        for (course, floor) in self.evidence.courses.iter().zip(self.evidence.floors) {
            let share = self
                .evidence
                .low_pass
                .map_or(1.0, |own| own.share(course.period_s));
            sum += course.len() as f64 * share * floor.used_n.powi(2);
            count += course.len() as f64;
        }
        (sum / count).sqrt()
    }

    fn curves(&self, before_n: &[f64], after_n: &[f64]) -> Vec<Curves> {
        let each = self
            .rows()
            .into_iter()
            .zip(self.evidence.courses)
            .zip(&self.depths);
        each.map(|((rows, course), depth_m)| Curves {
            time_s: course.time_s.clone(),
            position_m: course.position_m.clone(),
            speed_mps: course.speed_mps.clone(),
            depth_m: depth_m.clone(),
            measured_n: course.force_n.clone(),
            before_n: before_n[rows.clone()].to_vec(),
            after_n: after_n[rows.clone()].to_vec(),
            allowed_n: self.decision.variances[rows.clone()]
                .iter()
                .map(|v| v.sqrt())
                .collect(),
            held_out: self.decision.held_out[rows].to_vec(),
        })
        .collect()
    }
}

/// What the base model says, its own effects included: `tool_inertia.mass`.
fn base(fit: &Fit, known: &[Owned]) -> Vec<Known> {
    let each = known.iter().filter_map(|(owner, own)| match owner {
        Owner::Environment(_) => Some(own.clone()),
        Owner::Effect(of, _) => {
            let term = fit.shape.terms.get(*of).filter(|term| term.given)?;
            let name = format!("{}.{}", term.id.name(), own.name);
            Some(Known {
                name,
                ..own.clone()
            })
        }
    });
    each.collect()
}

/// A row as files give it: phases within ±π.
fn canonical(id: EffectId, mut row: [f64; MOST_PARAMETERS]) -> [f64; MOST_PARAMETERS] {
    for (value, info) in row.iter_mut().zip(id.info().parameters) {
        if info.bounds == Bounds::Angle {
            *value -= std::f64::consts::TAU * (*value / std::f64::consts::TAU).round();
        }
    }
    row
}

/// The base model with the effects, refitted values and standard errors.
fn after(model: &Model, best: &Fit, known: &[Owned]) -> Model {
    let mut after = model.clone();
    let values: Vec<f64> = best.shape.environment_at(&best.numbers);
    after.environment = model.environment.with_values(&values);
    after.environment.fit.std_error = errors(known, |owner| matches!(owner, Owner::Environment(_)));
    after.effects = best
        .shape
        .terms
        .iter()
        .enumerate()
        .map(|(number, term)| {
            let own = |owner: Owner| matches!(owner, Owner::Effect(of, _) if of == number);
            let parameters = known.iter().filter(|owned| own(owned.0));
            let given = model.effects.get(number).filter(|_| term.given);
            model::Effect {
                id: term.id.name().into(),
                parameters: parameters
                    .map(|owned| (owned.1.name.clone(), owned.1.value))
                    .collect(),
                fit: model::Fit {
                    fixed: given.map_or(Vec::new(), |own| own.fit.fixed.clone()),
                    std_error: errors(known, own),
                },
                line: None,
            }
        })
        .collect();
    after
}

fn errors(known: &[Owned], own: impl Fn(Owner) -> bool) -> Vec<(String, f64)> {
    let known = known.iter().filter(|owned| own(owned.0));
    known
        .filter_map(|(_, own)| Some((own.name.clone(), own.std_error?)))
        .collect()
}
