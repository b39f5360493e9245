//! The force output: PWM at 32 kHz on PB3, channel 2 of the timer whose event is the conversions'.
//!
//! Not the DAC: its pins, PA4 and PA5, are thermistors on the ODrive. Not PA15, the timer's channel 1:
//! after a reset it is JTAG's and pulled up, 0.6 V over 10 kΩ; PB3 floats.

use super::event;
use crate::board::ForceOutput;
use stm32f4xx_hal::gpio::{Alternate, PB3};
use stm32f4xx_hal::pac::TIM2;

/// The output. The timer runs already; of it, nothing else uses channel 2.
pub struct Pwm(());

impl Pwm {
    /// Until the first [`ForceOutput::put`] the pin floats, as after a reset.
    pub fn new(_: PB3<Alternate<1>>) -> Self {
        // SAFETY: the mode bits of channel 2, which is off and belongs to this output alone.
        let tim2 = unsafe { &*TIM2::ptr() };
        // RM 18.4.7: high while the count is below CCR2; another CCR2 is in force from the next period on.
        tim2.ccmr1_output()
            .modify(|_, w| w.oc2m().pwm_mode1().oc2pe().enabled());
        Pwm(())
    }

    /// Lets the pin float, whatever was put out; from anywhere.
    pub fn float() {
        // SAFETY: one bit that turns channel 2 off; interrupts are off, or the caller owns the output.
        unsafe { &*TIM2::ptr() }
            .ccer()
            .modify(|_, w| w.cc2e().clear_bit());
    }
}

impl ForceOutput for Pwm {
    /// Always high.
    const FULL: u16 = event::PERIOD;

    fn put(&mut self, code: u16) {
        // SAFETY: registers of channel 2 alone.
        let tim2 = unsafe { &*TIM2::ptr() };
        tim2.ccr2().write(|w| unsafe { w.bits(u32::from(code)) });
        tim2.ccer().modify(|_, w| w.cc2e().set_bit());
    }
}
