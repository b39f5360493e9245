//! The host's side of a board: the port, the frames that come over it, recordings and settings.
//!
//! A port is a serial line, the working directory of the emulator, or a simulated board that runs
//! the core's own protocol, sampling and settings code.

pub mod backup;
pub mod board;
pub mod condition;
pub mod device;
mod line;
pub mod port;
pub mod record;
pub mod world;

pub use board::SimulatedBoard;
pub use device::Device;
pub use port::Port;
