//! How much of a measured force is noise, found without any model.

pub(crate) mod coloured;
pub(crate) mod floor;
pub(crate) mod floors;
mod free_air;
mod high_pass;
pub(crate) mod known;
pub(crate) mod line;
mod lines;
mod rest;
mod rest_power;
pub(crate) mod spectrum;
mod stretches;
