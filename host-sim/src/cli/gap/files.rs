//! `gap.json`, `model.toml`, `gap.csv`, `report.html`, and `motion.toml` where a motion is advised.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use serde_json::{Map, Value, json};

use super::motion as advised_motion;
use crate::gap::{
    Candidate, Change, Curves, Episode, Finding, MOTION, MissingEffect, ParameterEstimate, Pattern,
    Region,
};
use crate::json::{number, write_json};
use crate::kind;
use crate::output::write_atomically;
use crate::report::{Document, Input, Provenance, gap::GapReport};

/// Writes the files into a folder; `json` is the content of `gap.json`.
pub(super) fn write(
    folder: &Path,
    finding: &Finding,
    inputs: &Inputs<'_>,
    json: &Value,
) -> io::Result<()> {
    // The motion comes first: if that is refused, nothing is written.
    advised_motion::put(folder, motion(finding, inputs).as_deref())?;
    write_json(&folder.join("gap.json"), json)?;
    write_atomically(&folder.join("model.toml"), |writer| {
        writer.write_all(finding.model.to_toml().as_bytes())
    })?;
    for (at, curves) in finding.curves.iter().enumerate() {
        let name = match at {
            0 => "gap.csv".to_string(),
            _ => format!("gap_{}.csv", at + 1),
        };
        write_atomically(&folder.join(name), |writer| csv(writer, curves))?;
    }
    report(finding, inputs)?.write(&folder.join("report.html"))
}

/// The files that a finding was made from.
pub(super) struct Inputs<'a> {
    pub(super) model: &'a Path,
    pub(super) logs: &'a [PathBuf],
}

/// The motion file, where a motion is advised.
fn motion(finding: &Finding, inputs: &Inputs<'_>) -> Option<String> {
    let advised = finding.advised.as_ref()?;
    let logs: Vec<String> = inputs.logs.iter().map(|path| name(path)).collect();
    let command = format!(
        "palpate gap --model {} --log {} --log NEW.csv --out DIR",
        name(inputs.model),
        logs.join(" --log ")
    );
    let limits = Some(finding.limits());
    let note = advised_motion::Note {
        words: &advised.words,
        purpose: &advised.purpose,
        command: &command,
        limits,
        peak_n: None,
    };
    Some(advised_motion::text(&advised.motion, &note))
}

fn name(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default();
    name.to_string_lossy().into_owned()
}

fn report(finding: &Finding, inputs: &Inputs<'_>) -> io::Result<Document> {
    let names: Vec<String> = inputs.logs.iter().map(|path| name(path)).collect();
    let mut provenance = Provenance::of_this_process();
    for path in std::iter::once(inputs.model).chain(inputs.logs.iter().map(PathBuf::as_path)) {
        provenance = provenance.input(Input::of_file(path)?);
    }
    if let Some(hz) = finding.bandwidth_hz {
        provenance = provenance.setting("Bandwidth", format!("{hz} Hz"));
    }
    let title = format!(
        "Gap between {} and {}",
        name(inputs.model),
        names.join(", ")
    );
    let report = GapReport {
        title: &title,
        finding,
        names: &names,
        provenance,
    };
    Ok(report.document())
}

/// The forces sample by sample, for pictures of one's own.
fn csv(writer: &mut dyn Write, curves: &Curves) -> io::Result<()> {
    let mut table = csv::Writer::from_writer(writer);
    table.write_record([
        "t_s",
        "x_m",
        "depth_m",
        "speed_mps",
        "force_n",
        "before_n",
        "after_n",
        "allowed_n",
        "held_out",
    ])?;
    for at in 0..curves.time_s.len() {
        table.write_record([
            format!("{:.6}", curves.time_s[at]),
            format!("{:.6e}", curves.position_m[at]),
            format!("{:.6e}", curves.depth_m[at]),
            format!("{:.5e}", curves.speed_mps[at]),
            format!("{:.6e}", curves.measured_n[at]),
            format!("{:.6e}", curves.before_n[at]),
            format!("{:.6e}", curves.after_n[at]),
            format!("{:.3e}", curves.allowed_n[at]),
            u8::from(curves.held_out[at]).to_string(),
        ])?;
    }
    table.flush()
}

