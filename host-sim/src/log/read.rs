//! Rows into channels, and what is wrong with a row.

use std::ops::Range;
use std::path::Path;

use csv::{ByteRecord, ReaderBuilder};

use super::cell::{Cell, number};
use super::columns::{Channel, Placed};
use super::preamble::{self, Preamble};
use super::record::{ExtraColumn, FEWEST_SAMPLES, Log, ReadOptions};
use super::source::{Source, line_at, unreadable};
use crate::diagnostic::Diagnostic;

/// Largest share of rows that may be left out, or of stamps that may repeat: beyond it the rest no
/// longer stands for the measurement.
const MOST_LEFT_OUT: f64 = 0.2;

impl Log {
    /// Reads a CSV file, gzipped or not, whatever its delimiter (comma, semicolon, tab).
    ///
    /// # Errors
    /// A [`Diagnostic`] that names line, column, value and remedy: not a table, empty, a column
    /// missing, text in a number, a ragged row, NaN, time running backward, fewer than
    /// [`FEWEST_SAMPLES`] samples.
    pub fn read(path: &Path, options: &ReadOptions) -> Result<Log, Diagnostic> {
        read(path, options)
    }
}

fn read(path: &Path, options: &ReadOptions) -> Result<Log, Diagnostic> {
    let source = Source::open(path)?;
    let preamble = preamble::parse(&source.head, path)?;
    let placed = options.columns.place(&preamble.names).map_err(|error| {
        error
            .in_file(path)
            .at_line(preamble.header_line)
            .excerpt(preamble.header_text.clone(), 0..0)
    })?;
    let mut reader = ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .delimiter(preamble.delimiter)
        .comment(Some(b'#'))
        .buffer_capacity(1 << 18)
        .from_reader(source.starting_at(preamble.data_offset));
    let mut rows = Rows::new(path, &preamble, placed);
    let mut record = ByteRecord::new();
    while reader
        .read_byte_record(&mut record)
        .map_err(|error| broken(path, error))?
    {
        match rows.take(&record) {
            Err(problem) if options.skip_bad_rows && problem.may_be_skipped() => {
                rows.skipped += 1;
                rows.first_skipped.get_or_insert((offset(&record), problem));
            }
            Err(problem) => return Err(rows.diagnostic(offset(&record), &problem)),
            Ok(()) => {}
        }
    }
    rows.finish()
}

fn broken(path: &Path, error: csv::Error) -> Diagnostic {
    match error.into_kind() {
        csv::ErrorKind::Io(error) => unreadable(path, &error),
        other => Diagnostic::new(format!("cannot read the table: {other:?}")).in_file(path),
    }
}

/// Byte of a row, from the end of the header.
fn offset(record: &ByteRecord) -> u64 {
    record.position().map_or(0, csv::Position::byte)
}

/// What is wrong with a row.
#[derive(Clone, Debug, PartialEq)]
enum Problem {
    Ragged { found: usize },
    Text { slot: usize, value: String },
    Missing { slot: usize, value: String },
    Backward { time_s: f64 },
}

impl Problem {
    fn may_be_skipped(&self) -> bool {
        matches!(self, Problem::Ragged { .. } | Problem::Missing { .. })
    }
}

/// The channels while they grow, and what has been noticed.
struct Rows<'a> {
    path: &'a Path,
    preamble: &'a Preamble,
    placed: [Placed; 3],
    /// Index and position in `log.extra` of the further columns.
    further: Vec<usize>,
    text_cells: Vec<usize>,
    log: Log,
    skipped: usize,
    first_skipped: Option<(u64, Problem)>,
    repeated: usize,
    first_repeated: Option<(u64, f64)>,
    decimal_commas: bool,
}

impl<'a> Rows<'a> {
    fn new(path: &'a Path, preamble: &'a Preamble, placed: [Placed; 3]) -> Self {
        let further: Vec<usize> = (0..preamble.names.len())
            .filter(|index| placed.iter().all(|p| p.index != *index))
            .filter(|index| !preamble.names[*index].is_empty())
            .collect();
        let extra = further.iter().map(|index| ExtraColumn {
            name: preamble.names[*index].clone(),
            values: Vec::new(),
        });
        Rows {
            path,
            preamble,
            placed,
            log: Log {
                path: path.to_path_buf(),
                extra: extra.collect(),
                ..Log::default()
            },
            text_cells: vec![0; further.len()],
            further,
            skipped: 0,
            first_skipped: None,
            repeated: 0,
            first_repeated: None,
            decimal_commas: false,
        }
    }

