//! Writes a case as files in the format of `data/hidden-effects`.

use super::case::Case;
use super::draw::accepted;
use super::kind::Kind;
use super::material::{Law, REFERENCE_M};
use serde_json::{Map, Value, json};
use std::fmt::Write as _;
use std::path::Path;

/// The size of the whole rig in its files: a metre, a newton and a second of the case are this many of theirs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Units {
    /// What a metre of the case becomes.
    pub length: f64,
    /// What a newton of the case becomes.
    pub force: f64,
    /// What a second of the case becomes.
    pub time: f64,
    /// Whether the rig turns: lengths are radians and forces newton metres.
    pub turns: bool,
}

impl Units {
    pub(crate) const SI: Units = Units {
        length: 1.0,
        force: 1.0,
        time: 1.0,
        turns: false,
    };

    /// A rig that turns, on which so many metres are a radian and 20 N a newton metre.
    pub(crate) fn turning(radian_m: f64) -> Units {
        Units {
            length: 1.0 / radian_m,
            force: 0.05,
            time: 1.0,
            turns: true,
        }
    }

    /// The factor on a parameter of the base.
    fn of(self, parameter: &str) -> f64 {
        match parameter {
            "stiffness" | "second_stiffness" => self.force / self.length,
            "damping" => self.force * self.time / self.length,
            "relaxation_rate_1" => 1.0 / self.time,
            "surface" => self.length,
            _ => 1.0,
        }
    }

    fn csv(self, rows: &[[f64; 3]], every: usize) -> String {
        let mut text = String::with_capacity(26 * rows.len() / every);
        text.push_str(if self.turns {
            "t_s,x_rad,f_nm\n"
        } else {
            "t_s,x_m,f_n\n"
        });
        for [t, x, f] in rows.iter().step_by(every) {
            // Writing to a String cannot fail.
            let _ = if self == Units::SI {
                writeln!(text, "{t:.3},{x:.6},{f:.3}")
            } else {
                writeln!(
                    text,
                    "{:.9e},{:.9e},{:.9e}",
                    t * self.time,
                    x * self.length,
                    f * self.force
                )
            };
        }
        text
    }
}

impl Case {
    /// The text of base.toml: the model that the simulation knows.
    pub fn base_toml(&self) -> String {
        let mut text = String::new();
        if self.units.turns {
            text += "kind = \"rotary\"\n\n";
        }
        text += &format!("[environment]\nlaw = \"{}\"\n", self.material.law.name());
        let mut mode = (0.0, 0.0);
        for (name, value) in self.material.law.parameters().iter().zip(&self.start) {
            let value = value * self.units.of(name);
            match *name {
                "relaxation_fraction_1" => mode.0 = value,
                "relaxation_rate_1" => mode.1 = value,
                "surface" => {}
                name => text += &format!("{name} = {}\n", digits(value)),
            }
        }
        if self.material.law == Law::QuasiLinear {
            let (fraction, rate) = (digits(mode.0), digits(mode.1));
            text += &format!("relaxation = [{{ fraction = {fraction}, rate = {rate} }}]\n");
        }
        if self.units.length != 1.0 {
            text += &format!("reference_depth = {:e}\n", REFERENCE_M * self.units.length);
        }
        text += "surface = 0.0\n";
        if let Some((_, stiffness)) = self.given {
            let stiffness = digits(stiffness * self.units.of("stiffness"));
            text += &format!("\n[[effect]]\nid = \"cable_stiffness\"\nstiffness = {stiffness}\n");
        }
        text
    }

    /// The text of measured.csv: the log of the rig.
    pub fn csv(&self) -> String {
        self.units.csv(&self.rows, self.every)
    }

    /// The log of the same rig under another set point (m), a function of time (s); see [`Case::again`].
    pub(crate) fn further_csv(&self, seconds: f64, set_m: impl Fn(f64) -> f64) -> String {
        let again = self.again(seconds, set_m);
        self.units.csv(&again.rows, self.every)
    }

