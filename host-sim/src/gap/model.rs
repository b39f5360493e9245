//! What is fitted: the law with its effects, its starts, the fit itself and how well it knows its numbers.

pub(in crate::gap) mod attenuation;
pub(in crate::gap) mod basis;
pub(in crate::gap) mod covariance;
pub(in crate::gap) mod error;
pub(in crate::gap) mod fit;
pub(in crate::gap) mod given;
pub(in crate::gap) mod shape;
pub(in crate::gap) mod start;
pub(in crate::gap) mod weights;
