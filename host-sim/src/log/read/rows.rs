//! Rows into channels.

use csv::ByteRecord;

use super::parts::{Separator, Separators};
use super::problem::{Problem, Table};
use crate::diagnostic::Diagnostic;
use crate::log::cell::{Cell, number};
use crate::log::channel::Channel;
use crate::log::preamble::is_comment;
use crate::log::record::{ExtraColumn, FEWEST_SAMPLES, Log};
use crate::log::stamp;
use crate::stats::median;

/// Largest share of rows that may be left out, or of stamps that may repeat: beyond it the rest no
/// longer stands for the measurement.
const MOST_LEFT_OUT: f64 = 0.2;
/// Rows that may stand below a table as its summary.
const MOST_SUMMARY_ROWS: usize = 60;
/// Stamps that begin later than this count from something far away, such as 1970 (s).
const FAR_AWAY_S: f64 = 1e8;
/// Time that falls back to within this share of a part's length to its beginning begins again.
const AGAIN: f64 = 0.01;

/// The channels while they grow, and what has been noticed.
pub(super) struct Rows<'a> {
    table: &'a Table<'a>,
    separators: &'a Separators,
    rate_hz: Option<f64>,
    has_stamps: bool,
    /// Indices of the further columns.
    further: Vec<usize>,
    text_cells: Vec<usize>,
    /// All recordings, one after the other.
    log: Log,
    /// Where each recording begins, and what the column of traces says there.
    starts: Vec<(usize, String)>,
    /// Where the present part begins, what its time began at, and what is added to its stamps.
    part: Part,
    last_segment: Vec<u8>,
    last_trace: Vec<u8>,
    /// What all stamps count from (s).
    origin_s: Option<f64>,
    segments: usize,
    /// Rows that may be a summary: the first with its problem, and how many.
    summary: Option<(u64, Problem, usize)>,
    skipped: usize,
    first_skipped: Option<(u64, Problem)>,
    first_repeated: Option<(u64, f64)>,
    headers: usize,
}

#[derive(Clone, Copy, Debug, Default)]
struct Part {
    index: usize,
    first_s: f64,
    shift_s: f64,
}

/// What a row begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Begin {
    Nothing,
    Segment,
    Recording,
}

/// Byte of a row, from the end of the header.
fn offset(record: &ByteRecord) -> u64 {
    record.position().map_or(0, csv::Position::byte)
}

impl<'a> Rows<'a> {
    pub(super) fn new(
        table: &'a Table<'a>,
        separators: &'a Separators,
        rate_hz: Option<f64>,
    ) -> Self {
        let names = &table.preamble.names;
        let further: Vec<usize> = (0..names.len())
            .filter(|index| table.placed.iter().flatten().all(|p| p.index != *index))
            .filter(|index| !names[*index].is_empty())
            .collect();
        let extra = further.iter().map(|index| ExtraColumn {
            name: names[*index].clone(),
            values: Vec::new(),
        });
        let time = table.placed[0].map(|placed| placed.index);
        let stamps = table.preamble.sample.iter();
        let stamps = stamps.filter_map(|row| row.get(time?)).take(3);
        Rows {
            table,
            separators,
            rate_hz,
            has_stamps: stamps.clone().count() > 0
                && stamps.clone().all(|cell| stamp::seconds(cell).is_some()),
            log: Log {
                path: table.path.to_path_buf(),
                extra: extra.collect(),
                ..Log::default()
            },
            text_cells: vec![0; further.len()],
            further,
            starts: Vec::new(),
            part: Part::default(),
            last_segment: Vec::new(),
            last_trace: Vec::new(),
            origin_s: None,
            segments: 1,
            summary: None,
            skipped: 0,
            first_skipped: None,
            first_repeated: None,
            headers: 0,
        }
    }

    /// Takes a row.
    pub(super) fn take(&mut self, record: &ByteRecord) -> Result<(), Diagnostic> {
        if is_comment(&record[0]) || self.is_header(record) {
            return Ok(());
        }
        let taken = self.push(record);
        if let Some((at, problem, count)) = &mut self.summary {
            *count += 1;
            // Numbers that go on below show that the row was a mistake.
            if taken.is_ok() || *count > MOST_SUMMARY_ROWS {
                return Err(self.table.diagnostic(*at, problem));
            }
            return Ok(());
        }
        let Err(problem) = taken else { return Ok(()) };
        if self.may_be_summary(record) {
            self.summary = Some((offset(record), problem, 1));
        } else if self.table.skips_bad_rows && problem.may_be_skipped() {
            self.skipped += 1;
            self.first_skipped.get_or_insert((offset(record), problem));
        } else {
            return Err(self.table.diagnostic(offset(record), &problem));
        }
        Ok(())
    }

