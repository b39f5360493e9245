//! `estimate.json` and `estimate.csv`.

use std::io;
use std::path::Path;

use estimator_core::estimate::{Parameters, Phase};
use serde_json::{Map, Value, json};

use super::json::{events, measured, touches};
use crate::estimate::{Outcome, Reason};
use crate::json::{number, seconds};
use crate::kind;
use crate::output::write_atomically;
use crate::replay::Replay;

/// What stands in `estimate.json` besides the outcome.
#[derive(Clone, Debug)]
pub(super) struct Context<'a> {
    /// The method's name on the command line.
    pub(super) method: &'a str,
    /// δ₀ (m).
    pub(super) reference_depth_m: f64,
    /// Standard deviation of the raw force (N).
    pub(super) noise_n: f64,
    /// The laws that were compared, each with its RMSE (N), if the law was to be chosen.
    pub(super) selection: &'a [(&'a str, Option<f64>)],
    /// The effects that were taken off the log.
    pub(super) compensated: &'a [String],
    /// What a reader must know, a sentence each.
    pub(super) notes: &'a [String],
}

fn parameters(outcome: &Outcome, parameters: &Parameters<f32>) -> Value {
    let mut object = Map::new();
    for (info, estimate) in outcome.named(parameters) {
        let value = estimate.map_or(Value::Null, |estimate| {
            json!({
                "value": number(estimate.value.into()),
                "std_error": number(estimate.std_error.into()),
                "unit": kind::unit(info.unit.symbol()),
            })
        });
        object.insert(info.name.into(), value);
    }
    Value::Object(object)
}

/// The content of `estimate.json`.
pub(super) fn json(outcome: &Outcome, context: &Context) -> Value {
    let segments = outcome.segments.iter().map(|segment| {
        json!({
            "from_s": seconds(segment.from_s),
            "to_s": seconds(segment.to_s),
            "parameters": parameters(outcome, &segment.parameters),
        })
    });
    let selection = context
        .selection
        .iter()
        .map(|(law, rmse)| json!({ "law": law, "force_rmse_n": rmse.map(number) }));
    json!({
        "law": outcome.law.name(),
        "method": context.method,
        "reference_depth_m": number(context.reference_depth_m),
        "status": outcome.status.name(),
        "status_reason": outcome.reason.map(Reason::name),
        "parameters": parameters(outcome, &outcome.parameters),
        "force_rmse_n": outcome.force_rmse_n.map(number),
        "force_noise_n": number(context.noise_n),
        "skew_s": measured(outcome.skew),
        "settled_at_s": outcome.settled_at_s.map(seconds),
        "segments": segments.collect::<Vec<_>>(),
        "touches": touches(&outcome.touches),
        "events": events(&outcome.events),
        "selection": selection.collect::<Vec<_>>(),
        "compensated": context.compensated,
        "notes": context.notes,
    })
}

/// Writes `estimate.csv`: a row for every `every`-th record. A parameter that is not observable is
/// an empty field.
///
/// # Errors
/// What the file system says; nothing is half written.
pub(super) fn write_csv(path: &Path, replay: &Replay, every: usize) -> io::Result<()> {
    write_atomically(path, |writer| {
        let mut table = csv::Writer::from_writer(writer);
        table.write_record(header(replay))?;
        for index in (0..replay.records.len()).step_by(every) {
            table.write_record(row(replay, index))?;
        }
        table.flush()
    })
}

fn header(replay: &Replay) -> Vec<String> {
    let signals = "t_s,phase,status,depth_m,speed_mps,force_n,prediction_n,test_ratio,beta";
    let mut header: Vec<String> = signals.split(',').map(String::from).collect();
    for info in replay.law().parameters() {
        header.push(info.name.into());
        header.push(format!("{}_std_error", info.name));
    }
    header.push("event".into());
    header.push("faults".into());
    header
}

fn row(replay: &Replay, index: usize) -> Vec<String> {
    let record = &replay.records[index];
    let phase = match record.phase {
        Phase::Settling => "settling",
        Phase::Free => "free",
        Phase::Contact => "contact",
    };
    let mut row = vec![
        format!("{:.6}", replay.time_s(index)),
        phase.into(),
        record.status.name().into(),
        record.depth_m.to_string(),
        record.speed_mps.to_string(),
        record.force_n.to_string(),
        record.innovation.prediction_n.to_string(),
        record.innovation.test_ratio.to_string(),
        record.forgetting.to_string(),
    ];
    let slots = replay.law().parameters().len();
    // Parameters of a law that was given up later stand in no column.
    let own = record.law == replay.law();
    for parameter in &record.parameters[..slots] {
        let parameter = parameter.filter(|_| own);
        row.push(parameter.map_or(String::new(), |p| p.value.to_string()));
        row.push(parameter.map_or(String::new(), |p| p.std_error.to_string()));
    }
    row.push(record.event.map_or("", |event| event.name()).into());
    row.push(record.faults.bits().to_string());
    row
}
