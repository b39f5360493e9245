//! How logs are read, whichever verb reads them.

use std::path::Path;

use clap::Args;

use crate::diagnostic::Diagnostic;
use crate::log::{ColumnMap, Log, ReadOptions, UniformLog};

/// How logs of other machines are read.
#[derive(Args, Clone, Debug, Default)]
pub struct ReadingArgs {
    /// Other column names, signs and units: `t=Time[ms]*1e-3,x=pos_mm*1e-3,f=-Fz`.
    #[arg(long, value_name = "MAP", value_parser = column_map)]
    pub columns: Option<ColumnMap>,
    /// Sampling rate (Hz) of a file without a usable time column.
    #[arg(long, value_name = "HZ", value_parser = rate)]
    pub rate: Option<f64>,
    /// The column whose changes separate the parts of one touch; the column of time: where it begins again.
    #[arg(long, value_name = "NAME")]
    pub segment_column: Option<String>,
    /// The column whose changes separate recordings of their own; the column of time: where it begins again.
    #[arg(long, value_name = "NAME")]
    pub trace_column: Option<String>,
    /// Leave rows with missing or non-finite values out instead of stopping at the first.
    #[arg(long)]
    pub skip_bad_rows: bool,
}

impl ReadingArgs {
    pub(crate) fn options(&self) -> ReadOptions {
        ReadOptions {
            columns: self.columns.clone().unwrap_or_default(),
            skip_bad_rows: self.skip_bad_rows,
            rate_hz: self.rate,
            segment_column: self.segment_column.clone(),
            trace_column: self.trace_column.clone(),
        }
    }

    /// Reads every recording of a file onto an even grid.
    ///
    /// # Errors
    /// What is wrong with the file.
    pub fn read(&self, path: &Path) -> Result<Vec<UniformLog>, Diagnostic> {
        let logs = Log::read_all(path, &self.options())?;
        logs.into_iter().map(Log::into_uniform).collect()
    }
}

fn rate(text: &str) -> Result<f64, String> {
    positive(text, "a number of samples per second, such as 1000")
}

/// A finite number greater than 0 of an argument; `what` says what must stand there.
pub(super) fn positive(text: &str, what: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value > 0.0 => Ok(value),
        _ => Err(format!("must be {what}")),
    }
}

fn column_map(text: &str) -> Result<ColumnMap, String> {
    text.parse().map_err(|error: Diagnostic| error.below())
}
