//! The clocks, and what the HAL has to know about them.

use crate::driver::clock::{self, NotLocked, Register, Registers, Source};
use stm32f4xx_hal::pac::RCC;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::{Config, Rcc};

/// Core clock; APB1 42 MHz, APB2 84 MHz, timers 84 and 168 MHz.
pub const CORE_HZ: u32 = 168_000_000;
const CRYSTAL_HZ: u32 = 8_000_000;

/// Starts the clocks, each with a bound.
///
/// The HAL waits without one, but by then there is nothing to wait for: oscillator and PLL run, and
/// it finds the same PLLCFGR as it would write ([`super::registers`] checks that). What is left to it
/// are flash latency, prescalers and the switch to the PLL.
///
/// # Errors
/// The controller as it is after a reset, at 16 MHz, where the PLL does not lock: the sampling task
/// does not fit into that.
pub fn start(rcc: RCC) -> Result<(Rcc, Source), RCC> {
    let mut controller = Controller(rcc);
    let started = clock::start(&mut controller);
    let Controller(rcc) = controller;
    let (source, input) = match started {
        Ok(source @ Source::Crystal) => (source, Config::hse(CRYSTAL_HZ.Hz())),
        Ok(source @ Source::Internal) => (source, Config::hsi()),
        Err(NotLocked) => return Err(rcc),
    };
    let config = input.sysclk(CORE_HZ.Hz()).pclk1(42.MHz()).pclk2(84.MHz());
    Ok((rcc.freeze(config), source))
}

/// The controller, its registers by name.
struct Controller(RCC);

impl Registers for Controller {
    fn read(&self, register: Register) -> u32 {
        match register {
            Register::Cr => self.0.cr().read().bits(),
            Register::Pllcfgr => self.0.pllcfgr().read().bits(),
        }
    }

    fn write(&mut self, register: Register, value: u32) {
        // SAFETY: whole registers, reserved bits as they were.
        match register {
            Register::Cr => self.0.cr().write(|w| unsafe { w.bits(value) }),
            Register::Pllcfgr => self.0.pllcfgr().write(|w| unsafe { w.bits(value) }),
        };
    }

    fn pause(&mut self) {
        // At the 16 MHz that the core starts with.
        cortex_m::asm::delay(160);
    }
}
