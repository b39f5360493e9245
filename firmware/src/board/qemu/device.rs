//! The emulated part in the form that RTIC expects of a device crate ([`crate::board`]): only software pends
//! the two interrupts, so the first two inputs of QEMU's interrupt controller serve as well as any.

use cortex_m::interrupt::InterruptNumber;

/// Number of priority bits, as on an STM32F405.
pub const NVIC_PRIO_BITS: u8 = 4;

/// The interrupts of the application.
#[allow(non_camel_case_types)]
#[derive(Clone, Copy)]
#[repr(u16)]
pub enum interrupt {
    /// SysTick pends it once a millisecond.
    TICK,
    /// RTIC starts the telemetry task with it.
    SPARE,
}

// SAFETY: the numbers are the places of the handlers in the vector table below.
unsafe impl InterruptNumber for interrupt {
    fn number(self) -> u16 {
        self as u16
    }
}

unsafe extern "C" {
    fn TICK();
    fn SPARE();
}

/// The interrupts' part of the vector table, under the name that cortex-m-rt asks for.
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
pub static __INTERRUPTS: [unsafe extern "C" fn(); 2] = [TICK, SPARE];
