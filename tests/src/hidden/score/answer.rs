//! What `palpate gap` answered, as far as it is scored.

use super::truth::strings;
use palpate::gap::Finding;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

/// Values with their standard errors, by name.
pub(crate) type Estimates = BTreeMap<String, (f64, f64)>;

/// How sure the answer is of a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Grade {
    /// The log is explained to the noise, and no rival is near.
    Certain,
    /// The name stands, and something else remains.
    Strong,
    /// It has rivals.
    Open,
}

/// What speaks for a name.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Support {
    /// The share of what can be taken off that the effect takes off.
    share: f64,
    /// The share of the blocks in which it does.
    blocks: f64,
    /// The best rival, and its share in the effect's place.
    next: String,
    next_share: f64,
}

impl std::fmt::Display for Support {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Support {
            share,
            blocks,
            next,
            next_share,
        } = self;
        write!(
            f,
            "share {share:.2} in {blocks:.2} of the blocks, next {next} {next_share:.2}"
        )
    }
}

/// One effect that was named.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Named {
    /// The effect's id.
    pub(crate) id: String,
    /// The parameters that have a standard error.
    pub(crate) params: Estimates,
    /// How many parameters have no standard error.
    pub(crate) without_error: usize,
    /// Ids that describe the data as well.
    pub(crate) alternatives: Vec<String>,
    /// The grade of the name; `None` where the answer gives no grades.
    pub(crate) grade: Option<Grade>,
    /// What speaks for the name, where the answer says it.
    pub(crate) support: Option<Support>,
}

/// A number of the base that is said to have changed.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Changed {
    /// Its name, with the effect's id before it.
    pub(crate) name: String,
    /// How much larger it is than it was.
    pub(crate) by: f64,
}

/// What the workflow answered.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Answer {
    /// The name of the verdict.
    pub(crate) verdict: String,
    /// The effects that are missing in the model.
    pub(crate) effects: Vec<Named>,
    /// The RMSE on the held-out part of the base alone, refitted (N).
    pub(crate) rmse_before_n: f64,
    /// The RMSE on the held-out part with the named effects (N).
    pub(crate) rmse_after_n: f64,
    /// The noise floor that the workflow found (N).
    pub(crate) floor_n: f64,
    /// What the best model of all leaves beyond the floor (N), and the share of the disagreement that is
    /// explained, where the answer says so.
    pub(crate) remainder_n: Option<f64>,
    pub(crate) explained_share: Option<f64>,
    /// The ids of the best set of all that were fitted.
    pub(crate) best_set: Vec<String>,
    /// The base's parameters after the fit.
    pub base: Estimates,
    /// The numbers of the base that are said to have changed since it was identified, with what they were and are.
    pub(crate) changed: Vec<Changed>,
    /// Wall-clock time of the process (s).
    pub(crate) seconds: f64,
    /// Processor time of all its threads (s); NaN where the system does not say it.
    pub(crate) cpu_s: f64,
}

impl Answer {
    /// Reads a gap.json.
    pub(crate) fn read(path: &Path) -> Result<Answer, String> {
        let text = std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
        Answer::parse(&text).map_err(|e| format!("{}: {e}", path.display()))
    }

    /// Reads the text of a gap.json.
    pub fn parse(text: &str) -> Result<Answer, String> {
        let json: Value = serde_json::from_str(text).map_err(|e| e.to_string())?;
        let verdict = json["verdict"]
            .as_str()
            .ok_or("verdict: a text is expected")?
            .to_string();
        let known = [
            "no_missing_effect",
            "missing_effects",
            "ambiguous",
            "partly_explained",
            "unexplained",
        ];
        if !known.contains(&verdict.as_str()) {
            return Err(format!(
                "verdict \"{verdict}\": one of {known:?} is expected"
            ));
        }
        let named = |effect: &Value| Named {
            id: effect["id"].as_str().unwrap_or_default().to_string(),
            params: estimates(&effect["params"]),
            without_error: effect["params"].as_object().map_or(0, serde_json::Map::len)
                - estimates(&effect["params"]).len(),
            alternatives: strings(&effect["alternatives"]),
            grade: grade(&effect["grade"]),
            support: support(&effect["support"]),
        };
        let rmse_after_n = json["rmse_n"]["after"]
            .as_f64()
            .ok_or("rmse_n.after: a number is expected")?;
        Ok(Answer {
            verdict,
            effects: json["effects"]
                .as_array()
                .into_iter()
                .flatten()
                .map(named)
                .collect(),
            rmse_before_n: json["rmse_n"]["before"].as_f64().unwrap_or(f64::NAN),
            rmse_after_n,
            floor_n: json["noise_floor_n"].as_f64().unwrap_or(f64::NAN),
            remainder_n: json["remainder_n"].as_f64(),
            explained_share: json["explained_share"].as_f64(),
            best_set: strings(&json["candidates"][0]["effects"]),
            base: estimates(&json["base"]["after"]),
            changed: json["changed"]
                .as_array()
                .into_iter()
                .flatten()
                .filter_map(change)
                .collect(),
            seconds: json["seconds"].as_f64().unwrap_or(f64::NAN),
            cpu_s: f64::NAN,
        })
    }

