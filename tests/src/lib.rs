//! What the test programs share.

pub mod emulator;
pub mod house;
pub mod signal;
pub mod tolerance;
