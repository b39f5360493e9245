//! Drivers of the second set of sensors, a magnetic encoder and a 24-bit bridge converter on SPI. They know
//! the traits of embedded-hal 1.0 and no board; tests/drivers.rs runs them against the sequences of the data
//! sheets.

pub mod ads1220;
pub mod as5047p;
pub mod pair;
