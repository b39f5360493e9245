//! What is fitted: the base's law with a list of effects, and which of their numbers are free.
//!
//! A free number is a parameter in SI units, or the logarithm of one that has no scale of its own
//! (stiffness, rates). Bounds are physical ones and those that the log sets: no rate slower than the
//! log is long, no pitch longer than the travel.

use estimator_core::maths::scalar::Scalar;
use estimator_core::physics::effect::{Effect, EffectId, MOST_PARAMETERS, Role};
use estimator_core::physics::fit_range::{FitRange, Scale};
use estimator_core::physics::law::{Law, LawId};
use estimator_core::physics::rig::{Environment, Rig};

use crate::gap::data::scales::Scales;
use crate::lsq::minimize::Limits;
use crate::model;

/// An effect in a fit: its numbers, and which of them are free.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::gap) struct Term {
    pub(in crate::gap) id: EffectId,
    /// Values of those that are not free, starts of those that are.
    pub(in crate::gap) row: [f64; MOST_PARAMETERS],
    pub(in crate::gap) free: [bool; MOST_PARAMETERS],
    /// Whether it stands in the base model, and stays.
    pub(in crate::gap) given: bool,
    /// Which numbers one that is given may take on, although the model file does not give them.
    pub(in crate::gap) open: [bool; MOST_PARAMETERS],
}

/// Whose number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::gap) enum Owner {
    /// Number of a parameter of [`model::Environment::parameters`].
    Environment(usize),
    /// Effect and parameter.
    Effect(usize, usize),
}

/// A free number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::gap) struct Free {
    pub(in crate::gap) owner: Owner,
    /// Whether the free number is the logarithm of the parameter.
    pub(in crate::gap) logarithmic: bool,
    pub(in crate::gap) lowest: f64,
    pub(in crate::gap) highest: f64,
}

/// A law with effects.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::gap) struct Shape {
    /// The base model's environment; its values are those of what is not free.
    pub(in crate::gap) base: model::Environment,
    pub(in crate::gap) terms: Vec<Term>,
    pub(in crate::gap) free: Vec<Free>,
}

impl Shape {
    /// Where a fit may take the free numbers. A logarithm moves by 2 at most in a step, a factor of 7.
    pub(in crate::gap) fn limits(&self) -> Vec<Limits> {
        let limits = |free: &Free| Limits {
            lowest: free.lowest,
            highest: free.highest,
            longest_step: if free.logarithmic { 2.0 } else { f64::INFINITY },
        };
        self.free.iter().map(limits).collect()
    }

    /// A law with these effects: free is what the base model does not fix.
    pub(in crate::gap) fn new(
        base: &model::Environment,
        terms: Vec<Term>,
        scales: &Scales,
    ) -> Shape {
        let mut free = Vec::new();
        let parameters = base.parameters();
        let surface = parameters.iter().find(|own| own.name == "surface");
        let depth_m = surface.map_or(0.0, |own| scales.deepest_m - own.value);
        for (at, parameter) in parameters.iter().enumerate() {
            if !base.fit.fixed.contains(&parameter.name) {
                let mut own = of_environment(at, parameter, scales);
                if base.law == LawId::Zener && parameter.name == "damping" {
                    // It sets a rate.
                    own = logarithmic(own.owner, 1e-6 * parameter.value, 1e6 * parameter.value);
                }
                free.push(own);
            }
        }
        for (number, term) in terms.iter().enumerate() {
            for at in (0..term.id.info().parameters.len()).filter(|at| term.free[*at]) {
                let own = of_effect(term.id, number, at, scales, depth_m);
                free.push(match term.given {
                    true => own.around(term.row[at]),
                    false => own,
                });
            }
        }
        Shape {
            base: base.clone(),
            terms,
            free,
        }
    }

    /// How many of the free numbers are the environment's: they come first.
    pub(in crate::gap) fn environment_count(&self) -> usize {
        let own = |free: &&Free| matches!(free.owner, Owner::Environment(_));
        self.free.iter().take_while(own).count()
    }

    /// The free numbers as they stand in the base model and the terms, within their bounds.
    pub(in crate::gap) fn start(&self) -> Vec<f64> {
        let base = self.base.parameters();
        let natural = |owner: Owner| match owner {
            Owner::Environment(at) => base[at].value,
            Owner::Effect(number, at) => self.terms[number].row[at],
        };
        self.free
            .iter()
            .map(|free| free.number(natural(free.owner)))
            .collect()
    }

    /// The parameter (SI) that a free number means.
    pub(in crate::gap) fn natural<S: Scalar>(&self, at: usize, number: S) -> S {
        if self.free[at].logarithmic {
            number.exp()
        } else {
            number
        }
    }

    /// The position (m) of the surface with the values of free numbers.
    pub(in crate::gap) fn surface_at(&self, numbers: &[f64]) -> f64 {
        let parameters = self.base.parameters();
        let Some(own) = parameters.iter().position(|own| own.name == "surface") else {
            return f64::NEG_INFINITY;
        };
        let free = self
            .free
            .iter()
            .position(|free| free.owner == Owner::Environment(own));
        free.map_or(parameters[own].value, |at| self.natural(at, numbers[at]))
    }

