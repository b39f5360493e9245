//! Palpate on the host: a simulated rig, replay of logs, reports.

pub mod diagnostic;
pub mod log;
pub mod output;
