//! The structure of a crate, read from its sources: which file knows which, how long files and
//! functions are. Text only; nothing is compiled.

mod graph;
mod source;
mod token;

pub use graph::{Graph, circles};
pub use source::{Function, Source, Sources};
