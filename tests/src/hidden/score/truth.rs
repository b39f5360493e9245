//! Reads a truth.json: of the generator [`rig`](crate::hidden::rig), or of the older rigs in
//! `data/hidden-effects`.

use super::answer::Named;
use crate::hidden::rig::case::LEAST_RATIO;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

/// Values by name.
pub(crate) type Numbers = BTreeMap<String, f64>;

/// What a rig really hides.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Truth {
    /// The kind of the rig: single, mismatched, pair, …
    pub kind: String,
    /// The ids of the hidden effects; empty where nothing is hidden, `unknown` for a misfit that is in no
    /// catalogue.
    pub(crate) effects: Vec<String>,
    /// For each effect the other ids that are right as well.
    pub(crate) accepts: BTreeMap<String, Vec<String>>,
    /// The sets of names that are exactly right; where there is none it is `effects`.
    pub(crate) sets: Vec<Vec<String>>,
    /// True parts that never count as wrong: an id, or `ID@HZ` for a line at that frequency.
    pub(crate) tolerate: Vec<String>,
    /// The rig's row in the confusion matrix.
    pub label: String,
    /// The parameters under the catalogue's names, only for effects in the catalogue's form.
    pub params: BTreeMap<String, Numbers>,
    /// The parameters of the base.
    pub base: Numbers,
    /// The true noise floor (N rms).
    pub(crate) floor_n: f64,
    /// The spectrum of the noise; empty where it was not written down.
    pub noise: String,
    /// Whether the best fit of the catalogue's form leaves more than [`CRUDE`].
    pub(crate) crude: bool,
}

/// Where the best fit of the catalogue's form leaves more than this multiple of the floor, the
/// catalogue does not explain the rig: `unexplained` with the right name is then the honest answer.
pub(crate) const CRUDE: f64 = 1.15;

/// The parameters of the older rigs: their name, the effect, the catalogue's name.
const OLDER: [(&str, &str, &str); 13] = [
    ("comp_k", "series_compliance", "stiffness"),
    ("cable_k", "cable_stiffness", "stiffness"),
    ("backlash", "backlash", "width"),
    ("lag_tau", "force_lag", "time_constant"),
    ("adh_f", "adhesion", "force"),
    ("adh_d", "adhesion", "neck_length"),
    ("mass", "tool_inertia", "mass"),
    ("coul_f", "coulomb_friction", "force"),
    ("bw_a", "hysteretic_damping", "force"),
    ("bw_d", "hysteretic_damping", "yield_displacement"),
    ("delay", "time_delay", "delay"),
    ("relax_c", "stress_relaxation", "fraction"),
    ("relax_nu", "stress_relaxation", "rate"),
];

/// The base parameters of the older rigs: their name, ours, and the laws that have them.
const OLDER_BASE: [(&str, &str, &[&str]); 6] = [
    (
        "K",
        "stiffness",
        &["kelvin_voigt", "hunt_crossley", "quasi_linear"],
    ),
    ("lam", "damping", &["kelvin_voigt", "hunt_crossley"]),
    ("n", "exponent", &["hunt_crossley", "quasi_linear"]),
    ("c", "relaxation_fraction_1", &["quasi_linear"]),
    ("nu", "relaxation_rate_1", &["quasi_linear"]),
    (
        "x0",
        "surface",
        &["kelvin_voigt", "hunt_crossley", "quasi_linear"],
    ),
];

impl Truth {
    /// Reads a truth.json; an error names the file.
    pub(crate) fn read(path: &Path) -> Result<Truth, String> {
        let text = std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
        Truth::parse(&text).map_err(|e| format!("{}: {e}", path.display()))
    }

    /// Reads the text of a truth.json.
    pub fn parse(text: &str) -> Result<Truth, String> {
        let json: Value = serde_json::from_str(text).map_err(|e| e.to_string())?;
        let effects = strings(&json["effects"]);
        let floor_n = json["floor_n"]
            .as_f64()
            .ok_or("floor_n: a number is expected")?;
        let ratio = |name: &str| json[name].as_f64();
        let truth = Truth {
            effects,
            floor_n,
            noise: json["noise"].as_str().unwrap_or_default().to_string(),
            crude: ratio("form_ratio").is_some_and(|ratio| ratio > CRUDE),
            ..Truth::default()
        };
        let mut truth = if json["forms"].is_object() {
            truth.read_ours(&json)
        } else if json["accept"].is_array() {
            truth.read_harder(&json)
        } else {
            truth.read_older(&json)
        };
        let something = !truth.effects.is_empty()
            && !["unknown", "poor", "scale"].contains(&truth.kind.as_str());
        // The base nearly hides the effect, whatever the generator was asked for.
        if something && ratio("gap_ratio").is_some_and(|ratio| ratio < LEAST_RATIO) {
            truth.kind = "weak".into();
        }
        Ok(truth)
    }

