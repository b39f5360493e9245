//! The board's image, executed: the unmodified release ELF of the firmware on a register-level model of the
//! STM32F405, with the mechanics of a press around it. `README.md` beside this package has what the model
//! covers and what it leaves out.

pub mod bench;
pub mod calls;
pub mod chip;
mod cpu;
pub mod elf;
pub mod host;
pub mod machine;
pub mod probe;
pub mod report;
pub mod world;
