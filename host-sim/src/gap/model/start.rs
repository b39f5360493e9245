//! Where a candidate may start: its row says the numbers, in the sizes of the log.

use estimator_core::physics::effect::{EffectId, Family, Laws, MOST_PARAMETERS};
use estimator_core::physics::effect::{StartValues, Starts};
use estimator_core::physics::{fit_range::Scaled, law::LawId};

use crate::gap::data::scales::Scales;
use crate::gap::model::shape::{Shape, Term};

/// A term with its first `count` numbers free.
pub(in crate::gap) fn whole(id: EffectId, row: [f64; MOST_PARAMETERS], count: usize) -> Term {
    Term {
        id,
        row,
        free: std::array::from_fn(|at| at < count),
        given: false,
        open: [false; MOST_PARAMETERS],
    }
}

/// A term of which nothing but its size is free, or anything.
pub(in crate::gap) fn of_size(id: EffectId, size: f64) -> Term {
    let mut row = [0.0; MOST_PARAMETERS];
    row[0] = size;
    whole(id, row, 1)
}

/// The values from which a fit may start with one number of an effect.
pub(in crate::gap) fn starts_of_number(id: EffectId, at: usize, scales: &Scales) -> Vec<f64> {
    let size = |number: Scaled| number.value(|scale| scales.size(scale));
    let all = id.info().starts.iter();
    let own = all.filter_map(|starts| starts.values.get(at));
    own.filter(|values| !matches!(values, StartValues::Held(_)))
        .flat_map(|values| numbers(values, size))
        .collect()
}

/// Whether an effect can be added: it needs something to touch unless it acts in free air, and a
/// second one of a kind means nothing but in a spectrum: relaxation, harmonics. A friction that sticks may come to one
/// of the model that does not: a drive's record whose friction had grown by one that first bends left 1.7 times what
/// it should with the model's alone, and 0.9 times with both.
pub(in crate::gap) fn is_possible(id: EffectId, shape: &Shape) -> bool {
    let touches = !shape.base.is_free();
    let has = shape
        .terms
        .iter()
        .any(|term| term.id == id || (!term.given && is_one(term.id, id)));
    (touches || id.info().stage.acts_in_free_air()) && (id.info().several || !has)
}

/// Whether two effects are one thing of which a rig has one: Bouc and Wen's loop is a friction that sticks before it slides,
/// and Stribeck's has Coulomb's in it. Beside one that was added it was a second name, `certain`, for one friction.
fn is_one(one: EffectId, other: EffectId) -> bool {
    let is_dry = |id: EffectId| id.info().family == Family::DryFriction;
    is_dry(one) && is_dry(other)
}

/// Whether it is a wave, in time or along the way.
pub(in crate::gap) fn repeats(id: EffectId) -> bool {
    id.info().repeats.has_spectrum()
}

/// Starts of an effect; there are none if it means nothing on this law.
pub(in crate::gap) fn starts(id: EffectId, shape: &Shape, scales: &Scales) -> Vec<Term> {
    starts_among(id, shape, scales, |_| true)
}

/// Those starts from which a fit also begins at the law's values in the model file.
pub(in crate::gap) fn starts_from_file(id: EffectId, shape: &Shape, scales: &Scales) -> Vec<Term> {
    starts_among(id, shape, scales, |starts| starts.from_file)
}

fn starts_among(
    id: EffectId,
    shape: &Shape,
    scales: &Scales,
    wanted: impl Fn(&Starts) -> bool,
) -> Vec<Term> {
    if !is_possible(id, shape) || !has_meaning(id, shape) {
        return Vec::new();
    }
    let size = |number: Scaled| number.value(|scale| scales.size(scale));
    let is_given = |name: &str| {
        let mut given = shape.terms.iter().filter(|term| term.given);
        given.any(|term| term.id.name() == name)
    };
    let of_this_log = |starts: &&Starts| {
        let holds = |[one, other]: [Scaled; 2]| size(one) > size(other);
        wanted(starts) && starts.exceeds.is_none_or(holds) && starts.beside.is_none_or(is_given)
    };
    let all = id.info().starts.iter().filter(of_this_log);
    let mut terms: Vec<Term> = all
        .flat_map(|starts| combinations(id, starts, size))
        .collect();
    // A Coulomb friction is the kinetic force of Stribeck's: beside each other neither number could be told, nor the static
    // force above them.
    if id == EffectId::StribeckFriction && is_given(EffectId::CoulombFriction.name()) {
        for term in &mut terms {
            (term.row[0], term.free[0]) = (0.0, false);
        }
    }
    terms
}

