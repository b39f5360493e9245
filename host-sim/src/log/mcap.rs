//! MCAP: the container of recordings that Foxglove and PlotJuggler open.
//!
//! Written are messages in JSON with their JSON Schema: `/palpate/sample` of the schema `palpate.Sample`, with
//! `t_s` (s), `x_m` (m), `f_n` (N) and the log's further columns; more topics stand beside it. Read is any file
//! with messages in JSON: its numbers become the columns of a table, `topic.field` where there are several
//! topics, on the stamps of the topic with the most messages, the others interpolated.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::Path;

use ::mcap::records::MessageHeader;
use ::mcap::write::NoSeek;
use ::mcap::{Compression, McapError, MessageStream, WriteOptions, Writer};
use serde_json::{Map, Value, json};

use super::channel::Channel;
use super::record::Log;
use super::uniform::UniformLog;
use crate::kind::Kind;
use crate::output::write_atomically;

/// The first bytes of a file.
pub(super) const MAGIC: &[u8] = b"\x89MCAP0\r\n";

/// The topic of samples, and its schema.
const SAMPLES: &str = "/palpate/sample";
const SAMPLE_SCHEMA: &str = "palpate.Sample";

/// Nanoseconds of a second.
const NANO: f64 = 1e9;

/// Why a file holds no log: what is wrong and what would be right.
#[derive(Debug)]
pub(super) struct Unusable(pub(super) String, pub(super) &'static str);

/// The numbers of one topic over time.
struct Series {
    topic: String,
    time_ns: Vec<u64>,
    /// By the path of a field, in the order of its first message.
    fields: Vec<(String, Vec<f64>)>,
}

/// The messages of a file as a table in CSV, with the stamps in `t_s` where the messages hold none.
pub(super) fn table(file: &[u8]) -> Result<Vec<u8>, Unusable> {
    let damaged = |error: McapError| {
        Unusable(
            format!("the MCAP file cannot be read: {error}"),
            "record again, or repair it with `mcap recover`",
        )
    };
    let mut series: Vec<Series> = Vec::new();
    let mut others: Vec<String> = Vec::new();
    for message in MessageStream::new(file).map_err(damaged)? {
        let message = message.map_err(damaged)?;
        let channel = &message.channel;
        if channel.message_encoding != "json" {
            let name = format!("{} ({})", channel.topic, channel.message_encoding);
            if !others.contains(&name) {
                others.push(name);
            }
            continue;
        }
        let at = match series.iter().position(|own| own.topic == channel.topic) {
            Some(at) => at,
            None => {
                series.push(Series {
                    topic: channel.topic.clone(),
                    time_ns: Vec::new(),
                    fields: Vec::new(),
                });
                series.len() - 1
            }
        };
        let mut numbers = Vec::new();
        if let Ok(value) = serde_json::from_slice::<Value>(&message.data) {
            flatten("", &value, &mut numbers);
        }
        series[at].push(message.log_time, numbers);
    }
    series.retain(|series| !series.fields.is_empty() && series.time_ns.len() > 1);
    // A recording of our own holds what the estimator said beside its samples.
    if let Some(own) = series.iter().position(|series| series.topic == SAMPLES) {
        series = vec![series.swap_remove(own)];
    }
    let longest = series
        .iter()
        .enumerate()
        .max_by_key(|(_, series)| series.time_ns.len());
    match longest.map(|(at, _)| at) {
        Some(master) => Ok(merged(&series, master)),
        None if others.is_empty() => Err(Unusable(
            "the MCAP file holds no numbers".into(),
            "give a recording of force and position",
        )),
        None => Err(Unusable(
            format!(
                "the MCAP file holds no message in JSON, but {}",
                others.join(", ")
            ),
            "export the topics of force and position as CSV (PlotJuggler does), or record them in JSON",
        )),
    }
}

/// The numbers in a value, with their paths.
fn flatten(path: &str, value: &Value, numbers: &mut Vec<(String, f64)>) {
    let below = |name: &str| match path.is_empty() {
        true => name.to_string(),
        false => format!("{path}.{name}"),
    };
    match value {
        Value::Number(number) => {
            numbers.extend(number.as_f64().map(|number| (path.to_string(), number)))
        }
        Value::Object(object) => object
            .iter()
            .for_each(|(name, value)| flatten(&below(name), value, numbers)),
        // Three axes are columns, a picture is none.
        Value::Array(array) if array.len() <= 16 => {
            for (index, value) in array.iter().enumerate() {
                flatten(&below(&index.to_string()), value, numbers);
            }
        }
        _ => {}
    }
}

impl Series {
    fn push(&mut self, time_ns: u64, numbers: Vec<(String, f64)>) {
        let before = self.time_ns.len();
        self.time_ns.push(time_ns);
        for (at, (path, number)) in numbers.into_iter().enumerate() {
            // Messages of a topic hold the same fields in the same order, nearly always.
            let usual = self
                .fields
                .get(at)
                .is_some_and(|(own, _)| *own == path)
                .then_some(at);
            let found = usual.or_else(|| self.fields.iter().position(|(own, _)| *own == path));
            let at = found.unwrap_or_else(|| {
                self.fields.push((path, vec![f64::NAN; before]));
                self.fields.len() - 1
            });
            self.fields[at].1.push(number);
        }
        let count = self.time_ns.len();
        self.fields
            .iter_mut()
            .for_each(|(_, values)| values.resize(count, f64::NAN));
    }

    /// A field at a time, on the straight line between the messages around it.
    fn at(&self, values: &[f64], time_ns: u64) -> f64 {
        let right = self.time_ns.partition_point(|own| *own < time_ns);
        if right == 0 || right == values.len() {
            return values[right.min(values.len() - 1)];
        }
        let (from, to) = (self.time_ns[right - 1], self.time_ns[right]);
        let share = (time_ns - from) as f64 / (to - from) as f64;
        values[right - 1] + share * (values[right] - values[right - 1])
    }
}

fn merged(series: &[Series], master: usize) -> Vec<u8> {
    let several = series.len() > 1;
    let name = |series: &Series, path: &str| match several {
        true => format!("{}.{path}", series.topic),
        false => path.to_string(),
    };
    let times = &series[master].time_ns;
    let first_ns = times.iter().copied().min().unwrap_or(0);
    let mut names: Vec<String> = Vec::new();
    for series in series {
        names.extend(series.fields.iter().map(|(path, _)| name(series, path)));
    }
    let has_time = names.iter().any(|name| name == "t_s");
    if !has_time {
        names.insert(0, "t_s".into());
    }
    let mut text = names
        .iter()
        .map(|name| format!("\"{name}\""))
        .collect::<Vec<_>>()
        .join(",");
    for (row, time_ns) in times.iter().enumerate() {
        let mut separator = "\n";
        let mut push = |value: f64| {
            text.push_str(separator);
            separator = ",";
            if value.is_finite() {
                text.push_str(&value.to_string());
            }
        };
        if !has_time {
            push((time_ns - first_ns) as f64 / NANO);
        }
        for (at, own) in series.iter().enumerate() {
            for (_, values) in &own.fields {
                push(if at == master {
                    values[row]
                } else {
                    own.at(values, *time_ns)
                });
            }
        }
    }
    text.push('\n');
    text.into_bytes()
}

/// Topics that are being written into a file.
pub struct McapTopics<'a> {
    writer: Writer<NoSeek<&'a mut dyn Write>>,
    channels: Vec<(u16, u32)>,
}

