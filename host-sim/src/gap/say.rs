//! A decision as a finding for people and files.

pub(crate) mod builder;
pub(crate) mod each_log;
mod estimates;
mod gone;
mod left;
mod lines;
mod log_residuals;
pub(crate) mod plausibility;
pub(crate) mod regions;
