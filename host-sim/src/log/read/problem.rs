//! What is wrong with a row, and how it is said.

use std::ops::Range;
use std::path::Path;

use crate::diagnostic::Diagnostic;
use crate::kind::Kind;
use crate::log::channel::{Channel, Header, Placed};
use crate::log::fields::split;
use crate::log::origin::SourceColumns;
use crate::log::preamble::Preamble;
use crate::log::source::line_at;

/// What is wrong with a row.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Problem {
    Ragged {
        found: usize,
    },
    Text {
        slot: usize,
        value: String,
        is_first: bool,
    },
    Missing {
        slot: usize,
        value: String,
    },
    Backward {
        time_s: f64,
        last_s: f64,
    },
    /// Time begins again, and nothing says whether a new recording does.
    Restart {
        time_s: f64,
        last_s: f64,
    },
}

impl Problem {
    pub(super) fn may_be_skipped(&self) -> bool {
        matches!(self, Problem::Ragged { .. } | Problem::Missing { .. })
    }
}

/// A table that is being read.
#[derive(Clone, Copy, Debug)]
pub(super) struct Table<'a> {
    pub(super) path: &'a Path,
    pub(super) preamble: &'a Preamble,
    pub(super) placed: [Option<Placed>; 3],
    pub(super) skips_bad_rows: bool,
}

impl Table<'_> {
    /// What is known of the columns.
    pub(super) fn header(&self) -> Header<'_> {
        Header {
            names: &self.preamble.names,
            units: &self.preamble.units,
            sample: &self.preamble.sample,
        }
    }

    /// The name of a channel's column.
    pub(super) fn name(&self, slot: usize) -> &str {
        let index = self.placed[slot].map(|placed| placed.index);
        index.map_or("", |index| self.preamble.names[index].as_str())
    }

    /// Line and text of the row at a byte of the table.
    pub(super) fn locate(&self, offset: u64) -> Option<(usize, String)> {
        let begin = (self.preamble.data_offset, self.preamble.data_line);
        line_at(self.path, begin, self.preamble.delimiter, offset)
    }

    /// What is wrong with the row at a byte of the table.
    pub(super) fn diagnostic(&self, offset: u64, problem: &Problem) -> Diagnostic {
        let located = self.locate(offset);
        let text = located.as_ref().map_or("", |(_, text)| text.as_str());
        let diagnostic = match problem {
            Problem::Ragged { found } => self.ragged(*found, text),
            Problem::Text {
                slot,
                value,
                is_first,
            } => self.text(*slot, text, value, *is_first),
            Problem::Missing { slot, value } => self.missing(*slot, text, value),
            Problem::Backward { time_s, last_s } => self
                .backward(*time_s, *last_s, text)
                .remedy("sort the rows by time, or split the file at this line"),
            Problem::Restart { time_s, last_s } => self.restart(*time_s, *last_s, text),
        };
        match located {
            Some((line, _)) => diagnostic.at_line(line).in_file(self.path),
            None => diagnostic.in_file(self.path),
        }
    }

    /// The force falls on the way in, and nothing tells which channel counts the other way.
    pub(super) fn which_sign(&self) -> Diagnostic {
        let source = SourceColumns::of(self.header(), &self.placed)
            .unwrap_or_else(|| SourceColumns::own(Kind::Linear));
        let with = |channel: Channel, times: f64| source.option(&[(channel, times)]);
        let force = self.name(2);
        Diagnostic::new("the force falls on the way in: the sign of one of the two is reversed")
            .in_column(force)
            .note("the position must grow into the material and the force push the probe out")
            .remedy(format!(
                "say which: {} or {}; if nothing is touched and both are right, {}",
                with(Channel::Position, -1.0),
                with(Channel::Force, -1.0),
                with(Channel::Force, 1.0)
            ))
    }

    fn in_cell(&self, slot: usize, text: &str, value: &str) -> Diagnostic {
        Diagnostic::new("text where a number should be")
            .in_column(self.name(slot))
            .excerpt(text, self.cell(slot, text))
            .value(value)
    }

    fn text(&self, slot: usize, text: &str, value: &str, is_first: bool) -> Diagnostic {
        let quantity = Channel::ALL[slot].quantity();
        let remedy = match is_first {
            true => format!("write the {quantity}; if this is a row of units, remove it"),
            false => format!("write the {quantity}, or leave the row out"),
        };
        self.in_cell(slot, text, value).remedy(remedy)
    }

    fn missing(&self, slot: usize, text: &str, value: &str) -> Diagnostic {
        let mut diagnostic = self.in_cell(slot, text, value);
        diagnostic.what = match value.parse::<f64>() {
            _ if value.is_empty() => "no value where a number should be",
            Ok(sentinel) if sentinel.is_finite() => {
                "no reading: instruments write 9.9E37 for a value out of range"
            }
            _ => "a value that is not finite",
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

    fn backward(&self, time_s: f64, last_s: f64, text: &str) -> Diagnostic {
        Diagnostic::new(format!("time runs backward, from {last_s} s to {time_s} s"))
            .in_column(self.name(0))
            .excerpt(text, self.cell(0, text))
            .value(self.shown(0, text, time_s))
            .note(format!("the sample before is at {last_s} s"))
    }

    fn restart(&self, time_s: f64, last_s: f64, text: &str) -> Diagnostic {
        let name = self.name(0);
        self.backward(time_s, last_s, text).remedy(format!(
            "a second recording seems to begin here: --trace-column '{name}' if it is one of its own, \
             --segment-column '{name}' if it goes on where the last one ended; or give the column that \
             numbers the parts"
        ))
    }

    /// The cell as it stands in the file, or the number that was read.
    fn shown(&self, slot: usize, text: &str, number: f64) -> String {
        let cells = split(text, self.preamble.delimiter);
        let cell = self.placed[slot].and_then(|placed| cells.get(placed.index).cloned());
        cell.unwrap_or_else(|| number.to_string())
    }

    /// Where in the line the channel's cell stands; a guess if the line holds quotes.
    pub(super) fn cell(&self, slot: usize, text: &str) -> Range<usize> {
        let Some(placed) = self.placed[slot] else {
            return 0..0;
        };
        let mut from = 0;
        for (index, cell) in text.split(char::from(self.preamble.delimiter)).enumerate() {
            if index == placed.index {
                let lead = cell.len() - cell.trim_start().len();
                return from + lead..(from + lead + cell.trim().len()).max(from + lead + 1);
            }
            from += cell.len() + 1;
        }
        0..0
    }
}
