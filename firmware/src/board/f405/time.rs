//! The time base: TIM5 counts 84 MHz in 32 bits. Unlike the core's cycle counter it belongs to no debugger, which
//! switches that off and on as it likes.

use estimator_core::board::sampling::RATE_HZ;
use stm32f4xx_hal::pac::TIM5;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::timer::Timer;

/// Counts of a tick; a count is two cycles of the core.
pub const TICK: u32 = 84_000_000 / RATE_HZ;

/// Starts the count.
pub fn start(tim5: TIM5, rcc: &mut Rcc) {
    let tim5 = Timer::new(tim5, rcc).release();
    // SAFETY: the counter has 32 bits, and counts all of them without a prescaler.
    unsafe {
        tim5.psc().write(|w| w.bits(0));
        tim5.arr().write(|w| w.bits(u32::MAX));
    }
    tim5.egr().write(|w| w.ug().set_bit());
    tim5.cr1().modify(|_, w| w.cen().set_bit());
}

/// Reads the count.
pub fn now() -> u32 {
    // SAFETY: a load of the count changes nothing.
    unsafe { &*TIM5::ptr() }.cnt().read().bits()
}
