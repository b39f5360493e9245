//! An STM32F405 motor controller, wired like an ODrive v3.6 (README, "Wiring").
//!
//! The board has one of two sets of sensors: [`analog`], or [`spi`] with the feature `spi-sensors`.
//!
//! The board commands no motion: it holds the gate driver's enable (PB12) low and touches none of the
//! driver's other pins. On PB3 it puts out a force for whatever drives a master ([`force`]).
//!
//! "RM" is reference manual RM0090, "DS" the data sheet DocID022152.

#[cfg(not(feature = "spi-sensors"))]
mod analog;
mod clock;
pub mod device;
mod duty;
mod event;
mod flash;
mod force;
mod pll;
mod registers;
#[cfg(not(feature = "spi-sensors"))]
mod ring;
#[cfg(feature = "spi-sensors")]
mod spi;
mod supply;
mod time;
mod uart;
mod watchdog;

pub use self::F405 as Selected;

use crate::board::{Board, Outcome, Parts};
// The log goes over RTT. The link proof has no logger.
#[cfg(not(feature = "panic-proof"))]
use defmt_rtt as _;
use estimator_core::board::instants::Ticks;
use estimator_core::board::sampling::PERIOD_US;
use estimator_core::board::settings::store::Store;
use estimator_core::{Fault, Faults};
use flash::{Flash, SECTOR, SETTINGS};
use force::Pwm;
use pll::Source;
use stm32f4xx_hal::dma::StreamsTuple;
use stm32f4xx_hal::gpio::{Output, PC4};
use stm32f4xx_hal::pac;
use stm32f4xx_hal::prelude::*;
use uart::Uart;
use watchdog::IwdgWatchdog;

/// The STM32F405 board.
pub struct F405;

impl Board for F405 {
    #[cfg(not(feature = "spi-sensors"))]
    const NAME: &'static str = "f405";
    #[cfg(feature = "spi-sensors")]
    const NAME: &'static str = "f405-spi";
    const COST_UNIT: &'static str = "counts";
    const TICK: u32 = time::TICK;

    #[cfg(not(feature = "spi-sensors"))]
    type Sensors = analog::AnalogAndQuadrature;
    #[cfg(feature = "spi-sensors")]
    type Sensors = spi::SpiSensors;
    type Link = Uart;
    type Light = PC4<Output>;
    type Flash = Flash;
    type Watchdog = IwdgWatchdog;
    type Output = Pwm;

    fn start(core: cortex_m::Peripherals) -> Parts<F405> {
        let Some(mut device) = pac::Peripherals::take() else {
            defmt::panic!("the board was started twice");
        };
        // The watchdog starts first, from an oscillator of its own: a start-up that hangs ends in a reset.
        let watchdog = IwdgWatchdog::start(device.IWDG, &device.DBGMCU);
        // The gate driver is off and stays off, also while a clock is waited for or where there is none: the pin
        // stays an output that is low.
        let gpiob = device.GPIOB.split(&mut device.RCC);
        let _ = gpiob.pb12.into_push_pull_output_in_state(false.into());
        let reset = clock::reset_cause(&device.RCC);
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
        time::start(device.TIM5, &mut rcc);

        let gpioa = device.GPIOA.split(&mut rcc);
        let gpioc = device.GPIOC.split(&mut rcc);
        let dma1 = StreamsTuple::new(device.DMA1, &mut rcc);

        // With a pull-up, a cable that is unplugged is an idle line and no stream of noise.
        let pins = (gpioa.pa0, gpioa.pa1.into_pull_up_input());
        let link = Uart::new(device.UART4, pins, (dma1.4, dma1.2), &mut rcc);
        #[cfg(not(feature = "spi-sensors"))]
        let sensors = analog::set_up(
            analog::Wires {
                force: gpioa.pa2,
                // PB4 is JTAG's reset until it is taken; serial-wire debugging does not need it.
                quadrature: (gpiob.pb4.into_alternate(), gpiob.pb5.into_alternate()),
                force_stream: StreamsTuple::new(device.DMA2, &mut rcc).0,
                position_stream: dma1.7,
                adc: device.ADC1,
                tim2: device.TIM2,
                tim3: device.TIM3,
                guard: core.SYST,
            },
            Clock::new(standing),
            &mut rcc,
        );
        #[cfg(feature = "spi-sensors")]
        let sensors = {
            // Only the force output needs the event here.
            event::set_up(device.TIM2, &mut rcc);
            // The motor drivers share the bus and stay deselected.
            let _ = gpioc.pc13.into_push_pull_output_in_state(true.into());
            let _ = gpioc.pc14.into_push_pull_output_in_state(true.into());
            spi::set_up(
                spi::Wires {
                    spi3: device.SPI3,
                    bus: (gpioc.pc10, gpioc.pc11, gpioc.pc12),
                    encoder: gpioa.pa2.into_push_pull_output_in_state(true.into()),
                    bridge: gpioa.pa3.into_push_pull_output_in_state(true.into()),
                    // With a pull-up, nothing is ever ready without a converter.
                    ready: gpiob.pb2.into_pull_up_input(),
                    tick: core.SYST,
                },
                Clock::new(standing),
                &mut rcc,
            )
        };
        let output = Pwm::new(gpiob.pb3.into_alternate(), dma1.1);
        supply::watch(&device.PWR, &device.EXTI, &mut rcc);
        registers::check(source);
        Parts {
            sensors,
            link,
            light: gpioc.pc4.into_push_pull_output(),
            store: Store::new(Flash::new(device.FLASH), SETTINGS, SECTOR),
            watchdog,
            output,
            clock_fallback,
            reset,
        }
    }

    fn now() -> u32 {
        time::now()
    }

    /// Waits without `wfi`: a debugger reads the log from memory, which it cannot while the core sleeps.
    fn idle() {
        cortex_m::asm::nop();
    }

    fn make_safe() {
        cortex_m::interrupt::disable();
        Pwm::float();
    }

    fn stop(_: Outcome) -> ! {
        F405::make_safe();
        loop {
            cortex_m::asm::nop();
        }
    }
}

/// Reports that there is no clock, in the log and with the status light (three flashes and a pause), until
/// the watchdog restarts the board.
fn without_clock(rcc: pac::RCC, gpioc: pac::GPIOC) -> ! {
    /// A tenth of a second in cycles of the 16 MHz that are left.
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

/// The source of the samples' time stamps.
struct Clock {
    ticks: Ticks,
    /// The faults of every sample.
    standing: Faults,
}

/// A tick on the board's clock.
struct At {
    /// Its time (µs).
    time_us: u64,
    /// [`Fault::Overrun`] if ticks were missed before it, and the standing faults.
    faults: Faults,
    /// The reading of the stopwatch at which it was due.
    due: u32,
}

impl Clock {
    fn new(standing: Faults) -> Self {
        Clock {
            ticks: Ticks::new(F405::TICK),
            standing,
        }
    }

    /// Takes note that ticks start now, or start again.
    fn resume(&mut self) {
        self.ticks.start(F405::now());
    }

    /// Returns whether a tick should have come half a tick ago.
    #[cfg(not(feature = "spi-sensors"))]
    fn is_overdue(&self) -> bool {
        self.ticks.is_overdue(F405::now())
    }

    /// Returns this tick, or `None` for a spurious call.
    fn tick(&mut self) -> Option<At> {
        let told = self.ticks.at(F405::now())?;
        let faults = match told.missed {
            true => self.standing.with(Fault::Overrun),
            false => self.standing,
        };
        Some(At {
            time_us: told.number * PERIOD_US,
            faults,
            due: told.due,
        })
    }
}
