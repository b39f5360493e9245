//! Effects of a rig as a model file names them.

use super::Fit;
use crate::diagnostic::Diagnostic;
use crate::toml_reader::{Bounds, Table};

/// Something that the rig adds: an id of the catalogue with its parameters.
///
/// Any id with any numbers reads; whoever uses an effect checks that it knows it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Effect {
    /// Id in the catalogue, such as `coulomb_friction`.
    pub id: String,
    /// Its parameters in SI units, in the order of the file.
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
        let names: Vec<String> = table
            .remaining_keys()
            .into_iter()
            .filter(|key| key != "fixed" && key != "std_error")
            .collect();
        let value = |name: &String| -> Result<(String, f64), Diagnostic> {
            Ok((name.clone(), table.required_number(name, Bounds::Any)?))
        };
        let parameters = names.iter().map(value).collect::<Result<_, _>>()?;
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
}
