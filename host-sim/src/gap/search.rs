//! The search over the catalogue: which effects are added, swapped and dropped, and what an effect must take
//! off Σ w r² to stay.

mod alone;
mod base;
pub(crate) mod blocks;
mod decline;
pub(crate) mod eliminate;
pub(crate) mod evidence;
pub(crate) mod expand;
pub(crate) mod forms;
mod given_forms;
mod nearest;
mod parts;
pub(crate) mod periodic;
pub(crate) mod physical;
pub(crate) mod proposals;
pub(crate) mod relatives;
mod remainder;
pub(crate) mod run;
pub(crate) mod screen;
pub(crate) mod sets;
pub(crate) mod significance;
pub(crate) mod swap;
