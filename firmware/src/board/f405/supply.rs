//! The supervision of the supply. At 168 MHz the flash is read right down to 2.7 V (DS table 15), and the reset of the
//! part comes at 1.7 V: in between the core may do anything, also with the force output.

use super::F405;
use crate::board::{Board, Outcome};
use crate::crash;
use cortex_m::peripheral::NVIC;
use estimator_core::board::history::CrashKind;
use stm32f4xx_hal::pac::{EXTI, Interrupt, PWR};
use stm32f4xx_hal::rcc::{Enable, Rcc};

/// The highest threshold of PLS, 2.9 V (RM 5.4.1).
const LEVEL: u8 = 7;
/// The detector's line of EXTI (RM 12.2.5).
const LINE: u32 = 1 << 16;

/// Watches the supply from here on. The exception has the highest priority, above every task and their locks.
pub fn watch(pwr: &PWR, exti: &EXTI, rcc: &mut Rcc) {
    PWR::enable(rcc);
    // A flag from before is cleared by a 1.
    // SAFETY: the bits are those of the line; the priorities of the tasks are RTIC's, and the handler takes nothing.
    unsafe {
        exti.pr().write(|w| w.bits(LINE));
        exti.rtsr().modify(|r, w| w.bits(r.bits() | LINE));
        exti.imr().modify(|r, w| w.bits(r.bits() | LINE));
        pwr.cr().modify(|_, w| w.pls().bits(LEVEL).pvde().set_bit());
        NVIC::unmask(Interrupt::PVD);
    }
}

/// Ends the program where the supply sinks; the watchdog starts it again, until the supply is back. (No log here: the
/// link proof has none.)
#[unsafe(no_mangle)]
extern "C" fn PVD() {
    F405::make_safe();
    crash::remember(CrashKind::SupplySank, 0, 0);
    F405::stop(Outcome::Failed)
}