    /// The terms with the values of free numbers.
    pub(in crate::gap) fn terms_at(&self, numbers: &[f64]) -> Vec<Term> {
        let mut terms = self.terms.clone();
        for (at, free) in self.free.iter().enumerate() {
            if let Owner::Effect(number, parameter) = free.owner {
                terms[number].row[parameter] = self.natural(at, numbers[at]);
            }
        }
        terms
    }

    /// Values of all parameters of the environment, in the order of the model.
    pub(in crate::gap) fn environment_at(&self, numbers: &[f64]) -> Vec<f64> {
        let mut values: Vec<f64> = self.base.parameters().iter().map(|own| own.value).collect();
        for (at, free) in self.free.iter().enumerate() {
            if let Owner::Environment(parameter) = free.owner {
                values[parameter] = self.natural(at, numbers[at]);
            }
        }
        values
    }

    /// The free numbers that say how much there is of a term: its first one, and further sizes. The kinetic force of a
    /// Stribeck friction beside a Coulomb friction may well be none: its static force says it then.
    pub(in crate::gap) fn sizes_of(&self, term: usize) -> impl Iterator<Item = usize> + '_ {
        let fits = self.terms[term].id.info().fits;
        let is_further = |place: usize| matches!(fits[place].role, Role::Size);
        let is_own = move |free: &Free| match free.owner {
            Owner::Effect(of, place) => of == term && (place == 0 || is_further(place)),
            _ => false,
        };
        (0..self.free.len()).filter(move |at| is_own(&self.free[*at]))
    }

    /// From the lowest to the highest value of a free number, in the parameter's unit; infinite without bounds.
    pub(in crate::gap) fn room(&self, at: usize) -> f64 {
        let Free {
            lowest, highest, ..
        } = self.free[at];
        self.natural(at, highest) - self.natural(at, lowest)
    }

    /// The rig that free numbers mean.
    pub(in crate::gap) fn rig<S: Scalar>(&self, numbers: &[S]) -> Rig<S> {
        let parameters = self.base.parameters();
        let mut values: Vec<S> = parameters
            .iter()
            .map(|own| S::from_f64(own.value))
            .collect();
        let mut rows: Vec<[S; MOST_PARAMETERS]> = self
            .terms
            .iter()
            .map(|term| term.row.map(S::from_f64))
            .collect();
        for (at, free) in self.free.iter().enumerate() {
            let value = self.natural(at, numbers[at]);
            match free.owner {
                Owner::Environment(parameter) => values[parameter] = value,
                Owner::Effect(number, parameter) => rows[number][parameter] = value,
            }
        }
        let mut rig = Rig::bare(environment(&self.base, &values));
        for (term, row) in self.terms.iter().zip(&rows) {
            rig = rig.with(Effect::new(term.id, row));
        }
        rig
    }
}

impl Free {
    /// The free number of a parameter, within the bounds.
    pub(in crate::gap) fn number(&self, natural: f64) -> f64 {
        let number = if self.logarithmic {
            natural.max(f64::MIN_POSITIVE).ln()
        } else {
            natural
        };
        number.clamp(self.lowest, self.highest)
    }

    /// The bounds with those around a value that the user gave, from half of it to twice it where it lies without:
    /// he may know what this log is too short to show.
    fn around(self, natural: f64) -> Free {
        let number = |natural: f64| match self.logarithmic {
            true => natural.ln(),
            false => natural,
        };
        let (own, ends) = (number(natural), [0.5, 2.0].map(|of| number(of * natural)));
        if !own.is_finite() || (self.lowest..=self.highest).contains(&own) {
            return self;
        }
        if self.lowest == self.highest {
            return Free {
                lowest: own,
                highest: own,
                ..self
            };
        }
        let [low, high] = [ends[0].min(ends[1]), ends[0].max(ends[1])];
        Free {
            lowest: self.lowest.min(low),
            highest: self.highest.max(high),
            ..self
        }
    }

    /// Whether a free number lies at its lowest value.
    pub(in crate::gap) fn is_at_lowest(&self, number: f64) -> bool {
        self.is_at_bound(number) && number - self.lowest < self.highest - number
    }

    /// Whether a free number lies at its highest value.
    pub(in crate::gap) fn is_at_highest(&self, number: f64) -> bool {
        self.is_at_bound(number) && number - self.lowest > self.highest - number
    }

    /// Whether a free number lies at its bound: a parameter that wants to be what it cannot be.
    pub(in crate::gap) fn is_at_bound(&self, number: f64) -> bool {
        // A number without a highest value has no range to be near the end of.
        let range = self.highest - self.lowest;
        let room = match self.logarithmic {
            true => 1e-3,
            false if range.is_finite() => 1e-6 * range,
            false => 0.0,
        };
        (self.lowest.is_finite() && number <= self.lowest + room)
            || (self.highest.is_finite() && number >= self.highest - room)
    }
}