    fn take(&mut self, record: &ByteRecord) -> Result<(), Problem> {
        let names = self.preamble.names.len();
        // Some loggers end every row, but not the header, with a delimiter.
        let closed = record.len() == names + 1 && record[names].is_empty();
        if record.len() != names && !closed {
            return Err(Problem::Ragged {
                found: record.len(),
            });
        }
        let mut values = [0.0; 3];
        for (slot, placed) in self.placed.iter().enumerate() {
            let cell = &record[placed.index];
            let value = || String::from_utf8_lossy(cell).trim().to_string();
            values[slot] = match number(cell, self.preamble.delimiter, &mut self.decimal_commas) {
                Cell::Number(number) => number * placed.factor,
                Cell::Missing => {
                    return Err(Problem::Missing {
                        slot,
                        value: value(),
                    });
                }
                Cell::Text => {
                    return Err(Problem::Text {
                        slot,
                        value: value(),
                    });
                }
            };
        }
        let [time_s, position_m, force_n] = values;
        match self.log.time_s.last() {
            Some(last) if time_s < *last => return Err(Problem::Backward { time_s }),
            Some(last) if time_s == *last => {
                self.first_repeated.get_or_insert((offset(record), time_s));
                self.repeated += 1;
                return Ok(());
            }
            _ => {}
        }
        self.log.time_s.push(time_s);
        self.log.position_m.push(position_m);
        self.log.force_n.push(force_n);
        self.take_further(record);
        Ok(())
    }

    fn take_further(&mut self, record: &ByteRecord) {
        for (slot, index) in self.further.iter().enumerate() {
            let cell = &record[*index];
            let value = match number(cell, self.preamble.delimiter, &mut self.decimal_commas) {
                Cell::Number(value) => value,
                Cell::Missing => f64::NAN,
                Cell::Text => {
                    self.text_cells[slot] += 1;
                    f64::NAN
                }
            };
            self.log.extra[slot].values.push(value);
        }
    }

    fn finish(mut self) -> Result<Log, Diagnostic> {
        let rows = self.log.len() + self.skipped + self.repeated;
        if rows == 0 {
            return Err(
                Diagnostic::new("there is a header, but no row of numbers below it")
                    .in_file(self.path)
                    .at_line(self.preamble.header_line)
                    .excerpt(self.preamble.header_text.clone(), 0..0)
                    .remedy("record again: the file was closed before the first sample"),
            );
        }
        if self.skipped as f64 > MOST_LEFT_OUT * rows as f64 {
            return Err(self.too_many_bad_rows(rows));
        }
        if self.repeated as f64 > MOST_LEFT_OUT * rows as f64 {
            return Err(self.too_coarse_clock(rows));
        }
        if self.log.len() < FEWEST_SAMPLES {
            return Err(Diagnostic::new(format!(
                "the log has {} samples, fewer than {FEWEST_SAMPLES}",
                self.log.len()
            ))
            .in_file(self.path)
            .remedy("record longer: a touch at 1 kHz takes a few hundred samples"));
        }
        self.write_notes();
        Ok(self.log)
    }

    fn too_many_bad_rows(&self, rows: usize) -> Diagnostic {
        let Some((offset, problem)) = &self.first_skipped else {
            unreachable!("a skipped row is remembered");
        };
        let mut diagnostic = self.diagnostic(*offset, problem);
        diagnostic.what = format!(
            "{} of {rows} rows are unusable, more than 20 %; the first: {}",
            self.skipped, diagnostic.what
        );
        diagnostic.remedy("repair the recording: what is left would not stand for it")
    }

    fn too_coarse_clock(&self, rows: usize) -> Diagnostic {
        let (offset, time_s) = self.first_repeated.unwrap_or_default();
        let mut diagnostic = Diagnostic::new(format!(
            "{} of {rows} time stamps repeat the one before",
            self.repeated
        ))
        .in_file(self.path)
        .in_column(self.name(0))
        .value(time_s)
        .note("that is the first one that repeats; more than 20 % do")
        .remedy("record the time with more digits than the sampling period has");
        if let Some((line, text)) = self.locate(offset) {
            let cell = self.cell(0, &text);
            diagnostic = diagnostic.at_line(line).excerpt(text, cell);
        }
        diagnostic
    }

