//! Models back to TOML.

use std::fmt;

use toml_edit::{Array, ArrayOfTables, DocumentMut, InlineTable, Item, Table, Value, value};

use super::{Effect, Environment, Fit, Model, Remainder};
use crate::phase::PHASES;
use crate::plant::Sensors;

impl Model {
    /// The model as TOML; reading it back gives the same model, apart from path and lines.
    pub fn to_toml(&self) -> String {
        let mut document = DocumentMut::new();
        if let Some(kind) = self.kind {
            document["kind"] = value(kind.name());
        }
        document["environment"] = Item::Table(environment(&self.environment));
        if !self.effects.is_empty() {
            let mut effects = ArrayOfTables::new();
            self.effects.iter().for_each(|e| effects.push(effect(e)));
            document["effect"] = Item::ArrayOfTables(effects);
        }
        if self.sensors != Sensors::default() {
            document["sensors"] = Item::Table(sensors(&self.sensors));
        }
        if let Some(own) = &self.remainder {
            document["remainder"] = Item::Table(remainder(own));
        }
        document.to_string()
    }
}

impl fmt::Display for Model {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.to_toml())
    }
}

fn environment(environment: &Environment) -> Table {
    let mut table = Table::new();
    table["law"] = value(environment.law.name());
    for parameter in environment.parameters() {
        if !parameter.name.starts_with("relaxation_") {
            table[&parameter.name] = value(parameter.value);
        }
    }
    if environment.has("stiffening_rate") {
        table["elastic"] = value("exponential");
    }
    if environment.law.info().most_modes > 0 {
        let modes = environment.modes().map(|(fraction, rate)| {
            let fields = [("fraction", fraction), ("rate", rate)];
            Value::InlineTable(fields.into_iter().collect::<InlineTable>())
        });
        table["relaxation"] = value(modes.collect::<Array>());
    }
    table["surface"] = value(environment.surface_m);
    table["reference_depth"] = value(environment.reference_depth_m);
    if let Some(recovery) = environment.recovery {
        table["recovery"] = value(recovery.name());
    }
    push_fit(&mut table, &environment.fit);
    table
}

fn effect(effect: &Effect) -> Table {
    let mut table = Table::new();
    table["id"] = value(effect.id.as_str());
    for (name, number) in &effect.parameters {
        table[name] = value(*number);
    }
    push_fit(&mut table, &effect.fit);
    table
}

fn sensors(sensors: &Sensors) -> Table {
    let mut table = Table::new();
    for (name, number) in [
        ("force_noise", sensors.force_noise_n),
        ("force_step", sensors.force_step_n),
        ("force_min", sensors.force_min_n),
        ("position_step", sensors.position_step_m),
        ("rate", sensors.rate_hz),
    ] {
        table[name] = value(number);
    }
    table
}

fn remainder(remainder: &Remainder) -> Table {
    let mut table = Table::new();
    table["rms"] = value(remainder.rms_n);
    let by_phase = PHASES.into_iter().zip(remainder.by_phase_n);
    let by_phase: InlineTable = by_phase
        .filter_map(|(name, rms_n)| Some((name, rms_n?)))
        .collect();
    if !by_phase.is_empty() {
        table["by_phase"] = value(by_phase);
    }
    if let Some(noise_n) = remainder.noise_n {
        table["noise"] = value(noise_n);
    }
    table["correlation_time"] = value(remainder.correlation_s);
    if let Some(corner_hz) = remainder.bandwidth_hz {
        table["bandwidth"] = value(corner_hz);
    }
    table
}

fn push_fit(table: &mut Table, fit: &Fit) {
    if !fit.fixed.is_empty() {
        table["fixed"] = value(fit.fixed.iter().map(String::as_str).collect::<Array>());
    }
    if !fit.std_error.is_empty() {
        let errors = fit
            .std_error
            .iter()
            .map(|(name, number)| (name.as_str(), *number));
        table["std_error"] = value(errors.collect::<InlineTable>());
    }
}
