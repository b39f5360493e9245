//! A decision as a finding for people and files.

pub(in crate::gap) mod builder;
pub(in crate::gap) mod plausibility;
pub(in crate::gap) mod regions;