    fn read_ours(mut self, json: &Value) -> Truth {
        self.kind = json["kind"].as_str().unwrap_or_default().to_string();
        self.base = numbers(&json["base"]);
        self.tolerate = strings(&json["tolerate"]);
        let form = |id: &str| json["forms"][id].as_str().unwrap_or_default().to_string();
        for id in &self.effects {
            if form(id) == "catalogue" {
                self.params.insert(id.clone(), numbers(&json["params"][id]));
            }
            self.accepts
                .insert(id.clone(), strings(&json["accepts"][id]));
        }
        let forms: Vec<String> = self.effects.iter().map(|id| form(id)).collect();
        self.label = match forms.as_slice() {
            [] => "none".into(),
            [form] if self.effects[0] == "unknown" => form.clone(),
            [form] if form != "catalogue" => format!("{} ({form})", self.effects[0]),
            _ => self.effects.join("+"),
        };
        self
    }

    /// The rigs of others in `data/hard-rigs`.
    fn read_harder(mut self, json: &Value) -> Truth {
        let text = |name: &str| json[name].as_str().unwrap_or_default().to_string();
        self.kind = text("category");
        self.label = text("kind");
        self.noise = json["sensors"]["colour"]
            .as_str()
            .unwrap_or_default()
            .into();
        self.sets = json["accept"]
            .as_array()
            .into_iter()
            .flatten()
            .map(strings)
            .collect();
        self.tolerate = strings(&json["tolerate"]);
        for (name, value) in numbers(&json["params"]) {
            if let Some((id, name)) = name.split_once('.') {
                self.params
                    .entry(id.into())
                    .or_default()
                    .insert(name.into(), value);
            }
        }
        // The base of a rig of another size is written down as it was before it was scaled.
        if self.kind != "scale" {
            self.read_base(json);
        }
        self
    }

    fn read_older(mut self, json: &Value) -> Truth {
        self.kind = match self.effects.as_slice() {
            [] => "none",
            [id] if id == "unknown" => "unknown",
            [_] => "single",
            [_, _] => "pair",
            _ => "triple",
        }
        .into();
        self.label = if self.effects.is_empty() {
            "none".into()
        } else {
            self.effects.join("+")
        };
        for (theirs, id, name) in OLDER {
            if let Some(value) = json["params"][theirs].as_f64() {
                self.params
                    .entry(id.into())
                    .or_default()
                    .insert(name.into(), value);
            }
        }
        self.read_base(json);
        self
    }

    fn read_base(&mut self, json: &Value) {
        let law = json["law"].as_str().unwrap_or_default();
        for (theirs, name, laws) in OLDER_BASE {
            if let (Some(value), true) = (json["base"][theirs].as_f64(), laws.contains(&law)) {
                self.base.insert(name.into(), value);
            }
        }
    }

    /// The sets of names that are exactly right.
    pub(crate) fn right_sets(&self) -> Vec<&[String]> {
        match self.sets.is_empty() {
            true => vec![&self.effects],
            false => self.sets.iter().map(Vec::as_slice).collect(),
        }
    }

    /// Whether a name is a true part of the rig that is neither asked for nor wrong.
    pub(crate) fn tolerates(&self, named: &Named) -> bool {
        let asked = |set: &&[String]| set.iter().any(|id| self.same(id, &named.id));
        if self.right_sets().iter().any(asked) {
            return false;
        }
        let hz = named.params.get("frequency").map(|(hz, _)| *hz);
        self.tolerate.iter().any(|part| match part.split_once('@') {
            // Within the 2 % that the mains wander by at most; of a line without an error nothing is known.
            Some((id, at)) => {
                let near = |at: f64| hz.is_some_and(|hz| (hz / at - 1.0).abs() < 0.02);
                named.id == id && at.parse().is_ok_and(near)
            }
            None => named.id == *part,
        })
    }

    /// Whether the name `named` is right for the hidden effect `id`.
    pub(crate) fn same(&self, id: &str, named: &str) -> bool {
        id == named
            || self
                .accepts
                .get(id)
                .is_some_and(|also| also.iter().any(|a| a == named))
    }
}

pub(crate) fn strings(value: &Value) -> Vec<String> {
    let texts = value
        .as_array()
        .into_iter()
        .flatten()
        .filter_map(Value::as_str);
    texts.map(str::to_string).collect()
}

fn numbers(value: &Value) -> Numbers {
    let pairs = value.as_object().into_iter().flatten();
    pairs
        .filter_map(|(name, value)| Some((name.clone(), value.as_f64()?)))
        .collect()
}
