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

pub use document::{Document, Section, Tone};
pub use figure::Figure;
pub use heat_map::{HeatMap, Shaded};
pub use html::escape;
pub use provenance::{Input, Provenance};
pub use table::{Cell, Table};
