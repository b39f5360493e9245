//! The environment: a contact law by name, with its parameters.

use estimator_core::maths::scalar::Scalar;
use estimator_core::physics::law::{
    DEFAULT_REFERENCE_DEPTH_M, Law, LawId, ParameterInfo, RELAXATION, Recovery, STIFFENING_RATE,
    SURFACE,
};

use super::fit::Fit;
use crate::diagnostic::{Diagnostic, listed, nearest};
use crate::plant::Contact;
use crate::toml_reader::{Bounds, Table};

/// What is touched.
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    /// The law.
    pub law: LawId,
    /// The law's parameters: those that it always has, optional ones that are given, relaxation modes.
    pub values: Vec<Parameter>,
    /// Position of the surface (m).
    pub surface_m: f64,
    /// δ₀ (m), at which stiffness and damping hold.
    pub reference_depth_m: f64,
    /// How the surface comes back after a touch, if the file says it: with the probe else.
    pub recovery: Option<Recovery>,
    /// What a fit must not move and what it found.
    pub fit: Fit,
}

/// A parameter by the name that it has in files.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Key in `model.toml`; of a relaxation mode `relaxation_fraction_1`, `relaxation_rate_1`, ….
    pub name: String,
    /// Value in `unit`.
    pub value: f64,
    /// Unit as in reports.
    pub unit: &'static str,
}

/// Keys of every environment.
const COMMON_KEYS: [&str; 6] = [
    "law",
    "surface",
    "reference_depth",
    "recovery",
    "fixed",
    "std_error",
];

impl Environment {
    pub(super) fn from_table(table: &Table<'_>) -> Result<Environment, Diagnostic> {
        let names: Vec<&str> = LawId::ALL.iter().flat_map(|law| law.names()).collect();
        let name = table.required_text("law", &names)?;
        let law = LawId::from_name(name).ok_or_else(|| unknown_law(table, name, &names))?;
        table.understand(&keys_of(law));
        table.understand(&COMMON_KEYS);
        let values = values(law, table)?;
        let reference = table.number("reference_depth", Bounds::Positive)?;
        let mut environment = Environment {
            law,
            values,
            surface_m: table.number(SURFACE.name, SURFACE.bounds)?.unwrap_or(0.0),
            reference_depth_m: reference.unwrap_or(DEFAULT_REFERENCE_DEPTH_M),
            recovery: recovery(table)?,
            fit: Fit::default(),
        };
        let names: Vec<String> = environment
            .parameters()
            .into_iter()
            .map(|p| p.name)
            .collect();
        environment.fit = Fit::from_table(table, &names)?;
        table.finish()?;
        Ok(environment)
    }

    /// Whether there is nothing to touch.
    pub fn is_free(&self) -> bool {
        self.law == LawId::Free
    }

    /// Whether the law has a parameter of that name here.
    pub fn has(&self, name: &str) -> bool {
        self.values.iter().any(|parameter| parameter.name == name)
    }

    /// The law's parameters, then the surface. The reference depth is a choice, no parameter.
    pub fn parameters(&self) -> Vec<Parameter> {
        let mut parameters = self.values.clone();
        if !self.is_free() {
            parameters.push(parameter(&SURFACE, self.surface_m));
        }
        parameters
    }

    /// The same law with other values, in the order of [`Environment::parameters`]; what is missing
    /// stays.
    #[must_use]
    pub fn with_values(&self, values: &[f64]) -> Environment {
        let mut environment = self.clone();
        let mut values = values.iter();
        for (parameter, value) in environment.values.iter_mut().zip(values.by_ref()) {
            parameter.value = *value;
        }
        match values.next() {
            Some(surface_m) if !self.is_free() => environment.surface_m = *surface_m,
            _ => {}
        }
        environment
    }

    /// Fraction and rate (1/s) of each relaxation mode, fast to slow.
    pub(super) fn modes(&self) -> impl Iterator<Item = (f64, f64)> {
        let modes = &self.values[self.values.len() - self.mode_values()..];
        modes
            .chunks_exact(2)
            .map(|mode| (mode[0].value, mode[1].value))
    }

    /// The number of values that belong to relaxation modes; they are the last.
    fn mode_values(&self) -> usize {
        let values = self.values.iter();
        values
            .filter(|own| own.name.starts_with("relaxation_"))
            .count()
    }

    /// The law with other values, in the order of [`Environment::parameters`]; `None` if it has more
    /// relaxation modes than the core's laws have.
    pub(crate) fn law_with<S: Scalar>(&self, values: &[S]) -> Option<Law<S>> {
        let value = |name: &str| {
            let at = self.values.iter().position(|own| own.name == name)?;
            values.get(at).copied()
        };
        let reference_depth_m = S::from_f64(self.reference_depth_m);
        Law::from_values(self.law, self.mode_values() / 2, value, reference_depth_m)
    }

    /// The environment as the simulated rig can have it; `None` if it has more relaxation modes than
    /// the core's laws have.
    pub fn contact(&self) -> Option<Contact> {
        let values: Vec<f64> = self.values.iter().map(|own| own.value).collect();
        Some(Contact {
            law: self.law_with(&values)?,
            surface_m: self.surface_m,
            recovery: self.recovery.unwrap_or_default(),
        })
    }
}