    fn write_notes(&mut self) {
        if let Some((offset, _)) = self.first_skipped {
            let place = self.locate(offset).map_or(String::new(), |(line, _)| {
                format!(", the first at line {line}")
            });
            let note = format!("{} bad rows left out{place}", self.skipped);
            self.log.notes.push(note);
        }
        if let Some((_, first_s)) = self.first_repeated {
            self.log.notes.push(format!(
                "{} samples left out whose time stamp repeats the one before, the first at {first_s} s",
                self.repeated
            ));
        }
        if self.decimal_commas {
            self.log
                .notes
                .push("commas inside numbers read as decimal points".to_string());
        }
        for (column, cells) in self.log.extra.iter().zip(&self.text_cells) {
            if *cells > 0 {
                self.log.notes.push(format!(
                    "column `{}` holds text in {cells} rows: read as missing",
                    column.name
                ));
            }
        }
    }

    fn name(&self, slot: usize) -> &str {
        &self.preamble.names[self.placed[slot].index]
    }

    fn locate(&self, offset: u64) -> Option<(usize, String)> {
        line_at(self.path, offset + self.preamble.data_offset as u64)
    }

    fn diagnostic(&self, offset: u64, problem: &Problem) -> Diagnostic {
        let located = self.locate(offset);
        let text = located.as_ref().map_or("", |(_, text)| text.as_str());
        let diagnostic = match problem {
            Problem::Ragged { found } => self.ragged(*found, text),
            Problem::Text { slot, value } => self.text(*slot, text, value),
            Problem::Missing { slot, value } => self.missing(*slot, text, value),
            Problem::Backward { time_s } => self.backward(*time_s, text),
        };
        match located {
            Some((line, _)) => diagnostic.at_line(line).in_file(self.path),
            None => diagnostic.in_file(self.path),
        }
    }

    fn in_cell(&self, slot: usize, text: &str, value: &str) -> Diagnostic {
        Diagnostic::new("text where a number should be")
            .in_column(self.name(slot))
            .excerpt(text, self.cell(slot, text))
            .value(value)
    }

    fn text(&self, slot: usize, text: &str, value: &str) -> Diagnostic {
        let quantity = Channel::ALL[slot].quantity();
        let remedy = if self.log.is_empty() {
            format!("write the {quantity}; if this is a row of units, remove it")
        } else {
            format!("write the {quantity}, or leave the row out")
        };
        self.in_cell(slot, text, value).remedy(remedy)
    }

    fn missing(&self, slot: usize, text: &str, value: &str) -> Diagnostic {
        let mut diagnostic = self.in_cell(slot, text, value);
        diagnostic.what = if value.is_empty() {
            "no value where a number should be"
        } else {
            "a value that is not finite"
        }
        .to_string();
        diagnostic.remedy("--skip-bad-rows leaves such rows out, counts them and says so")
    }

    fn ragged(&self, found: usize, text: &str) -> Diagnostic {
        let wanted = self.preamble.names.len();
        let remedy = match found == 2 * wanted && self.preamble.delimiter == b',' {
            true => "decimal commas need semicolons or tabs between the columns",
            false => {
                "complete the row; --skip-bad-rows leaves such rows out, counts them and says so"
            }
        };
        Diagnostic::new(format!(
            "{found} values in a row, {wanted} names in the header"
        ))
        .excerpt(text, 0..text.len())
        .value(found)
        .remedy(remedy)
    }

    fn backward(&self, time_s: f64, text: &str) -> Diagnostic {
        let last = self.log.time_s.last().copied().unwrap_or(time_s);
        let first = self.log.time_s.first().copied().unwrap_or(time_s);
        let remedy = if time_s <= first + 0.01 * (last - first) {
            "a second recording seems to begin here: split the file at this line"
        } else {
            "sort the rows by time, or split the file at this line"
        };
        Diagnostic::new(format!("time runs backward, from {last} s to {time_s} s"))
            .in_column(self.name(0))
            .excerpt(text, self.cell(0, text))
            .value(time_s)
            .note(format!("the sample before is at {last} s"))
            .remedy(remedy)
    }

    /// Where in the line the channel's cell stands; a guess if the line holds quotes.
    fn cell(&self, slot: usize, text: &str) -> Range<usize> {
        let mut from = 0;
        for (index, cell) in text.split(char::from(self.preamble.delimiter)).enumerate() {
            if index == self.placed[slot].index {
                let lead = cell.len() - cell.trim_start().len();
                return from + lead..(from + lead + cell.trim().len()).max(from + lead + 1);
            }
            from += cell.len() + 1;
        }
        0..0
    }
}

#[cfg(test)]
mod tests;
