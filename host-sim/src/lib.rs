//! Palpate on the host: a simulated rig, replay of logs, reports.

pub mod check;
pub mod diagnostic;
pub mod estimate;
pub mod inspect;
pub mod log;
pub mod motion;
pub mod output;
pub mod plant;
pub mod replay;
pub mod report;
pub mod signal;
pub mod toml_reader;
