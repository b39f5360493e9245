//! What is touched and what touches it: contact laws, the effects that a rig adds, and the rig that puts
//! both together in signal order.

pub mod effect;
pub mod fit_range;
pub mod law;
pub(crate) mod load_path;
pub mod parameter;
pub mod rig;
