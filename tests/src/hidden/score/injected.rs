//! Effects injected into measured records, and what `palpate gap` makes of them.
//!
//! The owner's model is what `gap` finds on the clean record from a plain base; what that leaves is the
//! remainder. A known effect then changes the force by a multiple of the remainder (rms), and `gap` is asked
//! again, with the owner's model. What a refit of that model follows does not count: it has to stay
//! [`WORSE`] times as bad as on the clean record.

use super::answer::{Answer, Changed, Grade, Named};
use super::records::{self, Record};
use crate::hidden::rig::inject::{self, EFFECTS, Injection, inject};
use palpate::gap::{Options, gap};
use palpate::log::Log;
use palpate::model::Model;
use std::panic::AssertUnwindSafe;
use std::path::{Path, PathBuf};

/// Below this multiple of the error on the clean record the owner's model explains the effect itself.
pub const WORSE: f64 = 1.4;

/// A size is right within this share.
const CLOSE: f64 = 0.2;

/// What is asked of the records.
#[derive(Clone, Debug)]
pub struct Question {
    /// The sizes of the change in force, in remainders.
    pub sizes: Vec<f64>,
    /// Only records and effects whose names contain one of these; all where it is empty.
    pub only: Vec<String>,
    /// Every how many samples of the records are kept.
    pub every: usize,
    /// The folder that gets every record with its effect and the model that is asked, to look at by hand.
    pub keep: Option<PathBuf>,
}

/// What became of a record.
#[derive(Clone, Debug)]
pub struct Examined {
    /// The record's name.
    pub record: String,
    /// The clean record with the plain base and then with the owner's model, or why there is no such model.
    pub clean: Result<Clean, String>,
    /// The effects that were put into it.
    pub injected: Vec<Injected>,
}

/// A clean record.
#[derive(Clone, Debug)]
pub struct Clean {
    /// The answer from the plain base.
    pub found: Answer,
    /// The answer from the model that was found.
    pub again: Answer,
    /// What the owner's model leaves beyond the floor (N rms).
    pub remainder_n: f64,
}

/// An effect in a record.
#[derive(Clone, Debug)]
pub struct Injected {
    /// The effect's id.
    pub id: &'static str,
    /// Its size in remainders.
    pub size: f64,
    /// What was answered, or why it does not count.
    pub outcome: Result<Outcome, String>,
}

/// The answer to a record with an effect.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The error of the owner's model over that on the clean record.
    pub worse: f64,
    /// The error with what was named, over the same.
    pub left: f64,
    /// The name of the effect, or of a member of its family, stands; of one that the owner's model has, its size is
    /// said to have changed.
    pub named: bool,
    /// It is named by that alone.
    pub by_change: bool,
    /// It stands, or is among what is left open.
    pub open: bool,
    /// Another name stands.
    pub companion: bool,
    /// The numbers that are said to have changed, and are not the effect's size.
    pub also_changed: Vec<String>,
    /// The found size over the true one, where the effect is named.
    pub ratio: Option<f64>,
    /// The effect is in the best set of all that were fitted, whatever was then said of it.
    pub in_best_set: bool,
    /// The answer in short, or how the workflow failed.
    pub label: String,
    /// The parameter that was put in, and what speaks for the name where the answer says it.
    pub detail: String,
}

impl Outcome {
    /// Whether the effect is named and its size is right within 20 %.
    pub fn close(&self) -> bool {
        self.ratio.is_some_and(|ratio| (ratio - 1.0).abs() < CLOSE)
    }
}

/// The names that are right for an effect: it and its nested family; a lag and a delay are one in slow motion. The
/// friction that is put in sticks before it slides, as Bouc and Wen's.
fn family(id: &str) -> &[&str] {
    match id {
        "coulomb_friction" => &["coulomb_friction", "stribeck_friction", "bouc_wen"],
        "time_delay" => &["time_delay", "force_lag"],
        "force_lag" => &["force_lag", "time_delay"],
        other => {
            let at = EFFECTS.iter().position(|(known, _)| *known == other);
            at.map_or(&[], |at| std::slice::from_ref(&EFFECTS[at].0))
        }
    }
}

