//! From rows to recordings: what was left out, stamps that repeat, and what is said about it.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use super::rows::Rows;
use crate::diagnostic::Diagnostic;
use crate::log::arrival::Arrival;
use crate::log::record::{ExtraColumn, FEWEST_SAMPLES, Log};
use crate::number::counted;

/// Largest share of rows that may be left out, or of stamps that may repeat: beyond it the rest no
/// longer stands for the measurement.
const MOST_LEFT_OUT: f64 = 0.2;

impl Rows<'_> {
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
            self.even_stamps(log)?;
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
        let labels: BTreeSet<&str> = self
            .starts
            .iter()
            .map(|(_, label)| label.as_str())
            .collect();
        // A label that comes twice names nothing.
        let is_labelled = labels.len() == self.starts.len() && !labels.contains("");
        for (number, (start, label)) in self.starts.iter().enumerate().rev() {
            let label = match is_labelled {
                true => label.clone(),
                false => (number + 1).to_string(),
            };
            let path = match is_one {
                true => self.table.path.to_path_buf(),
                false => labelled(self.table.path, &label),
            };
            let extra = self.log.extra.iter_mut().map(|column| ExtraColumn {
                name: column.name.clone(),
                values: column.values.split_off(*start),
            });
            // A channel that has grown holds up to twice what it needs.
            let own = |channel: &mut Vec<f64>| {
                let mut own = channel.split_off(*start);
                own.shrink_to_fit();
                own
            };
            logs.push(Log {
                path,
                kind: self.log.kind,
                extra: extra.collect(),
                time_s: own(&mut self.log.time_s),
                position_m: own(&mut self.log.position_m),
                force_n: own(&mut self.log.force_n),
                source: self.log.source.clone(),
                notes: Vec::new(),
            });
        }
        logs.reverse();
        logs
    }

    /// Stamps that are coarser than the sampling, or those of an arrival, give way to even ones.
    fn even_stamps(&self, log: &mut Log) -> Result<(), Diagnostic> {
        let repeats = repeats(log);
        let is_coarse = many(repeats, log) && !log.repeats_are_copies();
        if let Some(note) = is_coarse.then(|| log.spread_evenly()).flatten() {
            log.notes.push(note);
            return Ok(());
        }
        match log.take_arrivals_as_even() {
            Arrival::Even(note) => {
                log.notes.push(note);
                Ok(())
            }
            _ if is_coarse => Err(self.too_coarse_clock(repeats, log.len())),
            Arrival::Uncertain { rate_hz, what, why } => {
                Err(self.stamped_on_arrival(rate_hz, what, why))
            }
            Arrival::No => {
                leave_out_repeats(log, repeats);
                Ok(())
            }
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
        diagnostic.remedy("repair the recording: too little of it is left")
    }

    fn stamped_on_arrival(&self, rate_hz: f64, what: String, why: String) -> Diagnostic {
        Diagnostic::new(what)
            .in_file(self.table.path)
            .in_column(self.table.name(0))
            .note(why)
            .remedy(format!(
                "if the sampling was even and nothing is missing, give its rate: --rate {} is what the rows \
                 over the time make; else record the time at which each sample was taken",
                rounded(rate_hz)
            ))
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
            notes.push(format!(
                "{} left out{place}",
                counted(self.skipped, "bad row")
            ));
        }
        if let Some((offset, _, count)) = &self.summary {
            let text = line(*offset).map_or(String::new(), |(line, text)| {
                format!(
                    " from line {line} on (`{}`)",
                    text.chars().take(40).collect::<String>()
                )
            });
            notes.push(format!(
                "{} below the table left out{text}: a summary",
                counted(*count, "row")
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

/// How many stamps repeat the one before.
fn repeats(log: &Log) -> usize {
    let pairs = log.time_s.windows(2);
    pairs.filter(|pair| pair[0] == pair[1]).count()
}

fn many(repeats: usize, log: &Log) -> bool {
    repeats as f64 > MOST_LEFT_OUT * log.len() as f64
}

/// Leaves out the samples whose stamps repeat, few or copies, and says so.
fn leave_out_repeats(log: &mut Log, repeats: usize) {
    if repeats == 0 {
        return;
    }
    let mut pairs = log.time_s.windows(2);
    let first_s = pairs.find(|pair| pair[0] == pair[1]);
    let first_s = first_s.map_or(0.0, |pair| pair[0]);
    let note = match many(repeats, log) {
        false => format!(
            "{} left out whose time stamp repeats the one before, the first at {first_s} s",
            counted(repeats, "sample")
        ),
        // Rows that were written twice are no clock that is too coarse.
        true => format!(
            "{} left out: stamp, position and force repeat those of the row before",
            counted(repeats, "row")
        ),
    };
    log.leave_out_repeated();
    log.notes.push(note);
}

/// A rate (Hz) with the digits that a clock of bunches has.
fn rounded(rate_hz: f64) -> f64 {
    (rate_hz * 10.0).round() / 10.0
}

/// A name for a recording within a file.
fn labelled(path: &Path, label: &str) -> PathBuf {
    let plain = |c: char| {
        if c.is_alphanumeric() || "-_.".contains(c) {
            c
        } else {
            '_'
        }
    };
    let label: String = label.chars().map(plain).collect();
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!("{name}#{label}"))
}
