//! Models: what a rig is believed to be, as TOML.
//!
//! The environment's law with its parameters, the effects that the rig adds, and sensors for a
//! simulation. Values are starting points of a fit unless they are `fixed`.

mod effect;
mod environment;
mod fit;
mod remainder;
mod rig;
mod title;
mod write;

pub use effect::Effect;
pub use environment::{Environment, Parameter};
pub use fit::Fit;
pub use remainder::Remainder;
pub use title::law_title;

use std::path::{Path, PathBuf};

use crate::diagnostic::Diagnostic;
use crate::kind::Kind;
use crate::plant::Sensors;
use crate::toml_reader::{Bounds, Table, TomlFile};

/// A model file.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// Where it came from.
    pub path: PathBuf,
    /// Whether the machine turns, where the file says so.
    pub kind: Option<Kind>,
    /// What is touched.
    pub environment: Environment,
    /// What the rig adds, in the order of the file.
    pub effects: Vec<Effect>,
    /// The sensors of a simulation.
    pub sensors: Sensors,
    /// What it left of the log that it was identified on, where that was more than noise.
    pub remainder: Option<Remainder>,
}

impl Model {
    /// Reads a model file.
    ///
    /// # Errors
    /// A [`Diagnostic`] with line, key, value and remedy.
    pub fn read(path: &Path) -> Result<Model, Diagnostic> {
        Model::from_toml(&TomlFile::read(path)?, path)
    }

    /// The model of a machine that its logs say the kind of.
    #[must_use]
    pub fn of_kind(self, kind: Kind) -> Model {
        let is_said = self.kind.is_some() || kind == Kind::Rotary;
        Model {
            kind: is_said.then_some(kind),
            ..self
        }
    }

    /// A model from a parsed file; `path` is kept.
    ///
    /// # Errors
    /// As [`Model::read`].
    pub fn from_toml(file: &TomlFile, path: &Path) -> Result<Model, Diagnostic> {
        let root = file.root();
        let kind = read_kind(&root)?;
        let environment = root.table("environment")?;
        let effects = root.tables("effect")?;
        let sensors = root.table("sensors")?;
        let remainder = root.table("remainder")?;
        root.finish()?;
        let Some(environment) = environment else {
            return Err(root
                .wrong_table("the model has no [environment]")
                .at_key("environment")
                .remedy("write [environment] with a law, even if it is law = \"free\""));
        };
        Ok(Model {
            path: path.to_path_buf(),
            kind,
            environment: Environment::from_table(&environment)?,
            effects: effects
                .iter()
                .map(Effect::from_table)
                .collect::<Result<_, _>>()?,
            sensors: sensors.map_or(Ok(Sensors::default()), |table| read_sensors(&table))?,
            remainder: remainder
                .map(|table| Remainder::from_table(&table))
                .transpose()?,
        })
    }
}

/// `kind = "rotary"`, if the file says so.
fn read_kind(root: &Table<'_>) -> Result<Option<Kind>, Diagnostic> {
    let Some(name) = root.text("kind")? else {
        return Ok(None);
    };
    match Kind::from_name(name) {
        Some(kind) => Ok(Some(kind)),
        None => Err(root
            .wrong("kind", "neither a linear machine nor a rotary one")
            .remedy("write kind = \"linear\" (m, N) or kind = \"rotary\" (rad, N m)")),
    }
}

fn read_sensors(table: &Table<'_>) -> Result<Sensors, Diagnostic> {
    table.understand(&[
        "force_noise",
        "force_step",
        "force_min",
        "position_step",
        "rate",
    ]);
    let usual = Sensors::default();
    let optional = |key: &str, bounds, usual: f64| -> Result<f64, Diagnostic> {
        Ok(table.number(key, bounds)?.unwrap_or(usual))
    };
    let force_step_n = optional("force_step", Bounds::NotNegative, usual.force_step_n)?;
    // A quarter of the range below zero, as in the default.
    let force_min_n = -1024.0 * force_step_n;
    let sensors = Sensors {
        force_noise_n: optional("force_noise", Bounds::NotNegative, usual.force_noise_n)?,
        force_step_n,
        force_min_n: optional("force_min", Bounds::Any, force_min_n)?,
        position_step_m: optional("position_step", Bounds::NotNegative, usual.position_step_m)?,
        // A simulation holds every sample in memory: 1 MHz for ten seconds are 0.6 GB.
        rate_hz: optional("rate", Bounds::Within(1.0, 1e6), usual.rate_hz)?,
    };
    table.finish()?;
    Ok(sensors)
}

#[cfg(test)]
mod tests;
