//! Reports for people: one HTML file that needs nothing else, verdict first.
//!
//! [`Document`] takes the parts (verdict, [`Section`]s of text, [`Table`]s and [`Figure`]s,
//! [`Provenance`]) and writes them; [`plot`] draws the charts; [`estimate`] and [`gap`] are the reports of
//! the verbs of those names. Every text is escaped, and every number is rounded to the digits that its
//! standard error supports.

mod document;
pub mod estimate;
mod figure;
pub mod gap;
mod heat_map;
mod html;
pub mod plot;
mod provenance;
mod table;
pub mod teleop;
mod words;

pub use document::{Document, Section, Tone};
pub use figure::Figure;
pub use heat_map::{HeatMap, HeatScale, Shaded};
pub use html::escape;
pub use provenance::{Input, Provenance};
pub use table::{Cell, Table};
pub(crate) use words::capitalised;

use std::path::Path;

/// What a log or a model is called in the title of its report: the file, with its folder where the file's own name
/// says nothing, such as that of every simulated log. The whole path stands in the provenance.
pub fn called(path: &Path) -> String {
    const NAMELESS: [&str; 5] = ["log", "data", "measured", "model", "base"];
    let text =
        |part: Option<&std::ffi::OsStr>| part.unwrap_or_default().to_string_lossy().into_owned();
    let file = text(path.file_name());
    let folder = text(path.parent().and_then(Path::file_name));
    let stem = file.split('.').next().unwrap_or_default();
    match !folder.is_empty() && NAMELESS.contains(&stem) {
        true => format!("{folder}/{file}"),
        false => file,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_report_is_called_by_its_file_and_by_the_folder_of_a_file_without_a_name() {
        for (path, name) in [
            ("/home/a/gel.csv.gz", "gel.csv.gz"),
            ("runs/7/log.csv", "7/log.csv"),
            ("log.csv", "log.csv"),
            ("-", "-"),
        ] {
            assert_eq!(called(Path::new(path)), name);
        }
    }
}
