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
    /// Leave rows with missing or non-finite values out instead of stopping at the first.
    #[arg(long)]
    pub skip_bad_rows: bool,
}

impl ReadingArgs {
    pub(crate) fn options(&self) -> ReadOptions {
        ReadOptions {
            columns: self.columns.clone().unwrap_or_default(),
            skip_bad_rows: self.skip_bad_rows,
        }
    }

    /// Reads a log onto an even grid.
    ///
    /// # Errors
    /// What is wrong with the file.
    pub fn read(&self, path: &Path) -> Result<UniformLog, Diagnostic> {
        Log::read(path, &self.options())?.uniform()
    }
}

fn column_map(text: &str) -> Result<ColumnMap, String> {
    text.parse().map_err(|error: Diagnostic| error.below())
}