/// A parameter with its value.
fn parameter(info: &ParameterInfo, value: f64) -> Parameter {
    Parameter {
        name: info.name.to_string(),
        value,
        unit: info.unit.symbol(),
    }
}

fn keys_of(law: LawId) -> Vec<&'static str> {
    let info = law.info();
    let parameters = info.parameters.iter().chain(info.optional);
    let mut keys: Vec<&str> = parameters.map(|parameter| parameter.name).collect();
    if has_exponential_form(law) {
        keys.push("elastic");
    }
    if info.most_modes > 0 {
        keys.push("relaxation");
    }
    keys
}

/// Whether the elastic response can be an exponential in place of a power.
fn has_exponential_form(law: LawId) -> bool {
    law.info().optional.contains(&STIFFENING_RATE)
}

/// The parameters of a law as a file gives them.
fn values(law: LawId, table: &Table<'_>) -> Result<Vec<Parameter>, Diagnostic> {
    let exponential = has_exponential_form(law);
    let mut values = Vec::new();
    for info in law.info().parameters {
        values.push(match exponential && info.name == "exponent" {
            true => elastic(table, info)?,
            false => parameter(info, table.required_number(info.name, info.bounds)?),
        });
    }
    let optional = law.info().optional.iter();
    for info in optional.filter(|info| **info != STIFFENING_RATE) {
        let given = table.number(info.name, info.bounds)?;
        values.extend(given.map(|value| parameter(info, value)));
    }
    if law.info().most_modes > 0 {
        values.extend(relaxation(table)?);
    }
    Ok(values)
}

/// `exponent`, or `stiffening_rate` (also as `elastic = "exponential"` with `rate`).
fn elastic(table: &Table<'_>, exponent: &ParameterInfo) -> Result<Parameter, Diagnostic> {
    let exponential = match table.text("elastic")? {
        None => None,
        Some("power") => Some(false),
        Some("exponential") => Some(true),
        Some(other) => {
            return Err(table
                .wrong("elastic", format!("unknown elastic response `{other}`"))
                .remedy(
                    "write \"power\" (with exponent) or \"exponential\" (with stiffening_rate)",
                ));
        }
    };
    let (key, bounds) = (STIFFENING_RATE.name, STIFFENING_RATE.bounds);
    let rate = table.number(key, bounds)?;
    let rate = match exponential {
        Some(true) => rate.or(table.number("rate", bounds)?),
        _ => rate,
    };
    match (exponential, rate) {
        (Some(false), Some(_)) => Err(table
            .wrong(key, "a power law has no stiffening rate")
            .remedy("remove it, or write elastic = \"exponential\"")),
        (_, Some(_)) if table.number(exponent.name, exponent.bounds)?.is_some() => Err(table
            .wrong(exponent.name, "an exponential response has no exponent")
            .remedy("remove it, or remove the stiffening rate")),
        (_, Some(rate)) => Ok(parameter(&STIFFENING_RATE, rate)),
        (Some(true), None) => Ok(parameter(
            &STIFFENING_RATE,
            table.required_number(key, bounds)?,
        )),
        (_, None) => Ok(parameter(
            exponent,
            table.required_number(exponent.name, exponent.bounds)?,
        )),
    }
}

/// How the surface comes back.
fn recovery(table: &Table<'_>) -> Result<Option<Recovery>, Diagnostic> {
    let Some(name) = table.text("recovery")? else {
        return Ok(None);
    };
    match Recovery::from_name(name) {
        Some(own) => Ok(Some(own)),
        None => Err(table
            .wrong("recovery", format!("unknown recovery `{name}`"))
            .remedy(
                "write \"with_probe\" (the surface follows the probe) or \"creep\" (a dent stays, and fills as the \
                 material creeps)",
            )),
    }
}

/// Fraction and rate of every relaxation mode, one after another.
fn relaxation(table: &Table<'_>) -> Result<Vec<Parameter>, Diagnostic> {
    let [[fraction, rate], ..] = RELAXATION;
    let (mut values, mut sum) = (Vec::new(), 0.0);
    for (at, mode) in table.tables("relaxation")?.iter().enumerate() {
        let fields = [("fraction", fraction), ("rate", rate)];
        for (key, info) in fields {
            values.push(Parameter {
                name: format!("relaxation_{key}_{}", at + 1),
                ..parameter(info, mode.required_number(key, info.bounds)?)
            });
        }
        mode.finish()?;
        sum += values[2 * at].value;
    }
    if sum >= 1.0 {
        return Err(table
            .wrong(
                "relaxation",
                "the relaxation fractions leave nothing at rest",
            )
            .value(sum)
            .remedy("their sum must be less than 1: the rest is the force that stays"));
    }
    Ok(values)
}

fn unknown_law(table: &Table<'_>, name: &str, known: &[&str]) -> Diagnostic {
    let names = || known.iter().copied();
    let diagnostic = table
        .wrong("law", format!("unknown law `{name}`"))
        .note(format!("the laws are {}", listed(names())));
    match nearest(name, names()) {
        Some(near) => diagnostic.remedy(format!("write \"{near}\"")),
        None => diagnostic.remedy("write one of them"),
    }
}