/// The environment of a model with other values, in the order of [`model::Environment::parameters`].
fn environment<S: Scalar>(base: &model::Environment, values: &[S]) -> Environment<S> {
    // Models with more modes than a law has are refused before anything is fitted.
    let law = base.law_with(values).unwrap_or(Law::Free);
    match (law, values.last()) {
        (Law::Free, _) | (_, None) => Environment::free(),
        (law, Some(surface_m)) => law
            .parts(S::from_f64(base.reference_depth_m))
            .at(*surface_m)
            .recovering(base.recovery.unwrap_or_default()),
    }
}

// Where a log leaves a number no room it is held at the lowest: of a travel of 0.5 mm in counts of 0.1 mm a width of two
// counts is more than a tenth.
fn linear(owner: Owner, lowest: f64, highest: f64) -> Free {
    Free {
        owner,
        logarithmic: false,
        lowest,
        highest: highest.max(lowest),
    }
}

fn logarithmic(owner: Owner, lowest: f64, highest: f64) -> Free {
    let own = |natural: f64| natural.max(f64::MIN_POSITIVE).ln();
    Free {
        logarithmic: true,
        ..linear(owner, own(lowest), own(highest))
    }
}

/// Slowest and fastest rate that a log can tell (1/s).
fn rates(scales: &Scales) -> (f64, f64) {
    (0.1 / scales.duration_s, 0.5 / scales.period_s)
}

fn of_environment(at: usize, parameter: &model::Parameter, scales: &Scales) -> Free {
    let owner = Owner::Environment(at);
    let name = parameter.name.as_str();
    match name {
        "stiffness" | "second_stiffness" => {
            logarithmic(owner, 1e-6 * parameter.value, 1e6 * parameter.value)
        }
        "damping" if parameter.value > 0.0 => linear(owner, 0.0, 1e4 * parameter.value),
        "damping" => linear(
            owner,
            0.0,
            1e3 * scales.force_n / scales.speed_mps.max(1e-12),
        ),
        "exponent" | "damping_exponent" => linear(owner, 0.3, 5.0),
        "stiffening_rate" => linear(owner, 0.0, 50.0 / scales.travel_m),
        "surface" => linear(
            owner,
            parameter.value - scales.travel_m,
            parameter.value + scales.travel_m,
        ),
        _ if name.starts_with("relaxation_fraction") => linear(owner, 0.0, 0.95),
        _ => {
            let (slowest, fastest) = rates(scales);
            let own = parameter.value;
            logarithmic(owner, slowest.min(own), fastest.max(own))
        }
    }
}

/// An encoder's error has so many cycles in contact, or it is any law's form: with one and a quarter it fitted other
/// effects, at a pitch of 0.6 to 0.7 of the depth. With two and a half true ones of 1.5 to 2.6 came with a snap, a layer
/// and a delay, six of eight times.
pub(in crate::gap) const FEWEST_CYCLES: f64 = 1.5;

/// `depth_m` is the deepest press as the model file has the surface.
fn of_effect(id: EffectId, number: usize, at: usize, scales: &Scales, depth_m: f64) -> Free {
    let owner = Owner::Effect(number, at);
    let size = |scale| match scale {
        Scale::PitchInContact => {
            (depth_m / FEWEST_CYCLES).clamp(0.05 * scales.travel_m, scales.size(scale))
        }
        _ => scales.size(scale),
    };
    match id.info().fits[at].range {
        FitRange::Linear(low, high) => linear(owner, low.value(size), high.value(size)),
        FitRange::Logarithmic(low, high) => logarithmic(owner, low.value(size), high.value(size)),
        FitRange::Fixed(value) => linear(owner, value, value),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_that_the_user_gave_is_within_the_bounds() {
        let owner = Owner::Effect(0, 1);
        let natural = |free: Free| {
            let of = |number: f64| {
                if free.logarithmic {
                    number.exp()
                } else {
                    number
                }
            };
            [of(free.lowest), of(free.highest)]
        };
        let is_near = |own: [f64; 2], expected: [f64; 2]| {
            let each = own.iter().zip(expected);
            each.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) < 1e-12
        };
        // GIVEN a pitch that may be 0.1 to 0.9 mm long, and is given as 1.6 mm
        for free in [linear(owner, 1e-4, 9e-4), logarithmic(owner, 1e-4, 9e-4)] {
            // THEN it is where it was put, and not at a bound.
            let wider = free.around(1.6e-3);
            assert!(is_near(natural(wider), [1e-4, 3.2e-3]));
            assert!(!wider.is_at_bound(wider.number(1.6e-3)));
            assert!(is_near(natural(free.around(2e-5)), [1e-5, 9e-4]));
            // AND one within them changes nothing, as 0 does not where a number is a logarithm.
            assert_eq!(free.around(5e-4), free);
        }
        assert_eq!(
            logarithmic(owner, 1.0, 2.0).around(0.0),
            logarithmic(owner, 1.0, 2.0)
        );
        // A number that no fit moves is held where the user has it.
        assert!(is_near(
            natural(linear(owner, 2.0, 2.0).around(1.5)),
            [1.5, 1.5]
        ));
    }
}
