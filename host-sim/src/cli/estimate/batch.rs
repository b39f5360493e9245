//! A fit of the whole log on the terminal, in files, in a report.

mod files;
mod print;
mod show;

pub(super) use files::{numbers, write};
pub(super) use print::summary;