/// The content of `gap.json`.
pub fn json(finding: &Finding, seconds: f64) -> Value {
    json!({
        "verdict": finding.verdict.name(),
        "kind": finding.model.kind.unwrap_or_default().name(),
        "effects": finding.effects.iter().map(effect).collect::<Vec<_>>(),
        "rmse_n": {
            "before": number(finding.rmse_before_n),
            "after": number(finding.rmse_after_n),
        },
        "noise_floor_n": number(finding.noise_floor_n),
        "remainder_n": number(finding.remainder_n),
        "explained_share": finding.explained_share().map(number),
        "bandwidth_hz": finding.bandwidth_hz,
        "floor_ratio": {
            "before": number(finding.ratio_before),
            "after": number(finding.ratio_after),
        },
        "slow_remainder": finding.slow_remainder.map(number),
        "nothing_new": finding.nothing_new,
        "left_out": finding.left_out.iter().map(episode).collect::<Vec<_>>(),
        "recovery": finding.model.environment.recovery.unwrap_or_default().name(),
        "base": {
            "before": parameters(&finding.base_before),
            "after": parameters(&finding.base_after),
        },
        "changed": finding.changed.as_ref().map(|all| all.counted.iter().map(change).collect::<Vec<_>>()),
        "perhaps_changed": finding.changed.as_ref().and_then(|all| all.likely.as_ref().map(change)),
        "disagreement": finding.disagreement.iter().map(region).collect::<Vec<_>>(),
        "remaining": finding.remaining.iter().map(region).collect::<Vec<_>>(),
        "candidates": finding.ladder.iter().map(candidate).collect::<Vec<_>>(),
        "advice": finding.advice,
        "motion": finding.advised.as_ref().map(|_| MOTION),
        "notes": finding.notes,
        "seconds": number(seconds),
    })
}

fn episode(episode: &Episode) -> Value {
    json!({
        "log": episode.log,
        "from_s": number(episode.from_s),
        "until_s": number(episode.until_s),
    })
}

fn effect(missing: &MissingEffect) -> Value {
    json!({
        "id": missing.id.name(),
        "params": parameters(&missing.parameters),
        "grade": missing.grade.name(),
        "support": {
            "share": number(missing.support.share),
            "blocks": number(missing.support.blocks),
            "next": missing.support.next.map(|next| next.id.name()),
            "next_share": missing.support.next.map(|next| number(next.share)),
        },
        "alternatives": missing.alternatives.iter().map(|id| id.name()).collect::<Vec<_>>(),
        "where": missing.place,
        "held_out_gain": number(missing.held_out_gain),
    })
}

fn parameters(estimates: &[ParameterEstimate]) -> Value {
    let each = estimates.iter().map(|estimate| {
        let mut value = json!({
            "value": number(estimate.value),
            "std_error": estimate.std_error.map(number),
            "unit": kind::unit(estimate.unit),
        });
        if estimate.at_bound {
            value["at_bound"] = true.into();
        }
        (estimate.name.clone(), value)
    });
    Value::Object(each.collect::<Map<_, _>>())
}

fn change(change: &Change) -> Value {
    json!({
        "name": change.now.name,
        "was": { "value": number(change.was.0), "std_error": number(change.was.1) },
        "now": { "value": number(change.now.value), "std_error": change.now.std_error.map(number) },
        "unit": kind::unit(change.now.unit),
        "share": number(change.share()),
        "std_errors": number(change.std_errors()),
        "gone": change.is_gone,
    })
}

fn region(region: &Region) -> Value {
    let mut value = json!({
        "region": region.id,
        "share": number(region.share),
        "rms_n": number(region.rms_n),
    });
    match region.pattern {
        Some(Pattern::Line { hz }) => value["hz"] = number(hz),
        Some(Pattern::Pitch { m }) => value["m"] = number(m),
        Some(Pattern::Step { s, n }) => {
            value["s"] = number(s);
            value["n"] = number(n);
        }
        Some(Pattern::SurfaceStep { s, m }) => {
            value["s"] = number(s);
            value["m"] = number(m);
        }
        None => {}
    }
    value
}

fn candidate(candidate: &Candidate) -> Value {
    json!({
        "effects": candidate.ids.iter().map(|id| id.name()).collect::<Vec<_>>(),
        "floor_ratio": number(candidate.ratio),
    })
}
