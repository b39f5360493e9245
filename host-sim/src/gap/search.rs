//! Which effects are added, swapped and dropped, and what one must take off to stay.

pub(in crate::gap) mod forms;
pub(in crate::gap) mod proposals;
pub(in crate::gap) mod search;
pub(in crate::gap) mod significance;
