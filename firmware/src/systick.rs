//! A tick from SysTick, for boards that have no interrupt of their own for it, or that look after theirs.

use crate::board::device;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m::peripheral::{NVIC, SYST};
use cortex_m_rt::exception;
use estimator_core::board::sampling::RATE_HZ;

/// Raises the board's tick every `ticks` ticks (fewer than 100), on a core that runs at `core_hz` (Hz).
pub fn start(mut timer: SYST, core_hz: u32, ticks: u32) {
    timer.set_clock_source(SystClkSource::Core);
    timer.set_reload(core_hz / RATE_HZ * ticks - 1);
    timer.clear_current();
    timer.enable_interrupt();
    timer.enable_counter();
}

/// Raises the board's tick.
#[exception]
fn SysTick() {
    NVIC::pend(device::interrupt::TICK);
}
