//! The bridge between two boards: what the slave's board identifies goes to the master's board, on one host
//! or over a network.
//!
//! Over the network each packet is a UDP datagram of a Noise session with a pre-shared key (NNpsk0, 25519,
//! ChaChaPoly, BLAKE2s, stateless transport): what comes in moves somebody's hand, so what is changed,
//! replayed, late, overtaken or a stranger's is counted and goes no further. Time is an argument.

pub mod endpoint;
pub mod key;
pub mod payload;
pub mod replay;
pub mod run;
pub mod session;
pub mod summary;

pub use endpoint::{Clock, Counts, Endpoint, Role};
pub use key::Key;
pub use summary::Summary;
