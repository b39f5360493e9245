//! The second set of sensors: a magnetic encoder and a 24-bit bridge converter on SPI, over the
//! traits of embedded-hal 1.0. Nothing here knows the board; tests/drivers.rs runs it against the
//! sequences of the data sheets.

pub mod ads1220;
pub mod as5047p;
pub mod pair;