impl McapTopics<'_> {
    /// Adds a topic of messages in JSON; the properties of its schema are numbers but for those that are given as
    /// text.
    ///
    /// # Errors
    /// What the file system says.
    pub fn add(
        &mut self,
        topic: &str,
        schema: &str,
        numbers: &[&str],
        texts: &[&str],
    ) -> io::Result<usize> {
        let typed = |names: &[&str], kind: &'static str| -> Vec<(String, Value)> {
            names
                .iter()
                .map(|name| (name.to_string(), json!({ "type": kind })))
                .collect()
        };
        let properties = typed(numbers, "number")
            .into_iter()
            .chain(typed(texts, "string"));
        let schema_text = json!({
            "title": schema,
            "type": "object",
            "properties": properties.collect::<Map<_, _>>(),
        });
        let schema =
            self.writer
                .add_schema(schema, "jsonschema", schema_text.to_string().as_bytes());
        let channel =
            self.writer
                .add_channel(schema.map_err(failed)?, topic, "json", &BTreeMap::new());
        self.channels.push((channel.map_err(failed)?, 0));
        Ok(self.channels.len() - 1)
    }

    /// Writes a message of a topic at a time (s); what is not finite is null.
    ///
    /// # Errors
    /// What the file system says.
    pub fn put(
        &mut self,
        topic: usize,
        time_s: f64,
        message: &Map<String, Value>,
    ) -> io::Result<()> {
        let (channel_id, sequence) = &mut self.channels[topic];
        let log_time = (time_s.max(0.0) * NANO).round() as u64;
        let header = MessageHeader {
            channel_id: *channel_id,
            sequence: *sequence,
            log_time,
            publish_time: log_time,
        };
        *sequence = sequence.wrapping_add(1);
        let text = serde_json::to_vec(message)?;
        self.writer
            .write_to_known_channel(&header, &text)
            .map_err(failed)
    }
}

