//! The event: TIM2 at 32 kHz. Its update triggers the ADC and, through TIM3's ITR1 (RM table 98), the
//! encoder's latch; its channel 2 is the force output's PWM.

use estimator_core::board::sampling::{FULL, RATE_HZ};
use stm32f4xx_hal::pac::{self, TIM2};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::timer::Timer;

/// Events in a sample.
pub const PER_SAMPLE: u16 = 32;
/// Events in a second.
const HZ: u32 = PER_SAMPLE as u32 * RATE_HZ;
// The full force output is a period of the timer: 84 MHz / 32 kHz, exactly.
const _: () = assert!(HZ * FULL as u32 == 84_000_000);

/// Starts the timer.
pub fn start(tim2: TIM2, rcc: &mut Rcc) {
    let mut timer = Timer::new(tim2, rcc);
    timer.set_master_mode(pac::tim2::cr2::MMS::Update);
    let mut counter = timer.counter_hz();
    // Fails only for rates that a 32-bit counter at 84 MHz cannot have.
    if counter.start(HZ.Hz()).is_err() {
        defmt::panic!("TIM2 cannot run at {=u32} Hz", HZ);
    }
}
