//! A tick from SysTick, for boards that have no interrupt of their own for it.

use crate::board::device;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m::peripheral::{NVIC, SYST};
use cortex_m_rt::exception;
use estimator_core::board::sampling::RATE_HZ;

/// Starts the tick, on a core that runs at `core_hz` (Hz).
pub fn start(mut timer: SYST, core_hz: u32) {
    timer.set_clock_source(SystClkSource::Core);
    timer.set_reload(core_hz / RATE_HZ - 1);
    timer.clear_current();
    timer.enable_interrupt();
    timer.enable_counter();
}

/// Raises the board's tick.
#[exception]
fn SysTick() {
    NVIC::pend(device::interrupt::TICK);
}
