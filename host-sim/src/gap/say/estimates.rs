//! The parameters of a fit with their standard errors, and the model file that they make.

use estimator_core::physics::effect::{Bounds, EffectId, MOST_PARAMETERS};

use crate::gap::finding::ParameterEstimate;
use crate::gap::model::{fit::Fit, shape::Owner, shape::Term};
use crate::model::{self, Model};

/// What stands in a model file for a size of 0.
const LEAST: f64 = 1e-12;

/// A parameter of a fit with its owner.
type OwnedEstimate = (Owner, ParameterEstimate);

/// Every parameter of a fit with its standard error.
pub(super) struct Estimates<'a> {
    fit: &'a Fit,
    all: Vec<OwnedEstimate>,
}

impl<'a> Estimates<'a> {
    /// `errors` are the standard errors of the free numbers.
    pub(super) fn of(fit: &'a Fit, errors: &[Option<f64>]) -> Estimates<'a> {
        let free = fit.shape.free.iter().zip(&fit.numbers).zip(errors);
        let estimate = |owner: Owner, name: String, value: f64, unit: &'static str| {
            let fitted = free.clone().find(|((free, _), _)| free.owner == owner);
            let estimate = ParameterEstimate {
                name,
                value,
                std_error: fitted.and_then(|(_, error)| *error),
                at_bound: fitted.is_some_and(|((free, number), _)| free.is_at_bound(*number)),
                unit,
            };
            (owner, estimate)
        };
        let values = fit.shape.environment_at(&fit.numbers);
        let environment = fit.shape.base.parameters().into_iter().zip(values);
        let mut all: Vec<OwnedEstimate> = environment
            .enumerate()
            .map(|(at, (parameter, value))| {
                let owner = Owner::Environment(at);
                estimate(owner, parameter.name, value, parameter.unit)
            })
            .collect();
        for (number, term) in fit.shape.terms_at(&fit.numbers).iter().enumerate() {
            let row = with_angles_within_pi(term.id, term.row);
            for (at, info) in term.id.info().parameters.iter().enumerate() {
                // An optional number that is not part of this form is left out.
                if info.default == Some(row[at]) && !term.free[at] {
                    continue;
                }
                let owner = Owner::Effect(number, at);
                all.push(estimate(
                    owner,
                    info.name.into(),
                    row[at],
                    info.unit.symbol(),
                ));
            }
        }
        Estimates { fit, all }
    }

    /// The parameters of an effect.
    pub(super) fn of_effect(&self, number: usize) -> Vec<ParameterEstimate> {
        let of_effect = self.all.iter().filter(|(owner, _)| is_of(*owner, number));
        of_effect.map(|(_, estimate)| estimate.clone()).collect()
    }

    /// The parameters of the base model. Those of its effects are named as `tool_inertia.mass`.
    pub(super) fn of_base(&self) -> Vec<ParameterEstimate> {
        let of_base = |(owner, estimate): &OwnedEstimate| match owner {
            Owner::Environment(_) => Some(estimate.clone()),
            Owner::Effect(number, _) => {
                let terms = &self.fit.shape.terms;
                let term = terms.get(*number).filter(|term| term.given)?;
                Some(ParameterEstimate {
                    name: format!("{}.{}", term.id.name(), estimate.name),
                    ..estimate.clone()
                })
            }
        };
        self.all.iter().filter_map(of_base).collect()
    }

    /// The base model with the effects, refitted values and standard errors.
    pub(super) fn refitted_model(&self, model: &Model) -> Model {
        let mut refitted = model.clone();
        let mut values: Vec<f64> = self.fit.shape.environment_at(&self.fit.numbers);
        for (value, own) in values.iter_mut().zip(model.environment.parameters()) {
            if own.name.starts_with("relaxation_fraction") {
                *value = value.max(LEAST);
            }
        }
        refitted.environment = model.environment.with_values(&values);
        refitted.environment.fit.std_error =
            self.std_errors(|owner| matches!(owner, Owner::Environment(_)));
        let terms = self.fit.shape.terms.iter().enumerate();
        refitted.effects = terms
            .map(|(number, term)| self.model_effect(model, number, term))
            .collect();
        refitted
    }

    fn model_effect(&self, model: &Model, number: usize, term: &Term) -> model::Effect {
        let parameters = self.all.iter().filter(|(owner, _)| is_of(*owner, number));
        let given = model.effects.get(number).filter(|_| term.given);
        model::Effect {
            id: term.id.name().into(),
            parameters: parameters
                .map(|(_, estimate)| (estimate.name.clone(), readable(term.id, estimate)))
                .collect(),
            fit: model::Fit {
                fixed: given.map_or(Vec::new(), |effect| effect.fit.fixed.clone()),
                std_error: self.std_errors(|owner| is_of(owner, number)),
            },
            line: None,
        }
    }

    fn std_errors(&self, is_included: impl Fn(Owner) -> bool) -> Vec<(String, f64)> {
        let included = self.all.iter().filter(|(owner, _)| is_included(*owner));
        included
            .filter_map(|(_, estimate)| Some((estimate.name.clone(), estimate.std_error?)))
            .collect()
    }
}

/// The value of a parameter as a model file may have it: a fit may leave a size at 0, where the file asks for
/// more. What is as small does nothing either.
fn readable(id: EffectId, estimate: &ParameterEstimate) -> f64 {
    let parameters = id.info().parameters.iter();
    let mut of_this = parameters.filter(|info| info.name == estimate.name);
    match of_this.all(|info| info.bounds.allow(estimate.value)) {
        true => estimate.value,
        false => estimate.value.max(LEAST),
    }
}

fn is_of(owner: Owner, number: usize) -> bool {
    matches!(owner, Owner::Effect(of, _) if of == number)
}

/// The row of an effect as files give it, with phases within ±π.
fn with_angles_within_pi(id: EffectId, mut row: [f64; MOST_PARAMETERS]) -> [f64; MOST_PARAMETERS] {
    for (value, info) in row.iter_mut().zip(id.info().parameters) {
        if info.bounds == Bounds::Angle {
            *value -= std::f64::consts::TAU * (*value / std::f64::consts::TAU).round();
        }
    }
    row
}