/// Examines the records that are found below the folders, in turn; `say` hears how far it is.
pub fn examine(question: &Question, roots: &[PathBuf], say: &dyn Fn(&str)) -> Vec<Examined> {
    let holds = |name: &str| {
        question
            .only
            .iter()
            .any(|part| name.contains(part.as_str()))
    };
    // Words of `--only` that name a record choose records, the others effects.
    let some_record = records::ALL.iter().any(|record| holds(&record.name()));
    let some_effect = EFFECTS.iter().any(|(id, _)| holds(id));
    let mut all = Vec::new();
    for record in records::ALL {
        if record.found(roots).is_none() {
            continue;
        }
        if some_record && !holds(&record.name()) {
            continue;
        }
        say(&record.name());
        let ids = EFFECTS.iter().filter(|(id, _)| !some_effect || holds(id));
        all.push(one_record(&record, roots, question, ids, say));
    }
    all
}

fn one_record<'a>(
    record: &Record,
    roots: &[PathBuf],
    question: &Question,
    ids: impl Iterator<Item = &'a (&'static str, bool)>,
    say: &dyn Fn(&str),
) -> Examined {
    let options = Options {
        bandwidth_hz: record.bandwidth_hz,
        ..Options::default()
    };
    let mut examined = Examined {
        record: record.name(),
        clean: Err(String::new()),
        injected: Vec::new(),
    };
    let read = record.read(roots).and_then(|(log, base)| {
        let log = thinned(&log, question.every);
        let (clean, owner) = owners_model(&log, &base, &options)?;
        Ok((log, clean, owner))
    });
    let (log, clean, owner) = match read {
        Ok(read) => read,
        Err(error) => {
            examined.clean = Err(error);
            return examined;
        }
    };
    for (id, needs_contact) in ids {
        for size in &question.sizes {
            say(&format!("{} {id} {size} ×", record.name()));
            let free = owner.environment.is_free();
            let outcome = match *needs_contact && free {
                true => Err("nothing is touched".into()),
                false => {
                    let keep = question.keep.as_ref();
                    let keep =
                        keep.map(|keep| keep.join(record.name()).join(format!("{id}-{size}")));
                    altered(id, *size, &log, &clean, &owner, &options, keep.as_deref())
                }
            };
            examined.injected.push(Injected {
                id,
                size: *size,
                outcome,
            });
        }
    }
    examined.clean = Ok(clean);
    examined
}

fn thinned(log: &Log, every: usize) -> Log {
    let thin = |column: &[f64]| column.iter().copied().step_by(every.max(1)).collect();
    let thin = Log::from_channels(thin(&log.time_s), thin(&log.position_m), thin(&log.force_n));
    like(log, thin)
}

/// Another log of the same machine: one that turns has other effects in its catalogue.
fn like(log: &Log, other: Log) -> Log {
    Log {
        kind: log.kind,
        ..other
    }
}

/// The model that `gap` finds on the clean record, read back from its text, and what it is asked again.
fn owners_model(log: &Log, base: &Model, options: &Options) -> Result<(Clean, Model), String> {
    let (found, text) = asked(log, base, options)?;
    let owner =
        records::parsed(&text).map_err(|e| format!("its model.toml cannot be read back: {e}"))?;
    let (again, _) = asked(log, &owner, options)?;
    let beyond = again.rmse_before_n.powi(2) - again.floor_n.powi(2);
    let remainder_n = found.remainder_n.unwrap_or(beyond.max(0.0).sqrt());
    // Where the model explains everything, the noise is what an effect is measured by.
    let remainder_n = remainder_n.max(again.floor_n);
    Ok((
        Clean {
            found,
            again,
            remainder_n,
        },
        owner,
    ))
}

/// The answer of the library, and the text of the model that it would write.
fn asked(log: &Log, model: &Model, options: &Options) -> Result<(Answer, String), String> {
    let log = log.uniform().map_err(|e| e.to_string())?;
    let run = || gap(model, &[log], options);
    let found = std::panic::catch_unwind(AssertUnwindSafe(run));
    let found = found
        .map_err(|_| "gap panicked")?
        .map_err(|e| e.to_string())?;
    Ok((Answer::of(&found, f64::NAN)?, found.model.to_toml()))
}

