//! The F405 in the form that RTIC expects of a device crate ([`crate::board`]).

pub use stm32f4xx_hal::pac::NVIC_PRIO_BITS;

/// The interrupts of the application; `vectors.x` has the same pairs of names.
pub mod interrupt {
    // With analog sensors the ADC's DMA stream raises the tick; with SPI sensors SysTick pends it.
    pub use stm32f4xx_hal::pac::Interrupt::{CAN1_TX as SPARE, DMA2_STREAM0 as TICK};
}
