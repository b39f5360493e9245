//! What a motion shows before it is recorded, and which one to record next.

pub(crate) mod advise;
mod design;
mod discriminability;
mod excitations;
pub(crate) mod plan;
mod recordings;
