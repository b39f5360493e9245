//! Which names stand: held-out parts, rivals, sizes.

pub(in crate::gap) mod acceptance;
pub(in crate::gap) mod decide;
pub(in crate::gap) mod evidence;
pub(in crate::gap) mod rivals;
