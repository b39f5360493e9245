//! `estimate.json` and `estimate.csv`.

use std::fmt::Write as _;
use std::io;
use std::ops::Range;
use std::path::Path;

use estimator_core::Estimate;
use estimator_core::estimate::{Parameters, Phase};
use rayon::prelude::*;
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
        writeln!(writer, "{}", header(replay).join(","))?;
        let count = replay.records.len();
        let parts: Vec<usize> = (0..count).step_by(PART).collect();
        for some in parts.chunks(2 * rayon::current_num_threads()) {
            let texts = some.par_iter().map(|from| {
                let part = *from..(from + PART).min(count);
                rows(replay, part, every)
            });
            for text in texts.collect::<Vec<String>>() {
                writer.write_all(text.as_bytes())?;
            }
        }
        Ok(())
    })
}

/// Records whose rows are put into words at once, each part by a core of its own: 0.7 MB.
const PART: usize = 4096;

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

fn rows(replay: &Replay, part: Range<usize>, every: usize) -> String {
    let mut text = String::with_capacity(200 * part.len() / every);
    let slots = replay.law().parameters().len();
    for (index, record) in part.clone().zip(replay.records.range(part)) {
        if index % every == 0 {
            // Writing into a String cannot fail.
            let _ = push_row(&mut text, replay, slots, index, &record);
        }
    }
    text
}

fn push_row(
    text: &mut String,
    replay: &Replay,
    slots: usize,
    index: usize,
    record: &Estimate<f32>,
) -> std::fmt::Result {
    let phase = match record.phase {
        Phase::Settling => "settling",
        Phase::Free => "free",
        Phase::Contact => "contact",
    };
    write!(
        text,
        "{:.6},{phase},{},{},{},{},{},{},{}",
        replay.time_s(index),
        record.status.name(),
        record.depth_m,
        record.speed_mps,
        record.force_n,
        record.innovation.prediction_n,
        record.innovation.test_ratio,
        record.forgetting,
    )?;
    // Parameters of a law that was given up later stand in no column.
    let own = record.law == replay.law();
    for parameter in &record.parameters[..slots] {
        match parameter.filter(|_| own) {
            Some(p) => write!(text, ",{},{}", p.value, p.std_error)?,
            None => text.push_str(",,"),
        }
    }
    let event = record.event.map_or("", |event| event.name());
    writeln!(text, ",{event},{}", record.faults.bits())
}
