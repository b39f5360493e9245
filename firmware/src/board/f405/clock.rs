//! The start of the clocks, through [`super::pll`] and the HAL.

use super::pll::{self, NotLocked, Register, Registers, Source};
use stm32f4xx_hal::pac::RCC;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::{Config, Rcc};

/// Core clock (Hz). APB1 runs at 42 MHz, APB2 at 84 MHz, the timers at 84 and 168 MHz.
pub const CORE_HZ: u32 = 168_000_000;
/// Crystal (Hz).
const CRYSTAL_HZ: u32 = 8_000_000;

/// Starts the clocks with a bound on every wait.
///
/// The HAL waits without a bound, but then everything runs already: oscillator and PLL are on, and
/// PLLCFGR has the value that the HAL would write ([`super::registers`] checks it). The HAL sets flash
/// latency and prescalers and switches to the PLL.
///
/// # Errors
/// Where the PLL does not lock, the controller as it is after a reset, at 16 MHz: too slow for the
/// sampling task.
pub fn start(rcc: RCC) -> Result<(Rcc, Source), RCC> {
    let mut controller = Controller(rcc);
    let started = pll::start(&mut controller);
    let Controller(rcc) = controller;
    let (source, input) = match started {
        Ok(source @ Source::Crystal) => (source, Config::hse(CRYSTAL_HZ.Hz())),
        Ok(source @ Source::Internal) => (source, Config::hsi()),
        Err(NotLocked) => return Err(rcc),
    };
    let config = input.sysclk(CORE_HZ.Hz()).pclk1(42.MHz()).pclk2(84.MHz());
    Ok((rcc.freeze(config), source))
}

/// The reset and clock controller.
struct Controller(RCC);

impl Registers for Controller {
    fn read(&self, register: Register) -> u32 {
        match register {
            Register::Cr => self.0.cr().read().bits(),
            Register::Pllcfgr => self.0.pllcfgr().read().bits(),
        }
    }

    fn write(&mut self, register: Register, value: u32) {
        // SAFETY: the value has the reserved bits as they were.
        match register {
            Register::Cr => self.0.cr().write(|w| unsafe { w.bits(value) }),
            Register::Pllcfgr => self.0.pllcfgr().write(|w| unsafe { w.bits(value) }),
        };
    }

    fn pause(&mut self) {
        // 10 µs at the 16 MHz with which the core starts.
        cortex_m::asm::delay(160);
    }
}
