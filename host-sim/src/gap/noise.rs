//! How much of a log is noise, without any model.

pub(in crate::gap) mod coloured;
pub(in crate::gap) mod floor;
pub(in crate::gap) mod line;
pub(in crate::gap) mod spectrum;
