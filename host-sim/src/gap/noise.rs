//! How much of a measured force is noise, found without any model.

pub(crate) mod coloured;
pub(crate) mod floor;
pub(crate) mod line;
mod rest;
pub(crate) mod spectrum;
