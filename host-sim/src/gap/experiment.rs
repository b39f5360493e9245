//! What a motion shows before it is recorded, and which one to record next.

pub(in crate::gap) mod advise;
pub(in crate::gap) mod discriminability;
pub(in crate::gap) mod excitations;
pub(in crate::gap) mod plan;
