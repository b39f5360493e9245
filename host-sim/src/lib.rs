//! Palpate on the host: a simulated rig, replay of logs, reports.

pub mod diagnostic;
pub mod log;
pub mod model;
pub mod motion;
pub mod output;
pub mod plant;
pub mod simulate;
pub mod toml_reader;
