//! The force output: PWM at 32 kHz on PB3, channel 2 of the timer that also triggers the conversions.
//!
//! The DAC cannot serve: its pins, PA4 and PA5, are thermistors on the ODrive. Nor can PA15, the timer's
//! channel 1: after a reset it belongs to JTAG and is pulled up, 0.6 V over 10 kΩ; PB3 floats.

use crate::board::ForceOutput;
use estimator_core::board::sampling::FULL;
use stm32f4xx_hal::gpio::{Alternate, PB3};
use stm32f4xx_hal::pac::TIM2;

/// The PWM output. Its timer runs already, and nothing else uses the timer's channel 2.
pub struct Pwm(());

impl Pwm {
    /// Takes the pin, which floats as after a reset until the first [`ForceOutput::put`].
    pub fn new(_: PB3<Alternate<1>>) -> Self {
        // SAFETY: only the mode bits of channel 2 change, which is off and belongs to this output alone.
        let tim2 = unsafe { &*TIM2::ptr() };
        // RM 18.4.7: the pin is high while the count is below CCR2; a new CCR2 counts from the next period on.
        tim2.ccmr1_output()
            .modify(|_, w| w.oc2m().pwm_mode1().oc2pe().enabled());
        Pwm(())
    }

    /// Lets the pin float, whatever was put out. Any code may call this with interrupts off.
    pub fn float() {
        // SAFETY: only the bit that turns channel 2 off changes, and no interrupt comes in between.
        unsafe { &*TIM2::ptr() }
            .ccer()
            .modify(|_, w| w.cc2e().clear_bit());
    }
}

impl ForceOutput for Pwm {
    /// With this code the pin is always high: it is the timer's period ([`super::event`]).
    const FULL: u16 = FULL;

    fn put(&mut self, code: u16) {
        // SAFETY: only registers and bits of channel 2 change, which belongs to this output alone.
        let tim2 = unsafe { &*TIM2::ptr() };
        tim2.ccr2().write(|w| unsafe { w.bits(u32::from(code)) });
        tim2.ccer().modify(|_, w| w.cc2e().set_bit());
    }
}
