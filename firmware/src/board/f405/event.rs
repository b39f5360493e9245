//! TIM2 at 32 kHz. Its update triggers the ADC and, through TIM3's ITR1 (RM table 98), the encoder's
//! latch; its channel 2 is the force output's PWM.

use crate::board::RATE_HZ;
use stm32f4xx_hal::pac::{self, TIM2};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::timer::Timer;

/// Events in a millisecond.
pub const PER_SAMPLE: u16 = 32;
/// Counts between two: 84 MHz / 32 kHz, exactly.
pub const PERIOD: u16 = 2625;
const HZ: u32 = PER_SAMPLE as u32 * RATE_HZ;
const _: () = assert!(HZ * PERIOD as u32 == 84_000_000);

/// Starts it.
pub fn start(tim2: TIM2, rcc: &mut Rcc) {
    let mut timer = Timer::new(tim2, rcc);
    timer.set_master_mode(pac::tim2::cr2::MMS::Update);
    let mut counter = timer.counter_hz();
    // Fails only for rates that a 32-bit counter at 84 MHz cannot have.
    if counter.start(HZ.Hz()).is_err() {
        defmt::panic!("TIM2 cannot run at {=u32} Hz", HZ);
    }
}
