//! Reports for people: one HTML file that needs nothing else, verdict first.
//!
//! [`Document`] takes the parts (verdict, [`Section`]s of text, [`Table`]s and [`Figure`]s,
//! [`Provenance`]) and writes them; [`plot`] draws; [`estimate`] is the report of the verb of that
//! name. Every text is escaped, every number is rounded to what its standard error leaves.

mod document;
pub mod estimate;
mod figure;
mod html;
pub mod number;
pub mod plot;
mod provenance;
mod table;

pub use document::{Document, Section, Tone};
pub use figure::Figure;
pub use html::escape;
pub use provenance::{Input, Provenance};
pub use table::{Cell, Table};
