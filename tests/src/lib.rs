//! What the test programs share.

pub mod emulator;
pub mod signal;
pub mod tolerance;
