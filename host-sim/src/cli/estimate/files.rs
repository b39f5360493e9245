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
use super::methods::MethodChoice;
use crate::estimate::{Compared, Outcome, Reason};
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
    pub(super) selection: &'a [Compared],
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
    let selection = context.selection.iter().map(|own| {
        json!({
            "law": own.law,
            "method": MethodChoice::of(own.method).name(),
            "force_rmse_n": own.force_rmse_n.map(number),
        })
    });
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
    let mut cells = Cells::of(replay.law().parameters().len());
    for (index, record) in part.clone().zip(replay.records.range(part)) {
        if index % every == 0 {
            // Writing into a String cannot fail.
            let _ = push_row(&mut text, &mut cells, replay, index, &record);
        }
    }
    text
}

/// The numbers of a row, each with its text in the row before: most of them stay the same in free air, and to put
/// them into words is half of what an hour's table costs.
struct Cells {
    slots: usize,
    last: Vec<(u32, String)>,
}

impl Cells {
    fn of(slots: usize) -> Cells {
        Cells {
            slots,
            last: vec![(0.0_f32.to_bits(), "0".into()); SIGNALS + 2 * slots],
        }
    }

    /// Appends a comma and the number of a column.
    fn push(&mut self, text: &mut String, column: usize, value: f32) -> std::fmt::Result {
        let (bits, own) = &mut self.last[column];
        if *bits != value.to_bits() {
            *bits = value.to_bits();
            own.clear();
            put_in_words(own, value)?;
        }
        text.push(',');
        text.push_str(own);
        Ok(())
    }
}

/// Appends the shortest decimal that reads as the number again, without an exponent.
fn put_in_words(text: &mut String, value: f32) -> std::fmt::Result {
    let mut buffer = ryu::Buffer::new();
    let shortest = value.is_finite().then(|| buffer.format_finite(value));
    match shortest.filter(|digits| !digits.contains('e')) {
        Some(digits) => text.push_str(digits.strip_suffix(".0").unwrap_or(digits)),
        None => write!(text, "{value}")?,
    }
    Ok(())
}

/// Numbers of a row beside its time and the parameters.
const SIGNALS: usize = 6;

fn push_row(
    text: &mut String,
    cells: &mut Cells,
    replay: &Replay,
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
        "{:.6},{phase},{}",
        replay.time_s(index),
        record.status.name(),
    )?;
    let signals: [f32; SIGNALS] = [
        record.depth_m,
        record.speed_mps,
        record.force_n,
        record.innovation.prediction_n,
        record.innovation.test_ratio,
        record.forgetting,
    ];
    for (column, value) in signals.into_iter().enumerate() {
        cells.push(text, column, value)?;
    }
    // Parameters of a law that was given up later stand in no column.
    let own = record.law == replay.law();
    for (slot, parameter) in record.parameters[..cells.slots].iter().enumerate() {
        let Some(p) = parameter.filter(|_| own) else {
            text.push_str(",,");
            continue;
        };
        let column = SIGNALS + 2 * slot;
        cells.push(text, column, p.value)?;
        cells.push(text, column + 1, p.std_error)?;
    }
    let event = record.event.map_or("", |event| event.name());
    writeln!(text, ",{event},{}", record.faults.bits())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_in_words_reads_as_itself_in_no_more_digits_than_it_needs() {
        let numbers = [
            0.0,
            -0.0,
            1.0,
            -2.5,
            0.1,
            0.005_098_039_3,
            1350.0,
            1e-5,
            3.2e-9,
            1e7,
            2.5e16,
            3.4e38,
        ];
        let halved = (0..1000).map(|at| 1234.567 * 0.97_f32.powi(at));
        for value in numbers
            .into_iter()
            .chain(halved)
            .chain([f32::NAN, f32::INFINITY])
        {
            let mut text = String::new();
            put_in_words(&mut text, value).unwrap();
            // Of two decimals that are as short and as near it may take the other one.
            let known = format!("{value}");
            assert_eq!(text.len(), known.len(), "{text} {known}");
            let read: f32 = text.parse().unwrap();
            assert!(
                read.to_bits() == value.to_bits() || value.is_nan(),
                "{text} {known}"
            );
        }
    }
}
