//! An STM32F405 motor controller, wired like an ODrive v3.6 (README, "Wiring").
//!
//! Two sets of sensors behind one seam: [`analog`], and with the feature `spi-sensors` [`spi`].
//!
//! The board commands no motion: the gate driver's enable (PB12) is held low, none of its pins is
//! touched. What it puts out is a force for whatever drives a master, on PB3 ([`force`]).
//!
//! "RM" is reference manual RM0090, "DS" the data sheet DocID022152.

#[cfg(not(feature = "spi-sensors"))]
mod analog;
mod clock;
mod event;
mod flash;
mod force;
mod registers;
#[cfg(not(feature = "spi-sensors"))]
mod ring;
#[cfg(feature = "spi-sensors")]
mod spi;
mod uart;

use super::{Board, Outcome, Parts, RATE_HZ, Watchdog};
use crate::driver::clock::Source;
use cortex_m::peripheral::DWT;
use estimator_core::board::instants::Ticks;
use estimator_core::board::settings::store::Store;
use estimator_core::{Fault, Faults};
use flash::{Flash, SECTOR, SETTINGS};
use force::Pwm;
use stm32f4xx_hal::dma::StreamsTuple;
use stm32f4xx_hal::gpio::{Output, PC4};
use stm32f4xx_hal::pac;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::watchdog::IndependentWatchdog;
use uart::Uart;

/// Longer than an erase of a 128 KiB sector, which takes up to 4 s (DS table 44).
const WATCHDOG_MS: u32 = 10_000;

/// The board.
pub struct F405;

impl Board for F405 {
    #[cfg(not(feature = "spi-sensors"))]
    const NAME: &'static str = "f405";
    #[cfg(feature = "spi-sensors")]
    const NAME: &'static str = "f405-spi";
    const COST_UNIT: &'static str = "cycles";
    const TICK: u32 = clock::CORE_HZ / RATE_HZ;

    #[cfg(not(feature = "spi-sensors"))]
    type Sensors = analog::AnalogAndQuadrature;
    #[cfg(feature = "spi-sensors")]
    type Sensors = spi::SpiSensors;
    type Link = Uart;
    type Light = PC4<Output>;
    type Flash = Flash;
    type Watchdog = Dog;
    type Output = Pwm;

