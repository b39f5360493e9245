//! What is fitted: the base's law with a list of effects, and which of their numbers are free.
//!
//! A free number is a parameter in SI units, or the logarithm of one that has no scale of its own
//! (stiffness, rates). Bounds are physical ones and those that the log sets: no rate slower than the
//! log is long, no pitch longer than the travel.

use estimator_core::maths::scalar::Scalar;
use estimator_core::physics::effect::{Effect, EffectId, MOST_PARAMETERS};
use estimator_core::physics::law::{Elastic, RelaxationMode};
use estimator_core::physics::rig::{Damping, Environment, Rig};

use crate::gap::data::scales::Scales;
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
                if matches!(base.law, model::EnvironmentLaw::Zener { .. })
                    && parameter.name == "damping"
                {
                    // It sets a rate.
                    own = logarithmic(own.owner, 1e-6 * parameter.value, 1e6 * parameter.value);
                }
                free.push(own);
            }
        }
        for (number, term) in terms.iter().enumerate() {
            for at in (0..term.id.info().parameters.len()).filter(|at| term.free[*at]) {
                free.push(of_effect(term.id, number, at, scales, depth_m));
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
    use model::EnvironmentLaw as Law;
    let mut values = values.iter().copied();
    let mut next = || values.next().unwrap_or(S::zero());
    let reference = S::from_f64(base.reference_depth_m);
    let power = |stiffness_n_per_m: S, exponent: S| {
        Some(Elastic::Power {
            stiffness_n_per_m,
            exponent,
            reference_depth_m: reference,
        })
    };
    let damper = |coefficient_ns_per_m: S, exponent: S| {
        Some(Damping {
            coefficient_ns_per_m,
            exponent,
            reference_depth_m: reference,
        })
    };
    let mut own = Environment::free();
    match &base.law {
        Law::Free => return own,
        Law::KelvinVoigt { .. } => {
            own.elastic = power(next(), S::one());
            own.damping = damper(next(), S::zero());
        }
        Law::HuntCrossley {
            damping_exponent, ..
        } => {
            let (stiffness, damping, exponent) = (next(), next(), next());
            let second = damping_exponent.map_or(exponent, |_| next());
            own.elastic = power(stiffness, exponent);
            own.damping = damper(damping, second);
        }
        Law::Zener { .. } => {
            let (first, second, damping) = (next(), next(), next());
            own.elastic = power(first, S::one());
            own.modes[0] = RelaxationMode {
                fraction: first / (first + second),
                rate_per_s: (first + second) / damping,
            };
        }
        Law::QuasiLinear {
            elastic,
            relaxation,
            ..
        } => {
            let (stiffness, shape) = (next(), next());
            own.elastic = match elastic {
                model::Elastic::Power { .. } => power(stiffness, shape),
                model::Elastic::Exponential { .. } => Some(Elastic::Exponential {
                    stiffness_n_per_m: stiffness,
                    stiffening_rate_per_m: shape,
                }),
            };
            for mode in own.modes.iter_mut().take(relaxation.len()) {
                *mode = RelaxationMode {
                    fraction: next(),
                    rate_per_s: next(),
                };
            }
        }
    }
    own.surface_m = next();
    own
}

fn linear(owner: Owner, lowest: f64, highest: f64) -> Free {
    Free {
        owner,
        logarithmic: false,
        lowest,
        highest,
    }
}

fn logarithmic(owner: Owner, lowest: f64, highest: f64) -> Free {
    Free {
        owner,
        logarithmic: true,
        lowest: lowest.max(f64::MIN_POSITIVE).ln(),
        highest: highest.max(f64::MIN_POSITIVE).ln(),
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

/// `depth_m` is the deepest press as the model file has the surface.
fn of_effect(id: EffectId, number: usize, at: usize, scales: &Scales, depth_m: f64) -> Free {
    use EffectId as E;
    let owner = Owner::Effect(number, at);
    let anything = f64::INFINITY;
    let s = scales;
    let (slowest, fastest) = rates(s);
    let stiffness = s.force_n / s.travel_m;
    let pitch = |at: usize, longest_m: f64| match at {
        0 => None,
        1 => Some(linear(owner, 4.0 * s.position_noise_m, longest_m)),
        _ => Some(linear(owner, -anything, anything)),
    };
    // An encoder's error shows in contact alone: a cycle and a quarter there, or it is any law's form.
    let seen_m = (depth_m / 1.25).clamp(0.05 * s.travel_m, 0.5 * s.travel_m);
    let frequency = |at: usize| match at {
        0 => None,
        1 => Some(linear(owner, 2.0 / s.duration_s, 0.5 / s.period_s)),
        _ => Some(linear(owner, -anything, anything)),
    };
    match (id, at) {
        (E::StressRelaxation, 0) => linear(owner, 0.0, 0.95),
        (E::StressRelaxation, _) => logarithmic(owner, slowest, fastest),
        (E::PowerLawStiffness, _) => linear(owner, 0.3, 5.0),
        (E::DepthDependentDamping, _) => linear(owner, 0.0, 4.0),
        (E::ExponentialStiffening, 1) => linear(owner, 0.0, 10.0),
        (E::ExponentialStiffening, _) => linear(owner, 0.0, 20.0 / s.travel_m),
        (E::Adhesion, 0) => linear(owner, 0.0, s.force_n),
        (E::Adhesion, 1) => linear(owner, 2.0 * s.position_noise_m, s.travel_m),
        // A form, not a number.
        (E::Adhesion, 2) => linear(owner, 1.0, 1.0),
        (E::Adhesion, _) => linear(owner, 0.0, 1.0),
        (E::PermanentSet, 0) => linear(owner, 0.0, 0.95),
        (E::PermanentSet, _) => linear(owner, 0.0, s.travel_m),
        (E::BuriedLayer, 0) => linear(owner, 0.0, 1e3 * stiffness),
        (E::BuriedLayer, 2) => logarithmic(owner, s.position_noise_m, 0.2 * s.travel_m),
        (E::BuriedLayer, _) => linear(owner, 0.02 * s.travel_m, 0.98 * s.travel_m),
        (E::SurfaceMotion, 0) => linear(owner, 0.0, 0.3 * s.travel_m),
        (E::SurfaceMotion, at) => frequency(at).unwrap_or(linear(owner, 0.0, anything)),
        (E::HystereticDamping, 0) => linear(owner, 0.0, s.force_n),
        (E::HystereticDamping, _) => logarithmic(owner, 2.0 * s.position_noise_m, s.travel_m),
        (E::CyclicSoftening, 0) => linear(owner, 0.0, 0.95),
        (E::CyclicSoftening, _) => logarithmic(owner, 4.0 * s.position_noise_m, 2.0 * s.travel_m),
        (E::CoulombFriction, 0) => linear(owner, 0.0, 2.0 * s.force_n),
        (E::CoulombFriction, 1) => logarithmic(owner, s.position_noise_m, 0.2 * s.travel_m),
        (E::CoulombFriction, _) | (E::StribeckFriction, 3) => {
            logarithmic(owner, 1e-3 * s.speed_mps, 0.5 * s.speed_mps)
        }
        (E::StribeckFriction, 2) => logarithmic(owner, 3e-3 * s.speed_mps, s.speed_mps),
        (E::StribeckFriction, _) => linear(owner, 0.0, 2.0 * s.force_n),
        (E::ViscousDrag | E::ToolInertia, _) => linear(owner, 0.0, anything),
        (E::AsymmetricDrag | E::ForceOffset | E::CableStiffness, _) => {
            linear(owner, -anything, anything)
        }
        (E::ForceDrift, 0) => linear(owner, -anything, anything),
        (E::ForceDrift, _) => logarithmic(owner, 10.0 * s.period_s, 3.0 * s.duration_s),
        (E::Cogging, 0) => linear(owner, 0.0, s.force_n),
        (E::Cogging, at) => pitch(at, 0.5 * s.travel_m).unwrap_or(linear(owner, 0.0, anything)),
        (E::PeriodicDisturbance, 0) => linear(owner, 0.0, s.force_n),
        (E::PeriodicDisturbance, at) => frequency(at).unwrap_or(linear(owner, 0.0, anything)),
        (E::SeriesCompliance, 0) => logarithmic(owner, 0.1 * stiffness, 1e3 * stiffness),
        (E::SeriesCompliance, _) => logarithmic(owner, 0.02 * s.force_n, 20.0 * s.force_n),
        (E::Backlash, _) => linear(owner, 0.0, 0.3 * s.travel_m),
        (E::ForceLag, _) => linear(owner, 0.02 * s.period_s, s.duration_s / 20.0),
        (E::TimeDelay, _) => linear(owner, -s.duration_s / 40.0, s.duration_s / 40.0),
        // A rounded limit is never quite reached.
        (E::ForceSaturation, 0) => linear(owner, 0.2 * s.highest_n, 1.5 * s.highest_n),
        (E::ForceSaturation, _) => logarithmic(owner, 1e-4 * s.highest_n, 0.3 * s.highest_n),
        (E::EncoderPeriodicError, 0) => linear(owner, 0.0, 0.05 * s.travel_m),
        (E::EncoderPeriodicError, at) => pitch(at, seen_m).unwrap_or(linear(owner, 0.0, anything)),
    }
}