    /// Whether a row is the header or the row of units again, as files in parts have it.
    fn is_header(&mut self, record: &ByteRecord) -> bool {
        let same = |cells: &[String]| {
            let mut both = cells.iter().zip(record.iter());
            !cells.is_empty() && both.all(|(name, cell)| name.as_bytes() == cell.trim_ascii())
        };
        let is_header = same(&self.table.preamble.names);
        self.headers += usize::from(is_header);
        is_header || same(&self.table.preamble.units)
    }

    /// Whether a row may stand below the table: after numbers, with text in its first cell or with none.
    fn may_be_summary(&self, record: &ByteRecord) -> bool {
        let first = record.iter().find(|cell| !cell.trim_ascii().is_empty());
        let is_text = first.is_none_or(|cell| {
            matches!(number(cell, self.table.preamble.format), Cell::Text)
                && stamp::seconds(&String::from_utf8_lossy(cell)).is_none()
        });
        is_text && self.log.len() >= FEWEST_SAMPLES
    }

    fn push(&mut self, record: &ByteRecord) -> Result<(), Problem> {
        let names = self.table.preamble.names.len();
        // Some loggers end every row, but not the header, with a delimiter.
        let closed = record.len() == names + 1 && record[names].trim_ascii().is_empty();
        if record.len() != names && !closed {
            return Err(Problem::Ragged {
                found: record.len(),
            });
        }
        let mut values = [0.0; 3];
        for (slot, value) in values.iter_mut().enumerate() {
            *value = self.value(record, slot)?;
        }
        let time_s = self.placed_in_time(record, values[0])?;
        self.log.time_s.push(time_s);
        self.log.position_m.push(values[1]);
        self.log.force_n.push(values[2]);
        self.push_further(record);
        Ok(())
    }

    fn value(&self, record: &ByteRecord, slot: usize) -> Result<f64, Problem> {
        let Some(placed) = self.table.placed[slot] else {
            let in_part = self.log.len() - self.part.index;
            return Ok(self.rate_hz.map_or(0.0, |rate_hz| in_part as f64 / rate_hz));
        };
        let cell = &record[placed.index];
        let value = || String::from_utf8_lossy(cell).trim().to_string();
        if slot == Channel::Time as usize && self.has_stamps {
            let is_first = self.log.is_empty();
            return stamp::seconds(&value()).ok_or_else(|| match cell.trim_ascii().is_empty() {
                true => Problem::Missing {
                    slot,
                    value: value(),
                },
                false => Problem::Text {
                    slot,
                    value: value(),
                    is_first,
                },
            });
        }
        match number(cell, self.table.preamble.format) {
            Cell::Number(number) => Ok(number * placed.factor),
            Cell::Missing => Err(Problem::Missing {
                slot,
                value: value(),
            }),
            Cell::Text => Err(Problem::Text {
                slot,
                value: value(),
                is_first: self.log.is_empty(),
            }),
        }
    }

    /// The time of a row in its recording (s).
    fn placed_in_time(&mut self, record: &ByteRecord, given_s: f64) -> Result<f64, Problem> {
        let is_far = self.has_stamps || given_s.abs() > FAR_AWAY_S;
        let origin_s = *self
            .origin_s
            .get_or_insert(if is_far { given_s } else { 0.0 });
        let stamp_s = given_s - origin_s;
        let Some(last_s) = self.log.time_s.last().copied() else {
            self.begin(record, Begin::Recording, stamp_s);
            return Ok(stamp_s);
        };
        let time_s = stamp_s + self.part.shift_s;
        let begins = self.begins(record, time_s, last_s)?;
        if begins != Begin::Nothing {
            self.begin(record, begins, stamp_s);
            return Ok(stamp_s + self.part.shift_s);
        }
        if time_s == last_s {
            self.first_repeated.get_or_insert((offset(record), time_s));
        }
        self.remember(record);
        Ok(time_s)
    }