    fn start(mut core: cortex_m::Peripherals, device: pac::Peripherals) -> Parts<F405> {
        // First of all, and from its own oscillator: a start-up that hangs ends in a reset.
        let mut watchdog = IndependentWatchdog::new(device.IWDG);
        watchdog.stop_on_debug(&device.DBGMCU, true);
        watchdog.start(WATCHDOG_MS.millis());
        let (mut rcc, source) = match clock::start(device.RCC) {
            Ok(started) => started,
            Err(rcc) => without_clock(rcc, device.GPIOC),
        };
        let clock_fallback = source == Source::Internal;
        let mut standing = Faults::NONE;
        if clock_fallback {
            defmt::warn!(
                "crystal does not start: {=str}",
                Fault::ClockInternal.describe()
            );
            standing = standing.with(Fault::ClockInternal);
        }
        core.DCB.enable_trace();
        core.DWT.enable_cycle_counter();

        let gpioa = device.GPIOA.split(&mut rcc);
        let gpiob = device.GPIOB.split(&mut rcc);
        let gpioc = device.GPIOC.split(&mut rcc);
        let dma1 = StreamsTuple::new(device.DMA1, &mut rcc);
        // Gate driver off, and kept off: the pin stays an output that is low.
        let _ = gpiob.pb12.into_push_pull_output_in_state(false.into());

        // Pulled up: a cable that is off is an idle line, not a stream of noise.
        let pins = (gpioa.pa0, gpioa.pa1.into_pull_up_input());
        let link = Uart::new(device.UART4, pins, (dma1.4, dma1.2), &mut rcc);
        #[cfg(not(feature = "spi-sensors"))]
        let sensors = analog::start(
            analog::Wires {
                force: gpioa.pa2,
                // PB4 is JTAG's reset until it is taken; serial-wire debugging does not need it.
                quadrature: (gpiob.pb4.into_alternate(), gpiob.pb5.into_alternate()),
                force_stream: StreamsTuple::new(device.DMA2, &mut rcc).0,
                position_stream: dma1.7,
                adc: device.ADC1,
                tim2: device.TIM2,
                tim3: device.TIM3,
            },
            Clock::new(standing),
            &mut rcc,
        );
        #[cfg(feature = "spi-sensors")]
        let sensors = {
            // Nothing else needs the event here than the force output.
            event::start(device.TIM2, &mut rcc);
            // The motor drivers share the bus: not selected, and kept so.
            let _ = gpioc.pc13.into_push_pull_output_in_state(true.into());
            let _ = gpioc.pc14.into_push_pull_output_in_state(true.into());
            spi::start(
                spi::Wires {
                    spi3: device.SPI3,
                    bus: (gpioc.pc10, gpioc.pc11, gpioc.pc12),
                    encoder: gpioa.pa2.into_push_pull_output_in_state(true.into()),
                    bridge: gpioa.pa3.into_push_pull_output_in_state(true.into()),
                    // Pulled up: without a converter nothing is ever ready.
                    ready: gpiob.pb2.into_pull_up_input(),
                    tick: core.SYST,
                },
                Clock::new(standing),
                &mut rcc,
            )
        };
        let output = Pwm::new(gpiob.pb3.into_alternate());
        registers::check(source);
        Parts {
            sensors,
            link,
            light: gpioc.pc4.into_push_pull_output(),
            store: Store::new(Flash::new(device.FLASH), SETTINGS, SECTOR),
            watchdog: Dog(watchdog),
            output,
            clock_fallback,
        }
    }

    fn now() -> u32 {
        DWT::cycle_count()
    }

    /// Not `wfi`: the cycle counter stands still while the core sleeps, and the time of samples is
    /// its.
    fn idle() {
        cortex_m::asm::nop();
    }

    fn stop(_: Outcome) -> ! {
        cortex_m::interrupt::disable();
        Pwm::float();
        loop {
            cortex_m::asm::nop();
        }
    }
}

/// The independent watchdog.
pub struct Dog(IndependentWatchdog);

impl Watchdog for Dog {
    fn feed(&mut self) {
        self.0.feed();
    }
}

/// Says that there is no clock, in the log and with the status light, three flashes and a pause, until
/// the watchdog starts the board for another try.
fn without_clock(rcc: pac::RCC, gpioc: pac::GPIOC) -> ! {
    /// Of the 16 MHz that are left.
    const TENTH_SECOND: u32 = 1_600_000;
    defmt::error!("the PLL does not lock, neither on the crystal nor on the internal oscillator");
    let mut light = gpioc
        .split(&mut rcc.constrain())
        .pc4
        .into_push_pull_output();
    loop {
        for _ in 0..6 {
            light.toggle();
            cortex_m::asm::delay(TENTH_SECOND);
        }
        cortex_m::asm::delay(10 * TENTH_SECOND);
    }
}

/// The time of samples.
struct Clock {
    ticks: Ticks,
    /// What is wrong with every sample.
    standing: Faults,
}

impl Clock {
    fn new(standing: Faults) -> Self {
        Clock {
            ticks: Ticks::new(F405::TICK),
            standing,
        }
    }

    /// The time of this tick (µs), with [`Fault::Overrun`] if ticks were missed before it; `None` of
    /// a spurious call.
    fn tick(&mut self) -> Option<(u64, Faults)> {
        let (count, late) = self.ticks.at(F405::now())?;
        let faults = match late {
            true => self.standing.with(Fault::Overrun),
            false => self.standing,
        };
        Some((count * u64::from(1_000_000 / RATE_HZ), faults))
    }
}
