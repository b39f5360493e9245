//! The decision: everything is refitted at the log's own rate, checked on held-out parts, and compared with
//! rivals.

pub(crate) mod acceptance;
mod adequacy;
pub(crate) mod decision;
mod early;
pub(crate) mod episode;
mod evaluate;
mod held_out;
mod one_speed;
mod prediction;
pub(crate) mod rivals;
pub(crate) mod selection;
mod slow;
mod typical;
mod windows;
mod zero;