/// Whether an effect means anything on the law that is fitted.
fn has_meaning(id: EffectId, shape: &Shape) -> bool {
    let exponential = shape.base.has("stiffening_rate");
    match id.info().laws {
        Laws::AnyLaw => true,
        Laws::LinearElasticity => !exponential && !shape.base.has("exponent"),
        Laws::LinearDamping => shape.base.law == LawId::KelvinVoigt,
        Laws::NotExponential => !exponential,
    }
}

/// Every combination of the values of the parameters.
fn combinations(id: EffectId, starts: &Starts, size: impl Fn(Scaled) -> f64) -> Vec<Term> {
    let mut terms = vec![whole(id, [0.0; MOST_PARAMETERS], 0)];
    for (at, values) in starts.values.iter().enumerate() {
        let numbers = numbers(values, &size);
        let with = |term: Term| {
            numbers.iter().map(move |number| {
                let mut term = term.clone();
                term.row[at] = *number;
                term.free[at] = !matches!(values, StartValues::Held(_));
                term
            })
        };
        terms = terms.into_iter().flat_map(with).collect();
    }
    terms
}

/// The values of one parameter in its unit.
fn numbers(values: &StartValues, size: impl Fn(Scaled) -> f64) -> Vec<f64> {
    match *values {
        StartValues::At(number) => vec![size(number)],
        StartValues::Each(numbers) => numbers.iter().copied().map(size).collect(),
        StartValues::Series(series) => {
            let [lowest, highest] = series.powers;
            let numbers = (lowest..=highest).map(|k| size(series.first) * series.ratio.powi(k));
            let below = size(series.below);
            numbers.filter(|number| *number < below).collect()
        }
        StartValues::Held(number) => vec![number],
    }
}

#[cfg(test)]
pub(in crate::gap) mod tests {
    use super::*;
    use crate::gap::data::fit_data::FitData;
    use crate::log::Log;
    use crate::model::Model;
    use crate::toml_reader::TomlFile;
    use std::path::Path;

    /// A contact, and the scales of a log that goes 1 mm to and fro.
    pub(in crate::gap) fn contact() -> (Model, Scales) {
        let path = Path::new("model.toml");
        let text = "[environment]\nlaw = \"kelvin_voigt\"\nstiffness = 1000.0\ndamping = 3.0\n";
        let file = TomlFile::parse(text.into(), path).unwrap();
        let time: Vec<f64> = (0..2000).map(|at| f64::from(at) * 1e-3).collect();
        let position: Vec<f64> = time.iter().map(|t| 1e-3 * (6.3 * t).sin()).collect();
        let force = position.iter().map(|x| 1e3 * x.max(0.0)).collect();
        let log = Log::from_channels(time, position, force).uniform().unwrap();
        let model = Model::from_toml(&file, path).unwrap();
        (model, Scales::of(&[FitData::of(&log)]))
    }

    #[test]
    fn a_rig_has_one_dry_friction_that_was_added_and_more_beside_one_that_is_given() {
        let (model, scales) = contact();
        let is_possible = |id: EffectId, given: bool| {
            let friction = Term {
                given,
                ..of_size(EffectId::CoulombFriction, 0.4)
            };
            is_possible(id, &Shape::new(&model.environment, vec![friction], &scales))
        };
        for richer in [EffectId::StribeckFriction, EffectId::BoucWen] {
            assert!(!is_possible(richer, false) && is_possible(richer, true));
        }
        // A drag is another thing.
        assert!(is_possible(EffectId::ViscousDrag, false));
    }
}
