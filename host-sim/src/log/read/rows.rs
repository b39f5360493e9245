//! Rows into channels.

use csv::ByteRecord;

use super::parts::{Separator, Separators};
use super::problem::{Problem, Table};
use crate::diagnostic::Diagnostic;
use crate::log::cell::{Cell, number};
use crate::log::channel::Channel;
use crate::log::columns::kind_of;
use crate::log::fields::is_comment;
use crate::log::origin::SourceColumns;
use crate::log::record::{ExtraColumn, FEWEST_SAMPLES, Log};
use crate::log::stamp;
use crate::stats::median;

/// Rows that may stand below a table as its summary.
const MOST_SUMMARY_ROWS: usize = 60;
/// Stamps that begin later than this count from something far away, such as 1970 (s).
const FAR_AWAY_S: f64 = 1e8;
/// Time that falls back to within this share of a part's length to its beginning begins again.
const AGAIN: f64 = 0.01;

/// The channels while they grow, and what has been noticed.
pub(super) struct Rows<'a> {
    pub(super) table: &'a Table<'a>,
    separators: &'a Separators,
    rate_hz: Option<f64>,
    has_stamps: bool,
    /// Indices of the further columns.
    further: Vec<usize>,
    pub(super) text_cells: Vec<usize>,
    /// All recordings, one after the other.
    pub(super) log: Log,
    /// Where each recording begins, and what the column of traces says there.
    pub(super) starts: Vec<(usize, String)>,
    /// Where the present part begins, what its time began at, and what is added to its stamps.
    part: Part,
    last_segment: Vec<u8>,
    last_trace: Vec<u8>,
    /// What all stamps count from (s).
    origin_s: Option<f64>,
    pub(super) segments: usize,
    /// Rows that may be a summary: the first with its problem, and how many.
    pub(super) summary: Option<(u64, Problem, usize)>,
    pub(super) skipped: usize,
    pub(super) first_skipped: Option<(u64, Problem)>,
    pub(super) first_repeated: Option<(u64, f64)>,
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

/// Whether a row holds nothing but delimiters.
fn is_blank(record: &ByteRecord) -> bool {
    record.iter().all(|cell| cell.trim_ascii().is_empty())
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
                kind: kind_of(&table.placed),
                source: SourceColumns::of(table.header(), &table.placed),
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
        if record.get(0).is_none_or(is_comment) || is_blank(record) || self.is_header(record) {
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
}