/// Puts an effect in and asks.
fn altered(
    id: &str,
    size: f64,
    log: &Log,
    clean: &Clean,
    owner: &Model,
    options: &Options,
    keep: Option<&Path>,
) -> Result<Outcome, String> {
    let record = inject::Record {
        t: log.time_s.clone(),
        x: log.position_m.clone(),
        f: log.force_n.clone(),
    };
    let injection = inject(id, &record, size * clean.remainder_n)?;
    let Injection { record, .. } = &injection;
    let changed = Log::from_channels(record.t.clone(), record.x.clone(), record.f.clone());
    let log = like(log, changed);
    let nothing = Options {
        catalogue: Vec::new(),
        ..options.clone()
    };
    let over = |rmse_n: f64| rmse_n / clean.again.rmse_before_n;
    let (refitted, _) = asked(&log, owner, &nothing)?;
    let worse = over(refitted.rmse_before_n);
    if worse < WORSE {
        return Err("a refit of the owner's model follows it".into());
    }
    if let Some(keep) = keep {
        kept(keep, &log, owner).map_err(|e| format!("{}: {e}", keep.display()))?;
    }
    Ok(match asked(&log, owner, options) {
        Ok((answer, _)) => judged(id, &injection, &answer, worse, over(answer.rmse_after_n)),
        Err(error) => Outcome {
            worse,
            left: f64::NAN,
            named: false,
            by_change: false,
            open: false,
            companion: false,
            also_changed: Vec::new(),
            ratio: None,
            in_best_set: false,
            detail: String::new(),
            label: error.lines().next().unwrap_or_default().to_string(),
        },
    })
}

/// Writes what is asked into a folder.
fn kept(folder: &Path, log: &Log, owner: &Model) -> std::io::Result<()> {
    std::fs::create_dir_all(folder)?;
    log.write_csv(&folder.join("measured.csv"))?;
    std::fs::write(folder.join("base.toml"), owner.to_toml())
}

fn judged(id: &str, injection: &Injection, answer: &Answer, worse: f64, left: f64) -> Outcome {
    let right = |named: &&Named| family(id).contains(&named.id.as_str());
    let mut standing = answer.effects.iter().filter(|named| stands(named));
    let named = standing.clone().find(right);
    // An effect that the model has already cannot be missing: its size is another.
    let is_own = |changed: &&Changed| {
        let of = changed.name.split_once('.');
        of.is_some_and(|(of, name)| family(id).contains(&of) && size_name(of, injection) == name)
    };
    let changed = answer.changed.iter().find(is_own);
    let also = answer.changed.iter().filter(|changed| !is_own(changed));
    let mut best = answer.best_set.iter();
    let mut detail = format!("{} {:.3e}", injection.name, injection.value);
    let supported = answer.effects.iter().filter(right);
    for support in supported.filter_map(|named| named.support.as_ref()) {
        detail += &format!(", {support}");
    }
    let by = changed.map(|changed| changed.by / injection.value);
    Outcome {
        worse,
        left,
        named: named.is_some() || changed.is_some(),
        by_change: named.is_none() && changed.is_some(),
        open: named.is_some() || changed.is_some() || is_left_open(family(id), answer),
        companion: standing.any(|named| !right(&named)),
        also_changed: also.map(|changed| changed.name.clone()).collect(),
        ratio: named.map_or(by, |named| ratio(named, injection)),
        in_best_set: best.any(|best| family(id).contains(&best.as_str())),
        detail,
        label: match changed {
            None => answer.label(),
            Some(changed) => format!("{} changed, {}", changed.name, answer.label()),
        },
    }
}

/// Whether one of these effects is an open name, or could stand for one.
pub(crate) fn is_left_open(effects: &[&str], answer: &Answer) -> bool {
    let open = answer.effects.iter().filter(|named| !stands(named));
    let mut ids = open.flat_map(|named| named.alternatives.iter().chain([&named.id]));
    ids.any(|id| effects.contains(&id.as_str()))
}

/// Whether a name stands: certain or strong; where the answer gives no grades, whatever it names.
pub(crate) fn stands(named: &Named) -> bool {
    named.grade != Some(Grade::Open)
}

/// The parameter of an effect that says how large it is.
fn size_name(id: &str, injection: &Injection) -> &'static str {
    match id {
        "stribeck_friction" => "kinetic_force",
        "time_delay" => "delay",
        "force_lag" => "time_constant",
        _ => injection.name,
    }
}

/// The found size over the true one; the force at which a loop slides is none of its numbers.
fn ratio(named: &Named, injection: &Injection) -> Option<f64> {
    let name = size_name(&named.id, injection);
    // A wave of negative amplitude is a positive one that is half a turn ahead.
    let (value, _) = named.params.get(name)?;
    let size = value / injection.value;
    Some(if name == "amplitude" {
        size.abs()
    } else {
        size
    })
}
