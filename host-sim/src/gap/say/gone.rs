//! Effects of the model that a log does not show any more, though it would.
//!
//! A number that is 0 is at its bound and has no standard error: a friction of 0.3025 ± 0.0027 N that had gone was no
//! change, and the answer was that nothing is missing.

use estimator_core::physics::effect::{Effect, EffectId, MOST_PARAMETERS};
use estimator_core::physics::rig::Rig;

use crate::gap::decide::decision::Decision;
use crate::gap::finding::{Change, ParameterEstimate};
use crate::gap::model::{fit::Fit, given::given, problem::Problem, shape::Term};
use crate::gap::say::estimates::Estimates;
use crate::model::{self, Model};

/// An effect is gone if it does less than this share of what it did. Derived: a twentieth, as a number counts as another
/// that is off by a twentieth.
const NOTHING: f64 = 0.05;

/// The effects of the model that do nothing in the logs, and would do something that stands out of the noise by `sigmas`
/// were they as in the model: those that are gone, and of those whose part an added effect does a note.
pub(super) fn gone(
    model: &Model,
    problem: &Problem<'_>,
    decision: &Decision,
    estimates: &Estimates<'_>,
    sigmas: f64,
) -> (Vec<Change>, Vec<String>) {
    let best = &decision.best;
    let (mut gone, mut replaced) = (Vec::new(), Vec::new());
    for (number, term) in given(model).unwrap_or_default().iter().enumerate() {
        let Some((name, was)) = size(&model.effects[number]) else {
            continue;
        };
        let sizes = || Sizes::of(problem, best, number, term);
        if was.0.abs() <= sigmas * was.1 || !sizes().are_gone(decision, sigmas) {
            continue;
        }
        let of_family = |other: &EffectId| other.info().family == term.id.info().family;
        if let Some(other) = best.added_ids().into_iter().find(of_family) {
            replaced.push(format!(
                "{} is named in the place of the model's {}, which does nothing beside it",
                other.name(),
                term.id.name()
            ));
            continue;
        }
        let numbers = estimates.of_effect(number).into_iter();
        gone.extend(numbers.filter(|own| own.name == name).map(|now| Change {
            was,
            now: ParameterEstimate {
                name: format!("{}.{name}", term.id.name()),
                ..now
            },
            is_gone: true,
        }));
    }
    (gone, replaced)
}

/// The first number of an effect with its standard error, if that is known.
fn size(effect: &model::Effect) -> Option<(&str, (f64, f64))> {
    let (name, value) = effect.parameters.first()?;
    let mut errors = effect.fit.std_error.iter();
    let (_, error) = errors.find(|(own, _)| own == name)?;
    Some((name, (*value, *error)))
}

/// Σ w F² of what an effect does.
struct Sizes {
    /// As it is now.
    now: f64,
    /// As the model has it.
    was: f64,
}

impl Sizes {
    /// Of the effect with a number, which was `known`.
    fn of(problem: &Problem<'_>, best: &Fit, number: usize, known: &Term) -> Sizes {
        let terms = best.shape.terms_at(&best.numbers);
        let forces = |row: Option<[f64; MOST_PARAMETERS]>| {
            let mut rig = Rig::bare(best.shape.rig(&best.numbers).environment);
            for (at, term) in terms.iter().enumerate() {
                let own = if at == number { row } else { Some(term.row) };
                if let Some(row) = own {
                    rig = rig.with(Effect::new(term.id, &row));
                }
            }
            problem.forces_of(&rig)
        };
        let without = forces(None);
        let size = |with: Vec<f64>| {
            let mut changes: Vec<f64> = with.iter().zip(&without).map(|(a, b)| a - b).collect();
            problem.without_steps(&mut changes);
            problem.weighted_square(&changes)
        };
        Sizes {
            now: size(forces(Some(terms[number].row))),
            was: size(forces(Some(known.row))),
        }
    }

    fn are_gone(&self, decision: &Decision, sigmas: f64) -> bool {
        self.now < NOTHING.powi(2) * self.was && self.was > decision.correlation * sigmas.powi(2)
    }
}
