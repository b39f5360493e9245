//! 168 MHz from the 8 MHz crystal, or from the internal oscillator where the crystal is dead.

use stm32f4xx_hal::pac::RCC;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::{Config, Rcc};

/// Core clock; APB1 42 MHz, APB2 84 MHz, timers 84 and 168 MHz.
pub const CORE_HZ: u32 = 168_000_000;
const CRYSTAL_HZ: u32 = 8_000_000;

/// Starts the clocks. On the internal oscillator the time base is off by up to 1 % at 25 °C (DS
/// table 41), and with it speed, damping and the baud rate: logged as a warning.
///
/// The HAL waits without a bound for a crystal and for the PLL. So the crystal is tried first, with
/// a bound; the PLL then has an input that runs, and locks within 300 µs (DS table 43). Should it
/// not, the watchdog, which runs by now, resets the board. Gives whether the crystal is dead.
pub fn start(rcc: RCC) -> (Rcc, bool) {
    let crystal = crystal_runs(&rcc);
    let source = if crystal {
        Config::hse(CRYSTAL_HZ.Hz())
    } else {
        defmt::warn!(
            "crystal does not start: internal oscillator, time and baud rate off by up to 1 %"
        );
        Config::hsi()
    };
    let config = source.sysclk(CORE_HZ.Hz()).pclk1(42.MHz()).pclk2(84.MHz());
    (rcc.freeze(config), !crystal)
}

/// A crystal takes 2 ms (DS table 40); after 100 ms there is none.
fn crystal_runs(rcc: &RCC) -> bool {
    const HALF_MILLISECOND: u32 = 8_000; // cycles of the 16 MHz that the core starts with
    rcc.cr().modify(|_, w| w.hseon().set_bit());
    for _ in 0..200 {
        if rcc.cr().read().hserdy().bit_is_set() {
            return true;
        }
        cortex_m::asm::delay(HALF_MILLISECOND);
    }
    rcc.cr().modify(|_, w| w.hseon().clear_bit());
    false
}
