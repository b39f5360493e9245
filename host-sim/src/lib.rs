//! Palpate on the host: a simulated rig, replay of logs, reports.

pub mod check;
pub mod diagnostic;
pub mod estimate;
pub mod inspect;
pub mod log;
pub mod output;
pub mod replay;
pub mod report;
pub mod signal;
