//! A case as files, in the format of `data/hidden-effects`.

use super::case::Case;
use super::draw::accepted;
use super::material::Law;
use serde_json::{Map, Value, json};
use std::fmt::Write as _;
use std::path::Path;

impl Case {
    /// What the simulation knows.
    pub(crate) fn base_toml(&self) -> String {
        let mut text = format!("[environment]\nlaw = \"{}\"\n", self.material.law.name());
        let mut mode = (0.0, 0.0);
        for (name, value) in self.material.law.parameters().iter().zip(&self.start) {
            match *name {
                "relaxation_fraction_1" => mode.0 = *value,
                "relaxation_rate_1" => mode.1 = *value,
                "surface" => {}
                name if value.abs() >= 100.0 => text += &format!("{name} = {value:.1}\n"),
                name => text += &format!("{name} = {value:.4}\n"),
            }
        }
        if self.material.law == Law::QuasiLinear {
            text += &format!(
                "relaxation = [{{ fraction = {:.3}, rate = {:.4} }}]\n",
                mode.0, mode.1
            );
        }
        text + "surface = 0.0\n"
    }

    /// What the rig recorded.
    pub(crate) fn csv(&self) -> String {
        csv(&self.rows)
    }

    /// What was really there: parameters of the catalogue's forms in the catalogue's names and units.
    pub(crate) fn truth(&self) -> Value {
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
            params.insert(hidden.id.into(), object(&hidden.params));
            forms.insert(hidden.id.into(), json!(hidden.form));
            accepts.insert(hidden.id.into(), json!(accepted(hidden.id, hidden.form)));
        }
        if let Some((stranger, strength)) = self.stranger {
            effects.push("unknown");
            params.insert("unknown".into(), json!({ "strength": strength }));
            forms.insert("unknown".into(), json!(stranger.name()));
        }
        let names = self.material.law.parameters().iter().copied();
        let base: Vec<(&str, f64)> = names.zip(self.material.numbers()).collect();
        json!({
            "kind": self.kind.name(),
            "effects": effects,
            "forms": forms,
            "accepts": accepts,
            "params": params,
            "law": self.material.law.name(),
            "base": object(&base),
            "floor_n": self.floor_n,
            "base_rmse_n": self.base_rmse_n,
            "gap_ratio": self.gap_ratio(),
            "form_ratio": self.form_rmse_n.map(|rmse_n| rmse_n / self.floor_n),
            "profile": self.profile.name(),
            "noise": self.noise.name(),
            "seconds": self.seconds(),
            "seed": self.seed,
        })
    }

    /// Writes the three files.
    pub(crate) fn save(&self, dir: &Path) -> std::io::Result<()> {
        std::fs::create_dir_all(dir)?;
        std::fs::write(dir.join("base.toml"), self.base_toml())?;
        std::fs::write(dir.join("measured.csv"), self.csv())?;
        if let Some(rows) = &self.richer {
            std::fs::write(dir.join("richer.csv"), csv(rows))?;
        }
        std::fs::write(dir.join("truth.json"), format!("{:#}\n", self.truth()))
    }
}

fn csv(rows: &[[f64; 3]]) -> String {
    let mut text = String::with_capacity(26 * rows.len());
    text.push_str("t_s,x_m,f_n\n");
    for [t, x, f] in rows {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{t:.3},{x:.6},{f:.3}");
    }
    text
}
