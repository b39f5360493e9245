//! What talks to hardware without knowing the board: the second set of sensors, a magnetic encoder and
//! a 24-bit bridge converter on SPI, over the traits of embedded-hal 1.0 (tests/drivers.rs runs them
//! against the sequences of the data sheets), and the clocks' start over a trait of its own
//! (tests/clock.rs runs it against a model of the registers).

pub mod ads1220;
pub mod as5047p;
pub mod clock;
pub mod pair;
