//! The fault table.
pub mod rig;
pub mod score;
