//! A log in memory.

use std::path::PathBuf;

use super::columns::ColumnMap;
use super::origin::SourceColumns;
use crate::kind::Kind;

/// Fewest samples that make a log.
pub const FEWEST_SAMPLES: usize = 10;

/// A record of force and position over time. All channels have the same length; time increases
/// strictly and every number of the three channels is finite.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Log {
    /// Where it came from.
    pub path: PathBuf,
    /// Whether the machine turns, where the units of position or force say so.
    pub kind: Option<Kind>,
    /// Time (s).
    pub time_s: Vec<f64>,
    /// Position (m), growing into the material.
    pub position_m: Vec<f64>,
    /// Force (N), positive when it pushes the probe out.
    pub force_n: Vec<f64>,
    /// The further columns of numbers, in the order of the file.
    pub extra: Vec<ExtraColumn>,
    /// The columns that it was read from; `None` for those of our own logs.
    pub source: Option<SourceColumns>,
    /// What was left out or looks odd, a sentence each.
    pub notes: Vec<String>,
}

/// A further column of a log, in the file's own unit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ExtraColumn {
    /// Its name in the header.
    pub name: String,
    /// A value per sample; NaN where the file holds none.
    pub values: Vec<f64>,
}

/// How a log is read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// Which columns hold time, position and force, and in which units.
    pub columns: ColumnMap,
    /// Leave out rows with a missing, infinite or NaN value or a wrong number of values, and count
    /// them, instead of stopping at the first. More than 20 % such rows stay an error.
    pub skip_bad_rows: bool,
    /// Samples per second (Hz) of a file whose time cannot be used: its samples are even.
    pub rate_hz: Option<f64>,
    /// The column whose changes separate the parts of one touch; the column of time: where time begins again.
    pub segment_column: Option<String>,
    /// The column whose changes separate recordings of their own; the column of time: where time begins again.
    pub trace_column: Option<String>,
}

impl Log {
    /// A log of channels of equal length that are in memory already.
    ///
    /// # Panics
    /// If the lengths differ.
    pub fn from_channels(time_s: Vec<f64>, position_m: Vec<f64>, force_n: Vec<f64>) -> Log {
        assert_eq!(
            time_s.len(),
            position_m.len(),
            "position has its own length"
        );
        assert_eq!(time_s.len(), force_n.len(), "force has its own length");
        Log {
            time_s,
            position_m,
            force_n,
            ..Log::default()
        }
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.time_s.len()
    }

    /// Whether there is no sample at all.
    pub fn is_empty(&self) -> bool {
        self.time_s.is_empty()
    }

    /// From the first sample to the last (s).
    pub fn duration_s(&self) -> f64 {
        match (self.time_s.first(), self.time_s.last()) {
            (Some(first), Some(last)) => last - first,
            _ => 0.0,
        }
    }

    /// The further column of that name.
    pub fn extra(&self, name: &str) -> Option<&[f64]> {
        let column = self.extra.iter().find(|column| column.name == name)?;
        Some(&column.values)
    }
}
