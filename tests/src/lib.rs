//! What the test programs share.
//!
//! xtask is linked with this library and has to start fast, so the modules that need host-sim and
//! other heavy crates exist only with the feature `rigs`, which tests and examples turn on. The
//! library's unit tests need none of them and do not compile them a second time.

#[cfg(all(feature = "rigs", not(test)))]
pub mod acceptance;
pub mod arguments;
pub mod emulator;
#[cfg(all(feature = "rigs", not(test)))]
pub mod faults;
#[cfg(all(feature = "rigs", not(test)))]
pub mod hidden;
pub mod house;
#[cfg(feature = "rigs")]
pub mod information;
pub mod quantile;
pub mod signal;
#[cfg(all(feature = "rigs", not(test)))]
pub mod teleop;
pub mod tolerance;