    /// The content of truth.json: what is hidden, with the parameters of the catalogue's forms under the
    /// catalogue's names and in its units.
    pub fn truth(&self) -> Value {
        let object = |pairs: &[(&str, f64)]| -> Value {
            let pairs = pairs
                .iter()
                .map(|(name, value)| ((*name).to_string(), json!(value)));
            Value::Object(pairs.collect::<Map<_, _>>())
        };
        let mut params = Map::new();
        let mut forms = Map::new();
        let mut accepts = Map::new();
        let mut effects: Vec<&str> = Vec::new();
        for hidden in &self.hidden {
            effects.push(hidden.id);
            // The parameters of a rig of another size are compared with nothing.
            if self.units == Units::SI {
                params.insert(hidden.id.into(), object(&hidden.params));
            }
            forms.insert(hidden.id.into(), json!(hidden.form));
            let also = self.also.iter().filter(|(id, _)| *id == hidden.id);
            let mut right: Vec<&str> = also.map(|(_, also)| *also).collect();
            right.extend(accepted(hidden.id, hidden.form));
            accepts.insert(hidden.id.into(), json!(right));
        }
        if let Some((stranger, strength)) = self.stranger {
            effects.push("unknown");
            params.insert("unknown".into(), json!({ "strength": strength }));
            forms.insert("unknown".into(), json!(stranger.name()));
        }
        let names = self.material.law.parameters().iter().copied();
        let base = names.zip(self.material.numbers());
        let base: Vec<(&str, f64)> = base
            .map(|(name, v)| (name, v * self.units.of(name)))
            .collect();
        json!({
            "kind": self.kind.name(),
            "effects": effects,
            "forms": forms,
            "accepts": accepts,
            "params": params,
            "law": self.material.law.name(),
            "base": object(&base),
            "floor_n": self.floor_n * self.units.force,
            "base_rmse_n": self.base_rmse_n * self.units.force,
            "gap_ratio": self.gap_ratio(),
            "form_ratio": self.form_rmse_n.map(|rmse_n| rmse_n / self.floor_n),
            "profile": self.profile.name(),
            "noise": self.sensor.noise.name(),
            "seconds": self.seconds() * self.units.time,
            // With these `of_truth` draws the same rig again.
            "seed": self.seed,
            "index": self.index,
            "brief": self.every > 1,
            "units": [self.units.length, self.units.force, self.units.time],
        })
    }

    /// Draws the case of a truth.json again; `None` if it was not drawn by this generator.
    pub(crate) fn of_truth(truth: &Value) -> Option<Case> {
        let kind = Kind::ALL.iter().find(|(_, name)| truth["kind"] == *name)?.0;
        let (seed, index) = (truth["seed"].as_u64()?, truth["index"].as_u64()?);
        let unit = |at: usize| truth["units"][at].as_f64();
        let case = match truth["brief"].as_bool()? {
            true => Case::brief(kind, seed, index),
            false => Case::generate(kind, seed, index),
        };
        let units = Units {
            length: unit(0)?,
            force: unit(1)?,
            time: unit(2)?,
            turns: case.units.turns,
        };
        Some(Case { units, ..case })
    }

    /// Writes base.toml, measured.csv and truth.json into a folder, and richer.csv where there is one.
    pub fn save(&self, dir: &Path) -> std::io::Result<()> {
        std::fs::create_dir_all(dir)?;
        std::fs::write(dir.join("base.toml"), self.base_toml())?;
        std::fs::write(dir.join("measured.csv"), self.csv())?;
        if let Some(rows) = &self.richer {
            std::fs::write(dir.join("richer.csv"), self.units.csv(rows, self.every))?;
        }
        std::fs::write(dir.join("truth.json"), format!("{:#}\n", self.truth()))
    }
}

/// A number with five digits, as a person would write it.
fn digits(value: f64) -> String {
    let decimals = (4.0 - value.abs().log10().floor()).clamp(0.0, 300.0) as usize;
    if (1e-3..1e6).contains(&value.abs()) {
        format!("{value:.decimals$}")
    } else {
        format!("{value:.4e}")
    }
}
