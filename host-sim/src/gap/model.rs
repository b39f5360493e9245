//! The model that is fitted: a law with effects, where its fits start, the least squares, and the standard
//! errors.

pub(crate) mod attenuation;
pub(crate) mod dataset;
pub(crate) mod error;
pub(crate) mod fit;
pub(crate) mod given;
pub(crate) mod known;
pub(crate) mod problem;
mod sensor;
pub(crate) mod shape;
pub(crate) mod simulate;
pub(crate) mod start;
pub(crate) mod surface_step;
pub(crate) mod weights;
pub(crate) mod zero_step;
