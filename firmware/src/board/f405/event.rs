//! The event: TIM2 at 32 kHz. In each period its channel 4 triggers the ADC, its channel 3 the encoder's latch
//! through TIM3's ITR1 (RM table 98), at the instant at which the ADC holds what it has sampled
//! ([`super::duty`]); its channel 2 is the force output's PWM.

use super::duty::{CONVERT, HOLD, PERIOD};
use estimator_core::board::sampling::RATE_HZ;
use stm32f4xx_hal::pac::{self, TIM2};
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::timer::Timer;

/// Events in a sample.
pub const PER_SAMPLE: u16 = 32;
// A period of the timer at 84 MHz, exactly.
const _: () = assert!(PER_SAMPLE as u32 * RATE_HZ * PERIOD as u32 == 84_000_000);

/// Sets the timer up, and leaves it standing.
pub fn set_up(tim2: TIM2, rcc: &mut Rcc) {
    let mut timer = Timer::new(tim2, rcc);
    timer.set_master_mode(pac::tim2::cr2::MMS::CompareOc3);
    let tim2 = timer.release();
    // RM 18.4.8: in mode 2 the reference rises when the count reaches the compare register. The ADC's trigger is
    // the channel's output (13.6), so it is on; no pin has it.
    tim2.ccmr2_output()
        .modify(|_, w| w.oc3m().pwm_mode2().oc3pe().enabled());
    tim2.ccmr2_output()
        .modify(|_, w| w.oc4m().pwm_mode2().oc4pe().enabled());
    tim2.ccer().modify(|_, w| w.cc4e().set_bit());
    // SAFETY: the values are counts of the timer.
    unsafe {
        tim2.psc().write(|w| w.bits(0));
        tim2.arr().write(|w| w.bits(u32::from(PERIOD) - 1));
        tim2.ccr3().write(|w| w.bits(HOLD.into()));
        tim2.ccr4().write(|w| w.bits(CONVERT.into()));
    }
    // An update takes the values over.
    tim2.egr().write(|w| w.ug().set_bit());
}

/// Starts the timer with a whole period.
pub fn start() {
    // SAFETY: one bit and the count change; only the sampling task and the start call this.
    let tim2 = unsafe { &*TIM2::ptr() };
    tim2.cnt().write(|w| unsafe { w.bits(0) });
    tim2.cr1().modify(|_, w| w.cen().set_bit());
}

/// Stops the timer, and with it conversions and latches.
#[cfg(not(feature = "spi-sensors"))]
pub fn stop() {
    // SAFETY: as above.
    unsafe { &*TIM2::ptr() }
        .cr1()
        .modify(|_, w| w.cen().clear_bit());
}
