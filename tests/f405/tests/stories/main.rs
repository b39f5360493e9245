//! Stories of the board: what happens to it, and what it has to do. What today's image does not do yet is
//! ignored with the repair that it needs and the figure that was measured.

mod boot;
mod clock;
mod common;
mod cost;
mod flash;
mod hang;
mod history;
mod instants;
mod link;
mod sensing;
mod supply;
mod teleoperation;
