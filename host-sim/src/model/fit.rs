//! What a fit may move in a model, and what it found.

use crate::diagnostic::{Diagnostic, listed, nearest};
use crate::toml_reader::{Bounds, Table};

/// What a fit must not move and what it found, of an environment or an effect.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fit {
    /// Parameters that a fit must not move.
    pub fixed: Vec<String>,
    /// Standard errors of a fit, in the parameters' units.
    pub std_error: Vec<(String, f64)>,
}

impl Fit {
    /// The standard error of a parameter, in its unit, if a fit found one.
    pub(crate) fn error_of(&self, name: &str) -> Option<f64> {
        let own = self.std_error.iter().find(|(own, _)| own == name);
        own.map(|(_, error)| *error)
    }

    /// `fixed` and `std_error` of a table whose parameters are `known`.
    pub(super) fn from_table(table: &Table<'_>, known: &[String]) -> Result<Fit, Diagnostic> {
        let fixed = table.texts("fixed")?;
        if let Some(name) = fixed.iter().find(|name| !known.contains(*name)) {
            return Err(unknown_parameter(table.wrong("fixed", ""), name, known));
        }
        let mut std_error = Vec::new();
        if let Some(errors) = table.table("std_error")? {
            for name in known {
                if let Some(value) = errors.number(name, Bounds::NotNegative)? {
                    std_error.push((name.clone(), value));
                }
            }
            errors.finish()?;
        }
        Ok(Fit { fixed, std_error })
    }
}

pub(super) fn unknown_parameter(
    mut diagnostic: Diagnostic,
    name: &str,
    known: &[String],
) -> Diagnostic {
    let names = || known.iter().map(String::as_str);
    diagnostic.what = format!("`{name}` is not a parameter here");
    diagnostic = diagnostic
        .value(name)
        .note(format!("the parameters are {}", listed(names())));
    match nearest(name, names()) {
        Some(near) => diagnostic.remedy(format!("write \"{near}\"")),
        None => diagnostic.remedy("name one of them, or none"),
    }
}
