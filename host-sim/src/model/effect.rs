//! Effects of a rig as a model file names them, and as the core computes them.

use estimator_core::physics::effect::{self, EffectId, MOST_PARAMETERS};

use super::fit::Fit;
use crate::diagnostic::{Diagnostic, listed, nearest};
use crate::toml_reader::{Bounds, Table};

/// Something that the rig adds: an id of the catalogue with its parameters.
///
/// The parameters of an effect of the catalogue are checked as it is read. An unknown id reads, so
/// that a file of a later version can be shown; [`Effect::core`] refuses it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Effect {
    /// Id in the catalogue, such as `coulomb_friction`.
    pub id: String,
    /// Its parameters in SI units.
    pub parameters: Vec<(String, f64)>,
    /// What a fit must not move and what it found.
    pub fit: Fit,
    /// Line in the file, from 1, for errors about it.
    pub line: Option<usize>,
}

impl Effect {
    pub(super) fn from_table(table: &Table<'_>) -> Result<Effect, Diagnostic> {
        let id = table
            .required_text("id", &["coulomb_friction", "tool_inertia"])?
            .to_string();
        let (names, parameters) = match EffectId::from_name(&id) {
            Some(known) => of_the_catalogue(known, table)?,
            None => whatever(table)?,
        };
        let fit = Fit::from_table(table, &names)?;
        table.finish()?;
        Ok(Effect {
            id,
            parameters,
            fit,
            line: table.line(),
        })
    }

    /// The value of a parameter.
    pub fn parameter(&self, name: &str) -> Option<f64> {
        let found = self.parameters.iter().find(|(key, _)| key == name)?;
        Some(found.1)
    }

    /// The effect as the core computes it; parameters that are not given are the usual ones.
    ///
    /// # Errors
    /// An id or a parameter that the catalogue does not have, a parameter that is missing or cannot
    /// have its value. The line is that of the effect.
    pub fn core(&self) -> Result<effect::Effect<f64>, Diagnostic> {
        let id = EffectId::from_name(&self.id).ok_or_else(|| self.unknown())?;
        let known = id.info().parameters;
        if let Some((name, _)) = self
            .parameters
            .iter()
            .find(|(name, _)| known.iter().all(|info| info.name != name))
        {
            let names: Vec<String> = known.iter().map(|info| info.name.to_string()).collect();
            let here = self.wrong("").at_key(&format!("effect.{name}"));
            return Err(super::fit::unknown_parameter(here, name, &names));
        }
        let mut row = [0.0; MOST_PARAMETERS];
        for (own, info) in row.iter_mut().zip(known) {
            let value = self.parameter(info.name).or(info.default);
            *own = value.ok_or_else(|| self.wrong_value(info, None))?;
            if !info.bounds.allow(*own) {
                return Err(self.wrong_value(info, Some(*own)));
            }
        }
        Ok(effect::Effect::new(id, &row))
    }

    fn unknown(&self) -> Diagnostic {
        let names = || EffectId::ALL.iter().map(|id| id.name());
        let diagnostic = self
            .wrong(format!("unknown effect `{}`", self.id))
            .at_key("effect.id")
            .value(&self.id)
            .note(format!("the effects are {}", listed(names())));
        match nearest(&self.id, names()) {
            Some(near) => diagnostic.remedy(format!("write \"{near}\"")),
            None => diagnostic.remedy("`palpate effects` says what each of them is"),
        }
    }

    fn wrong_value(&self, info: &effect::ParameterInfo, value: Option<f64>) -> Diagnostic {
        let what = match value {
            None => format!("`{}` is missing", info.name),
            Some(_) => "a number outside its bounds".to_string(),
        };
        let mut diagnostic = self
            .wrong(what)
            .at_key(&format!("effect.{}", info.name))
            .remedy(format!(
                "`{}` of {} is {}, in {}",
                info.name,
                self.id,
                info.bounds.name(),
                info.unit
            ));
        diagnostic.value = value.map(|value| value.to_string());
        diagnostic
    }

    /// An error about this effect.
    pub(super) fn wrong(&self, what: impl Into<String>) -> Diagnostic {
        let mut diagnostic = Diagnostic::new(what);
        diagnostic.line = self.line;
        diagnostic
    }
}

/// The parameters of an effect with their values, named as in files; those that are at their usual
/// value because nobody wrote them are named too.
impl From<effect::Effect<f64>> for Effect {
    fn from(core: effect::Effect<f64>) -> Effect {
        let parameters = core.id().info().parameters.iter().zip(core.row());
        Effect {
            id: core.id().name().to_string(),
            parameters: parameters
                .map(|(info, value)| (info.name.to_string(), value))
                .collect(),
            ..Effect::default()
        }
    }
}

type Parameters = (Vec<String>, Vec<(String, f64)>);

/// The parameters of an effect of the catalogue: names that a fit may use, values that are given.
fn of_the_catalogue(id: EffectId, table: &Table<'_>) -> Result<Parameters, Diagnostic> {
    let known = id.info().parameters;
    let names: Vec<&str> = known.iter().map(|info| info.name).collect();
    table.understand(&names);
    table.understand(&["fixed", "std_error"]);
    let mut given = Vec::new();
    for info in known {
        let value = match info.default {
            None => Some(table.required_number(info.name, info.bounds)?),
            Some(_) => table.number(info.name, info.bounds)?,
        };
        given.extend(value.map(|value| (info.name.to_string(), value)));
    }
    Ok((names.into_iter().map(str::to_string).collect(), given))
}

/// Whatever an unknown effect has.
fn whatever(table: &Table<'_>) -> Result<Parameters, Diagnostic> {
    let mut names = table.remaining_keys();
    names.retain(|key| key != "fixed" && key != "std_error");
    let value = |name: &String| -> Result<(String, f64), Diagnostic> {
        Ok((name.clone(), table.required_number(name, Bounds::Any)?))
    };
    let parameters = names.iter().map(value).collect::<Result<_, _>>()?;
    Ok((names, parameters))
}

#[cfg(test)]
mod tests;