fn failed(error: McapError) -> io::Error {
    match error {
        McapError::Io(error) => error,
        other => io::Error::other(other.to_string()),
    }
}

/// Writes an MCAP file with the topics that `fill` puts into it; it appears whole or not at all.
///
/// # Errors
/// What the file system says.
pub fn write_mcap(
    path: &Path,
    fill: impl FnOnce(&mut McapTopics) -> io::Result<()>,
) -> io::Result<()> {
    write_atomically(path, |writer| {
        let options = WriteOptions::new()
            .library(concat!("palpate ", env!("CARGO_PKG_VERSION")))
            .compression(Some(Compression::Zstd))
            .disable_seeking(true);
        let mut topics = McapTopics {
            writer: options.create(NoSeek::new(writer)).map_err(failed)?,
            channels: Vec::new(),
        };
        fill(&mut topics)?;
        topics.writer.finish().map_err(failed)?;
        Ok(())
    })
}

/// Puts samples into a topic of their own.
fn put_samples(
    topics: &mut McapTopics,
    kind: Option<Kind>,
    channels: [&[f64]; 3],
    further: &[(Cow<str>, &[f64])],
) -> io::Result<()> {
    let own = Channel::ALL.map(|channel| channel.column_of(kind.unwrap_or_default()));
    let names: Vec<&str> = own
        .into_iter()
        .chain(further.iter().map(|(name, _)| name.as_ref()))
        .collect();
    let topic = topics.add(SAMPLES, SAMPLE_SCHEMA, &names, &[])?;
    for row in 0..channels[0].len() {
        let values = channels.iter().map(|channel| channel[row]);
        let values = values.chain(further.iter().map(|(_, values)| values[row]));
        let message = names
            .iter()
            .zip(values)
            .map(|(name, value)| (name.to_string(), json!(value)));
        topics.put(topic, channels[0][row], &message.collect())?;
    }
    Ok(())
}

impl Log {
    /// Puts the samples and further columns into a file.
    ///
    /// # Errors
    /// What the file system says.
    pub fn put_into(&self, topics: &mut McapTopics) -> io::Result<()> {
        let further = self
            .extra
            .iter()
            .map(|column| (Cow::from(&column.name), column.values.as_slice()));
        let further: Vec<_> = further.collect();
        put_samples(
            topics,
            self.kind,
            [&self.time_s, &self.position_m, &self.force_n],
            &further,
        )
    }
}