    fn begins(&self, record: &ByteRecord, time_s: f64, last_s: f64) -> Result<Begin, Problem> {
        let changed = |separator: Separator, last: &[u8]| {
            separator
                .column()
                .is_some_and(|index| record.get(index) != Some(last))
        };
        let trace = changed(self.separators.trace, &self.last_trace);
        let segment = changed(self.separators.segment, &self.last_segment);
        match (self.separators.trace, self.separators.segment) {
            (Separator::Column(_), _) if trace => return Ok(Begin::Recording),
            (_, Separator::Column(_)) if segment => return Ok(Begin::Segment),
            _ if time_s >= last_s => return Ok(Begin::Nothing),
            _ => {}
        }
        let first_s = self.part.first_s + self.part.shift_s;
        if time_s > first_s + AGAIN * (last_s - first_s) {
            return Err(Problem::Backward { time_s, last_s });
        }
        match (self.separators.trace, self.separators.segment) {
            (Separator::Time, _) => Ok(Begin::Recording),
            (_, Separator::Time) => Ok(Begin::Segment),
            (Separator::Likely(_), _) if trace => Ok(Begin::Recording),
            (_, Separator::Likely(_)) if segment => Ok(Begin::Segment),
            _ => Err(Problem::Restart { time_s, last_s }),
        }
    }

    fn begin(&mut self, record: &ByteRecord, what: Begin, stamp_s: f64) {
        self.remember(record);
        let count = self.log.len();
        if what == Begin::Recording {
            let label = String::from_utf8_lossy(&self.last_trace).trim().to_string();
            self.starts.push((count, label));
            self.part = Part {
                index: count,
                first_s: stamp_s,
                shift_s: 0.0,
            };
            return;
        }
        self.segments += 1;
        let last_s = self.log.time_s.last().copied().unwrap_or(stamp_s);
        // A part whose time runs on stays where it is.
        let goes_on = stamp_s + self.part.shift_s > last_s;
        let shift_s = match goes_on {
            true => self.part.shift_s,
            false => last_s + self.period_s() - stamp_s,
        };
        self.part = Part {
            index: count,
            first_s: stamp_s,
            shift_s,
        };
    }

    /// The usual interval of the present part (s).
    fn period_s(&self) -> f64 {
        let part = &self.log.time_s[self.part.index..];
        median(part.windows(2).map(|pair| pair[1] - pair[0]))
    }

    fn remember(&mut self, record: &ByteRecord) {
        let kept = [
            (self.separators.segment.column(), &mut self.last_segment),
            (self.separators.trace.column(), &mut self.last_trace),
        ];
        for (column, last) in kept {
            if let Some(cell) = column.and_then(|index| record.get(index)) {
                last.clear();
                last.extend_from_slice(cell);
            }
        }
    }

