//! What only a board and its host share: reading sensors, the sampling task's sequence, settings,
//! frames, and the link between the two.

pub mod budget;
pub mod calibration;
#[cfg(test)]
mod cut_flash;
pub mod frame;
pub mod history;
pub mod instants;
pub mod link;
pub mod message;
pub mod outbox;
pub mod protection;
pub mod ram_flash;
pub mod reflection;
pub mod sampling;
pub mod sensing;
pub mod settings;
mod stuffing;
pub mod wire;
