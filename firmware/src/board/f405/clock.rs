//! The start of the clocks, through [`super::pll`] and the HAL, their end where the crystal dies, and the cause
//! of a reset.

use super::F405;
use super::pll::{self, NotLocked, Register, Registers, Source};
use crate::board::{Board, Outcome};
use crate::crash;
use cortex_m_rt::exception;
use estimator_core::board::history::{CrashKind, ResetCause};
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
    let rcc = rcc.freeze(config);
    if source == Source::Crystal {
        // RM 7.2.7: where the crystal dies, the core goes on with the internal oscillator, into the exception
        // below. One bit of a register that nothing else writes any more.
        // SAFETY: as above.
        unsafe { &*RCC::ptr() }
            .cr()
            .modify(|_, w| w.csson().set_bit());
    }
    Ok((rcc, source))
}

/// Ends the program when the crystal has died: at 16 MHz the sampling task does not fit into its tick. The
/// watchdog starts the board again, which then finds no crystal and logs what ended the run. (No log here: the
/// link proof has none.)
#[exception]
unsafe fn NonMaskableInt() -> ! {
    F405::make_safe();
    // SAFETY: nothing else runs any more. The exception comes again until its flag is cleared.
    unsafe { &*RCC::ptr() }
        .cir()
        .modify(|_, w| w.cssc().set_bit());
    crash::remember(CrashKind::ClockFailed, 0, 0);
    F405::stop(Outcome::Failed)
}

/// Returns why the board was reset, and clears the flags for the next time (RM 7.3.21).
pub fn reset_cause(rcc: &RCC) -> ResetCause {
    let flags = rcc.csr().read();
    let cause = if flags.wdgrstf().bit_is_set() || flags.wwdgrstf().bit_is_set() {
        ResetCause::Watchdog
    } else if flags.sftrstf().bit_is_set() {
        ResetCause::Software
    } else if flags.porrstf().bit_is_set() {
        ResetCause::PowerOn
    } else if flags.borrstf().bit_is_set() {
        ResetCause::BrownOut
    } else if flags.padrstf().bit_is_set() {
        ResetCause::Pin
    } else {
        ResetCause::Unknown
    };
    rcc.csr().modify(|_, w| w.rmvf().set_bit());
    cause
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
