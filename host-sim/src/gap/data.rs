//! What a fit sees of the logs.

pub(in crate::gap) mod budget;
pub(in crate::gap) mod fit_data;
pub(in crate::gap) mod input;
pub(in crate::gap) mod low_pass;
pub(in crate::gap) mod motion_errors;
pub(in crate::gap) mod scales;
pub(in crate::gap) mod standstill;
