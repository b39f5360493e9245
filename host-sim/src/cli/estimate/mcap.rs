//! `estimate.mcap`: the samples, and what the estimator said to each, on one clock.

use std::io;
use std::path::Path;

use estimator_core::estimate::Phase;
use serde_json::{Map, Value, json};

use crate::log::{McapTopics, UniformLog, write_mcap};
use crate::replay::Replay;

const TOPIC: &str = "/palpate/estimate";
const SCHEMA: &str = "palpate.Estimate";
const SIGNALS: [&str; 5] = ["t_s", "depth_m", "speed_mps", "force_n", "prediction_n"];

/// Writes samples and, where there is a replay, every `every`-th estimate.
///
/// # Errors
/// What the file system says.
pub(super) fn write(
    path: &Path,
    log: &UniformLog,
    replay: Option<(&Replay, usize)>,
) -> io::Result<()> {
    write_mcap(path, |topics| {
        log.put_into(topics)?;
        match replay {
            Some((replay, every)) => put_estimates(topics, replay, every),
            None => Ok(()),
        }
    })
}

fn put_estimates(topics: &mut McapTopics, replay: &Replay, every: usize) -> io::Result<()> {
    let parameters: Vec<&str> = replay
        .law()
        .parameters()
        .iter()
        .map(|info| info.name)
        .collect();
    let errors: Vec<String> = parameters
        .iter()
        .map(|name| format!("{name}_std_error"))
        .collect();
    let mut numbers = SIGNALS.to_vec();
    numbers.extend(&parameters);
    numbers.extend(errors.iter().map(String::as_str));
    let topic = topics.add(TOPIC, SCHEMA, &numbers, &["phase", "status"])?;
    for index in (0..replay.records.len()).step_by(every) {
        let time_s = replay.time_s(index);
        topics.put(topic, time_s, &message(replay, index, time_s, &parameters))?;
    }
    Ok(())
}

fn message(replay: &Replay, index: usize, time_s: f64, parameters: &[&str]) -> Map<String, Value> {
    let record = replay.records.at(index);
    let signals = [
        time_s,
        record.depth_m.into(),
        record.speed_mps.into(),
        record.force_n.into(),
        record.innovation.prediction_n.into(),
    ];
    let mut message = Map::new();
    for (name, value) in SIGNALS.iter().zip(signals) {
        message.insert(name.to_string(), json!(value));
    }
    // Parameters of a law that was given up later stand in no column.
    let is_own = record.law == replay.law();
    for (name, parameter) in parameters.iter().zip(&record.parameters) {
        let parameter = parameter.filter(|_| is_own);
        message.insert(name.to_string(), json!(parameter.map(|p| p.value)));
        message.insert(
            format!("{name}_std_error"),
            json!(parameter.map(|p| p.std_error)),
        );
    }
    let phase = match record.phase {
        Phase::Settling => "settling",
        Phase::Free => "free",
        Phase::Contact => "contact",
    };
    message.insert("phase".into(), phase.into());
    message.insert("status".into(), record.status.name().into());
    message
}
