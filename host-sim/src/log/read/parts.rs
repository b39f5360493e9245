//! What separates the parts of a touch and the recordings in one file.

use crate::diagnostic::{Diagnostic, listed, nearest};
use crate::log::channel::{Header, Placed};
use crate::log::names;
use crate::log::record::ReadOptions;

/// The columns whose changes begin something new.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Separators {
    pub(super) segment: Separator,
    pub(super) trace: Separator,
}

/// By what one kind of part is told.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Separator {
    #[default]
    Nothing,
    /// Wherever this column changes.
    Column(usize),
    /// Wherever time begins again, since the column of time was named.
    Time,
    /// Wherever time begins again and this column changes: its name says what it is.
    Likely(usize),
}

impl Separator {
    /// The column to be watched.
    pub(super) fn column(self) -> Option<usize> {
        match self {
            Separator::Column(index) | Separator::Likely(index) => Some(index),
            Separator::Nothing | Separator::Time => None,
        }
    }
}

/// The separators that were asked for, or that names suggest.
pub(super) fn separators(
    options: &ReadOptions,
    header: Header,
    time: Option<Placed>,
) -> Result<Separators, Diagnostic> {
    let of = |flag: &str, wanted: &Option<String>, is_likely: fn(&str) -> bool| match wanted {
        Some(name) => named(flag, name, header, time),
        None => {
            let likely = header.names.iter().position(|name| is_likely(name));
            Ok(likely.map_or(Separator::Nothing, Separator::Likely))
        }
    };
    Ok(Separators {
        segment: of(
            "--segment-column",
            &options.segment_column,
            names::is_segment,
        )?,
        trace: of("--trace-column", &options.trace_column, names::is_trace)?,
    })
}

fn named(
    flag: &str,
    wanted: &str,
    header: Header,
    time: Option<Placed>,
) -> Result<Separator, Diagnostic> {
    let names = || {
        header
            .names
            .iter()
            .map(String::as_str)
            .filter(|name| !name.is_empty())
    };
    let Some(index) = header.names.iter().position(|name| name == wanted) else {
        let mut diagnostic = Diagnostic::new(format!("no column `{wanted}` for {flag}"))
            .in_column(wanted)
            .note(format!("the columns are {}", listed(names())));
        if let Some(near) = nearest(wanted, names()) {
            diagnostic = diagnostic.note(format!("the nearest name is `{near}`"));
        }
        return Err(diagnostic.remedy(format!("name one of the columns: {flag} NAME")));
    };
    Ok(match time.is_some_and(|time| time.index == index) {
        true => Separator::Time,
        false => Separator::Column(index),
    })
}