    fn push_further(&mut self, record: &ByteRecord) {
        for (slot, index) in self.further.iter().enumerate() {
            let value = match number(&record[*index], self.table.preamble.format) {
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

    /// The recordings of the file.
    pub(super) fn finish(mut self) -> Result<Vec<Log>, Diagnostic> {
        let rows = self.log.len() + self.skipped;
        if rows == 0 {
            let preamble = self.table.preamble;
            let message = "there is a header, but no row of numbers below it";
            return Err(Diagnostic::new(message)
                .in_file(self.table.path)
                .at_line(preamble.header_line)
                .excerpt(preamble.header_text.clone(), 0..0)
                .remedy("record again: the file was closed before the first sample"));
        }
        if self.skipped as f64 > MOST_LEFT_OUT * rows as f64 {
            return Err(self.too_many_bad_rows(rows));
        }
        let notes = self.notes();
        let mut logs = self.recordings();
        for log in &mut logs {
            log.notes.extend(notes.iter().cloned());
            self.spread_stamps(log)?;
            if log.len() < FEWEST_SAMPLES {
                return Err(Diagnostic::new(format!(
                    "the log has {} samples, fewer than {FEWEST_SAMPLES}",
                    log.len()
                ))
                .in_file(&log.path)
                .remedy("record longer: a touch at 1 kHz takes a few hundred samples"));
            }
        }
        Ok(logs)
    }

    /// The rows of each recording as a log of its own, in order.
    fn recordings(&mut self) -> Vec<Log> {
        let mut logs = Vec::new();
        let is_one = self.starts.len() == 1;
        for (number, (start, label)) in self.starts.iter().enumerate().rev() {
            let path = match is_one {
                true => self.table.path.to_path_buf(),
                false => numbered(self.table.path, number + 1, label),
            };
            let extra = self.log.extra.iter_mut().map(|column| ExtraColumn {
                name: column.name.clone(),
                values: column.values.split_off(*start),
            });
            logs.push(Log {
                path,
                extra: extra.collect(),
                time_s: self.log.time_s.split_off(*start),
                position_m: self.log.position_m.split_off(*start),
                force_n: self.log.force_n.split_off(*start),
                notes: Vec::new(),
            });
        }
        logs.reverse();
        logs
    }

    /// Stamps that repeat: few are left out; many that do so evenly are coarser than the sampling, and the line
    /// through them takes their place.
    fn spread_stamps(&self, log: &mut Log) -> Result<(), Diagnostic> {
        let repeats = log
            .time_s
            .windows(2)
            .filter(|pair| pair[0] == pair[1])
            .count();
        if repeats == 0 {
            return Ok(());
        }
        if repeats as f64 <= MOST_LEFT_OUT * log.len() as f64 {
            let first_s = log
                .time_s
                .windows(2)
                .find(|pair| pair[0] == pair[1])
                .map_or(0.0, |pair| pair[0]);
            log.leave_out_repeated();
            log.notes.push(format!(
                "{repeats} samples left out whose time stamp repeats the one before, the first at {first_s} s"
            ));
            return Ok(());
        }
        match log.spread_evenly() {
            Some(note) => {
                log.notes.push(note);
                Ok(())
            }
            None => Err(self.too_coarse_clock(repeats, log.len())),
        }
    }

    fn too_many_bad_rows(&self, rows: usize) -> Diagnostic {
        let Some((offset, problem)) = &self.first_skipped else {
            unreachable!("a skipped row is remembered");
        };
        let mut diagnostic = self.table.diagnostic(*offset, problem);
        diagnostic.what = format!(
            "{} of {rows} rows are unusable, more than 20 %; the first: {}",
            self.skipped, diagnostic.what
        );
        diagnostic.remedy("repair the recording: what is left would not stand for it")
    }

    fn too_coarse_clock(&self, repeats: usize, rows: usize) -> Diagnostic {
        let (offset, time_s) = self.first_repeated.unwrap_or_default();
        let mut diagnostic = Diagnostic::new(format!(
            "{repeats} of {rows} time stamps repeat the one before, and not evenly"
        ))
        .in_file(self.table.path)
        .in_column(self.table.name(0))
        .value(time_s)
        .note("that is the first one that repeats; more than 20 % do")
        .remedy(
            "if the sampling was even, give its rate: --rate HZ; else record the time with more digits \
             than the sampling period has",
        );
        if let Some((line, text)) = self.table.locate(offset) {
            let cell = self.table.cell(0, &text);
            diagnostic = diagnostic.at_line(line).excerpt(text, cell);
        }
        diagnostic
    }

    /// What was left out, and how the parts were put together.
    fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        let line = |offset: u64| self.table.locate(offset);
        if let Some((offset, _)) = self.first_skipped {
            let place = line(offset).map_or(String::new(), |(line, _)| {
                format!(", the first at line {line}")
            });
            notes.push(format!("{} bad rows left out{place}", self.skipped));
        }
        if let Some((offset, _, count)) = &self.summary {
            let text = line(*offset).map_or(String::new(), |(line, text)| {
                format!(
                    " from line {line} on (`{}`)",
                    text.chars().take(40).collect::<String>()
                )
            });
            notes.push(format!(
                "{count} rows below the table left out{text}: a summary"
            ));
        }
        if self.segments > 1 {
            notes.push(format!(
                "{} segments put one after the other",
                self.segments
            ));
        }
        for (column, cells) in self.log.extra.iter().zip(&self.text_cells) {
            if *cells > 0 {
                notes.push(format!(
                    "column `{}` holds text in {cells} rows: read as missing",
                    column.name
                ));
            }
        }
        notes
    }
}

/// A name for a recording within a file.
fn numbered(path: &std::path::Path, number: usize, label: &str) -> std::path::PathBuf {
    let label: String = match label.is_empty() {
        true => number.to_string(),
        false => label
            .chars()
            .map(|c| {
                if c.is_alphanumeric() || "-_.".contains(c) {
                    c
                } else {
                    '_'
                }
            })
            .collect(),
    };
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!("{name}#{label}"))
}
