//! A file into logs: its table is found, its columns and signs are understood, its rows are read.

mod finish;
mod notes;
mod parts;
mod problem;
mod rows;

use std::path::Path;

use csv::{ByteRecord, ReaderBuilder};

use super::channel::{Channel, Header, Origin};
use super::orientation::{self, Orientation};
use super::origin::SourceColumns;
use super::preamble::{self, Preamble};
use super::record::{Log, ReadOptions};
use super::source::{Source, unreadable};
use crate::diagnostic::Diagnostic;
use crate::kind::Kind;
use notes::understood;
use parts::separators;
use problem::Table;
use rows::Rows;

impl Log {
    /// Reads a file that holds one recording: text with a header, gzipped or not, whatever its delimiter
    /// (comma, semicolon, tab, blanks), encoding and way to write numbers; `-` is standard input.
    ///
    /// # Errors
    /// A [`Diagnostic`] that names line, column, value and remedy: not a table, empty, a column
    /// missing or not certain, text in a number, a ragged row, NaN, time running backward, fewer than
    /// [`FEWEST_SAMPLES`](super::FEWEST_SAMPLES) samples, several recordings.
    pub fn read(path: &Path, options: &ReadOptions) -> Result<Log, Diagnostic> {
        let mut logs = Log::read_all(path, options)?;
        match (logs.pop(), logs.len()) {
            (Some(log), 0) => Ok(log),
            (_, others) => Err(Diagnostic::new(format!(
                "the file holds {} recordings",
                others + 1
            ))
            .in_file(path)
            .remedy("give a file with one recording, or leave --trace-column out")),
        }
    }

    /// Reads every recording of a file: several where `trace_column` separates them.
    ///
    /// # Errors
    /// Those of [`Log::read`].
    pub fn read_all(path: &Path, options: &ReadOptions) -> Result<Vec<Log>, Diagnostic> {
        read_all(path, options)
    }
}

fn read_all(path: &Path, options: &ReadOptions) -> Result<Vec<Log>, Diagnostic> {
    let source = Source::open(path)?;
    let encoding = source.encoding;
    let preamble = preamble::parse(&source.head, path, &options.columns)?;
    let header = Header {
        names: &preamble.names,
        units: &preamble.units,
        sample: &preamble.sample,
    };
    let at_header = |error: Diagnostic| {
        let error = error.in_file(path);
        match preamble.header_line {
            0 => error,
            line => error
                .at_line(line)
                .excerpt(preamble.header_text.clone(), 0..0),
        }
    };
    let is_timed = options.rate_hz.is_none();
    let placed = options.columns.place(header, is_timed).map_err(at_header)?;
    let separators = separators(options, header, placed[0]).map_err(at_header)?;
    let table = Table {
        path,
        preamble: &preamble,
        placed,
        skips_bad_rows: options.skip_bad_rows,
    };
    let mut rows = Rows::new(&table, &separators, options.rate_hz);
    read_rows(source, &table, &mut rows)?;
    let mut logs = rows.finish()?;
    let orientation = oriented(&mut logs, &table, &options.columns);
    if orientation == Orientation::One {
        return Err(at_header(table.which_sign()));
    }
    if let Some(sentence) = understood(&table, encoding, options, orientation, &logs) {
        for log in &mut logs {
            log.notes.insert(0, sentence.clone());
        }
    }
    Ok(logs)
}

fn read_rows(source: Source, table: &Table, rows: &mut Rows) -> Result<(), Diagnostic> {
    let preamble: &Preamble = table.preamble;
    let mut reader = ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .delimiter(preamble.delimiter)
        .comment(Some(b'#'))
        .buffer_capacity(1 << 18)
        .from_reader(source.starting_at(preamble.data_offset, preamble.delimiter));
    let mut record = ByteRecord::new();
    while reader
        .read_byte_record(&mut record)
        .map_err(|error| broken(table.path, error))?
    {
        rows.take(&record)?;
    }
    Ok(())
}

fn broken(path: &Path, error: csv::Error) -> Diagnostic {
    match error.into_kind() {
        csv::ErrorKind::Io(error) => unreadable(path, &error),
        other => Diagnostic::new(format!("cannot read the table: {other:?}")).in_file(path),
    }
}

/// Turns channels of other machines the way ours count, where nobody has said how they do. The recording
/// with the largest force tells for all of a file.
fn oriented(logs: &mut [Log], table: &Table, columns: &super::columns::ColumnMap) -> Orientation {
    let is_guessed =
        |slot: usize| table.placed[slot].is_some_and(|placed| placed.origin == Origin::Guessed);
    if !(is_guessed(1) || is_guessed(2)) || columns.orients() {
        return Orientation::AsIs;
    }
    let span = |log: &&Log| crate::stats::range(&log.force_n);
    let Some(clearest) = logs.iter().max_by(|a, b| span(a).total_cmp(&span(b))) else {
        return Orientation::AsIs;
    };
    let found = orientation::of(&clearest.position_m, &clearest.force_n);
    // The weight of a lever falls along its turn, and columns in SI that say so are taken as they are: only a contact
    // with air beside it proves otherwise.
    let is_rotary = clearest.kind == Some(Kind::Rotary);
    let orientation = match found {
        Orientation::One if is_rotary || states_si(table) => Orientation::AsIs,
        found => found,
    };
    let negate = |channel: &mut Vec<f64>| channel.iter_mut().for_each(|value| *value = -*value);
    for log in logs {
        if matches!(orientation, Orientation::Both | Orientation::Position) {
            negate(&mut log.position_m);
            turn(&mut log.source, Channel::Position);
        }
        if matches!(orientation, Orientation::Both | Orientation::Force) {
            negate(&mut log.force_n);
            turn(&mut log.source, Channel::Force);
        }
    }
    orientation
}

fn turn(source: &mut Option<SourceColumns>, channel: Channel) {
    if let Some(source) = source {
        source.turn(channel);
    }
}

/// Whether position and force have names as ours, a word and the SI unit behind it: `position_m`, `torque_nm`.
fn states_si(table: &Table) -> bool {
    let is_si = |slot: usize| {
        let unit = table.placed[slot].and_then(|placed| placed.unit);
        let name = table.name(slot);
        unit.is_some_and(|unit| unit.factor == 1.0)
            && name.contains('_')
            && name.chars().all(|c| c.is_alphanumeric() || c == '_')
    };
    is_si(Channel::Position as usize) && is_si(Channel::Force as usize)
}

#[cfg(test)]
mod tests;
