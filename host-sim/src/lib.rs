//! Palpate on the host: a simulated rig, replay of logs, reports.

pub mod batch;
pub mod cli;
pub mod compensate;
pub mod diagnostic;
pub mod estimate;
pub mod gap;
pub mod inspect;
pub mod interrupt;
pub mod json;
mod kinematics;
pub mod link;
pub mod log;
mod lsq;
pub mod model;
pub mod motion;
pub mod number;
pub mod output;
pub mod plant;
pub mod replay;
pub mod report;
pub mod settings;
pub mod signal;
mod spectral;
mod stats;
pub mod threshold;
pub mod toml_reader;
pub mod wrap;