impl UniformLog {
    /// Puts the samples into a file.
    ///
    /// # Errors
    /// What the file system says.
    pub fn put_into(&self, topics: &mut McapTopics) -> io::Result<()> {
        put_samples(
            topics,
            self.kind,
            [&self.time_s, &self.position_m, &self.force_n],
            &[],
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::{ExtraColumn, ReadOptions};
    use std::fs;

    #[test]
    fn what_is_read_back_is_what_was_written_to_the_bit() {
        let ramp = |scale: f64| (0..50).map(|i| f64::from(i) * scale).collect::<Vec<_>>();
        let mut log = Log::from_channels(ramp(1e-3), ramp(1.234_567_890_123e-6), ramp(0.005));
        log.extra.push(ExtraColumn {
            name: "temp_c".into(),
            values: ramp(0.1),
        });
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.mcap");
        write_mcap(&path, |topics| log.put_into(topics)).unwrap();
        let back = Log::read(&path, &ReadOptions::default()).unwrap();
        assert_eq!(back.time_s, log.time_s);
        assert_eq!(back.position_m, log.position_m);
        assert_eq!(back.extra, log.extra);
    }

    #[test]
    fn a_machine_that_turns_is_read_back_as_one() {
        let ramp: Vec<f64> = (0..50).map(|i| f64::from(i) * 1e-3).collect();
        let log = Log {
            kind: Some(Kind::Rotary),
            ..Log::from_channels(ramp.clone(), ramp.clone(), ramp)
        };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.mcap");
        write_mcap(&path, |topics| log.put_into(topics)).unwrap();
        let back = Log::read(&path, &ReadOptions::default()).unwrap();
        assert_eq!(back.kind, Some(Kind::Rotary));
        assert_eq!(back.position_m, log.position_m);
    }

    #[test]
    fn topics_of_others_are_put_on_one_clock() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.mcap");
        write_mcap(&path, |topics| {
            let force = topics.add("/load", "Load", &["force_N"], &[])?;
            let position = topics.add("/axis", "Axis", &["pos_mm"], &["state"])?;
            for i in 0..200 {
                let t = f64::from(i) * 1e-3;
                topics.put(
                    force,
                    5.0 + t,
                    json!({ "force_N": 2.0 * t }).as_object().unwrap(),
                )?;
                if i % 2 == 0 {
                    let message = json!({ "pos_mm": 10.0 * t, "state": "on" });
                    topics.put(position, 5.0 + t, message.as_object().unwrap())?;
                }
            }
            Ok(())
        })
        .unwrap();
        let log = Log::read(&path, &ReadOptions::default()).unwrap();
        assert_eq!(log.len(), 200);
        for at in 0..199 {
            assert!(
                (log.position_m[at] - 0.01 * log.time_s[at]).abs() < 1e-9,
                "{at}"
            );
        }
        assert!((log.rate_hz() - 1000.0).abs() < 1e-9);
    }

    #[test]
    fn messages_that_cannot_be_read_are_named_with_what_to_do() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.mcap");
        let mut writer = Writer::new(fs::File::create(&path).unwrap()).unwrap();
        let channel = writer
            .add_channel(0, "/wrench", "cdr", &BTreeMap::new())
            .unwrap();
        let header = MessageHeader {
            channel_id: channel,
            sequence: 0,
            log_time: 1,
            publish_time: 1,
        };
        writer.write_to_known_channel(&header, &[0, 1, 2]).unwrap();
        writer.finish().unwrap();
        drop(writer);
        let error = Log::read(&path, &ReadOptions::default())
            .unwrap_err()
            .to_string();
        assert!(
            error.contains("/wrench (cdr)") && error.contains("export the topics"),
            "{error}"
        );
        fs::write(&path, MAGIC).unwrap();
        assert!(Log::read(&path, &ReadOptions::default()).is_err());
    }
}