    /// Takes what is scored from the library's finding, as the command writes it to gap.json.
    pub(crate) fn of(finding: &Finding, seconds: f64) -> Result<Answer, String> {
        Answer::parse(&palpate::cli::gap::json(finding, seconds).to_string())
    }

    /// The answer without the names that `drop` holds for.
    pub(crate) fn without(&self, drop: impl Fn(&Named) -> bool) -> Answer {
        let mut answer = self.clone();
        answer.effects.retain(|named| !drop(named));
        answer
    }

    /// Whether the answer stands for a name: by its grade, and without grades by the verdict
    /// `missing_effects`.
    pub(crate) fn stands_for(&self, named: &Named) -> bool {
        match named.grade {
            Some(grade) => grade != Grade::Open,
            None => self.verdict == "missing_effects",
        }
    }

    /// How many different ids the answer names or gives as alternatives: what an ambiguous answer leaves
    /// open.
    pub fn group(&self) -> usize {
        let named = self.effects.iter().map(|named| named.id.as_str());
        let also = self.effects.iter().flat_map(|named| &named.alternatives);
        let all: std::collections::BTreeSet<&str> = named.chain(also.map(String::as_str)).collect();
        all.len()
    }

    /// The named ids in their order, each once: a spectrum of several modes is one name.
    pub(crate) fn ids(&self) -> Vec<&str> {
        let mut ids: Vec<&str> = Vec::new();
        for effect in &self.effects {
            if !ids.contains(&effect.id.as_str()) {
                ids.push(&effect.id);
            }
        }
        ids
    }

    /// The answer's column in the confusion matrix: the names, with `?` for ambiguous, `~` for partly
    /// explained and `!` for unexplained; in brackets the names that a partly explained log leaves open.
    pub(crate) fn label(&self) -> String {
        let standing = self.without(|named| !self.stands_for(named));
        let partly = self.verdict == "partly_explained";
        let shown = |id: &&str| match partly && !standing.ids().contains(id) {
            true => format!("({id})"),
            false => (*id).to_string(),
        };
        let ids: Vec<String> = self.ids().iter().map(shown).collect();
        let ids = ids.join("+");
        match self.verdict.as_str() {
            "no_missing_effect" => "null".into(),
            "ambiguous" => format!("{ids}?"),
            "partly_explained" => format!("{ids}~"),
            "unexplained" => format!("{ids}!"),
            _ => ids,
        }
    }
}

fn change(value: &Value) -> Option<Changed> {
    Some(Changed {
        name: value["name"].as_str()?.to_string(),
        by: value["now"]["value"].as_f64()? - value["was"]["value"].as_f64()?,
    })
}

fn grade(value: &Value) -> Option<Grade> {
    match value.as_str()? {
        "certain" => Some(Grade::Certain),
        "strong" => Some(Grade::Strong),
        _ => Some(Grade::Open),
    }
}

fn support(value: &Value) -> Option<Support> {
    let number = |name: &str| value[name].as_f64();
    Some(Support {
        share: number("share")?,
        blocks: number("blocks").unwrap_or(f64::NAN),
        next: value["next"].as_str().unwrap_or("none").to_string(),
        next_share: number("next_share").unwrap_or(0.0),
    })
}

fn estimates(value: &Value) -> Estimates {
    let pairs = value.as_object().into_iter().flatten();
    let one = |(name, value): (&String, &Value)| {
        Some((
            name.clone(),
            (value["value"].as_f64()?, value["std_error"].as_f64()?),
        ))
    };
    pairs.filter_map(one).collect()
}
