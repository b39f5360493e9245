//! An STM32F405 motor controller, wired like an ODrive v3.6 (README, "Wiring").
//!
//! One timer event, 32 000 times a second, starts a conversion of the load cell and latches the
//! encoder; DMA collects both. After 32 events the ADC's stream raises the 1 kHz interrupt, and
//! the sums of both channels belong to the same 32 instants.
//!
//! The board commands no motion: the gate driver's enable (PB12) is held low, no PWM pin is
//! touched.
//!
//! "RM" is reference manual RM0090, "DS" the data sheet DocID022152.

mod clock;
mod flash;
mod ring;
mod uart;

use super::{Acquired, Board, Outcome, Parts, RATE_HZ, Sensors, Watchdog};
use cortex_m::peripheral::DWT;
use defmt_rtt as _;
use estimator_core::sensing::Codes;
use estimator_core::settings::Key;
use estimator_core::settings::store::Store;
use estimator_core::{Fault, Faults};
use flash::{Flash, SECTOR, SETTINGS};
use ring::{Memory, Ring};
use stm32f4xx_hal::adc::config::{
    AdcConfig, Clock, Dma, ExternalTrigger, SampleTime, Sequence, TriggerMode,
};
use stm32f4xx_hal::dma::config::Priority;
use stm32f4xx_hal::dma::traits::PeriAddress;
use stm32f4xx_hal::dma::{DmaChannel, Stream0, Stream7, StreamsTuple};
use stm32f4xx_hal::gpio::{Alternate, Analog, Output, PA2, PB4, PB5, PC4};
use stm32f4xx_hal::pac::{ADC1, DMA1, DMA2, TIM2, TIM3};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::qei::Qei;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::timer::Timer;
use stm32f4xx_hal::watchdog::IndependentWatchdog;
use stm32f4xx_hal::{adc::Adc, pac};
use uart::Uart;

/// Conversions that are summed into one sample: 32 kHz down to 1 kHz. The sum is not divided: 12 bits
/// become 17 codes' worth, and noise drops by √32. The encoder's latches are summed alike.
const OVERSAMPLING: u16 = 32;
// The defaults of the settings are those of this wiring: 0 N at half the range of the sum.
const _: () = assert!(Key::ForceZeroCode.info().default == 2048.0 * OVERSAMPLING as f32);

/// Longer than an erase of a 128 KiB sector, which takes up to 4 s (DS table 44).
const WATCHDOG_MS: u32 = 10_000;

/// Conversions and latches per second.
const EVENT_HZ: u32 = OVERSAMPLING as u32 * RATE_HZ;

static FORCES: Memory = ring::memory();
static POSITIONS: Memory = ring::memory();

/// The board.
pub struct F405;

impl Board for F405 {
    const NAME: &'static str = "f405";
    const COST_UNIT: &'static str = "cycles";
    const TICK: u32 = clock::CORE_HZ / RATE_HZ;

    type Sensors = LoadCellAndEncoder;
    type Link = Uart;
    type Light = PC4<Output>;
    type Flash = Flash;
    type Watchdog = Dog;

    fn start(mut core: cortex_m::Peripherals, device: pac::Peripherals) -> Parts<F405> {
        // First of all, and from its own oscillator: a start-up that hangs ends in a reset.
        let mut watchdog = IndependentWatchdog::new(device.IWDG);
        watchdog.stop_on_debug(&device.DBGMCU, true);
        watchdog.start(WATCHDOG_MS.millis());
        let (mut rcc, clock_fallback) = clock::start(device.RCC);
        core.DCB.enable_trace();
        core.DWT.enable_cycle_counter();

        let gpioa = device.GPIOA.split(&mut rcc);
        let gpiob = device.GPIOB.split(&mut rcc);
        let gpioc = device.GPIOC.split(&mut rcc);
        let dma1 = StreamsTuple::new(device.DMA1, &mut rcc);
        let dma2 = StreamsTuple::new(device.DMA2, &mut rcc);

        // Gate driver off, and kept off: the pin stays an output that is low.
        let _ = gpiob.pb12.into_push_pull_output_in_state(false.into());

        // Pulled up: a cable that is off is an idle line, not a stream of noise.
        let pins = (gpioa.pa0, gpioa.pa1.into_pull_up_input());
        let link = Uart::new(device.UART4, pins, (dma1.4, dma1.2), &mut rcc);
        let forces = load_cell(device.ADC1, gpioa.pa2.into_analog(), dma2.0, &mut rcc);
        // PB4 is JTAG's reset until it is taken; serial-wire debugging does not need it.
        let quadrature = (gpiob.pb4.into_alternate(), gpiob.pb5.into_alternate());
        let positions = encoder(device.TIM3, quadrature, dma1.7, &mut rcc);
        // Last: from the first event on, both streams count in step.
        events(device.TIM2, &mut rcc);
        Parts {
            sensors: LoadCellAndEncoder::new(forces, positions),
            link,
            light: gpioc.pc4.into_push_pull_output(),
            store: Store::new(Flash::new(device.FLASH), SETTINGS, SECTOR),
            watchdog: Dog(watchdog),
            clock_fallback,
        }
    }

    fn now() -> u32 {
        DWT::cycle_count()
    }

    fn idle() {
        cortex_m::asm::wfi();
    }

    fn stop(_: Outcome) -> ! {
        cortex_m::interrupt::disable();
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

/// TIM2 at 32 kHz, its update as trigger output: the trigger of the ADC and, through TIM3's
/// ITR1 (RM table 98), of the encoder's latch. 84 MHz / 32 kHz = 2625 exactly.
fn events(tim2: TIM2, rcc: &mut Rcc) {
    let mut timer = Timer::new(tim2, rcc);
    timer.set_master_mode(pac::tim2::cr2::MMS::Update);
    let mut counter = timer.counter_hz();
    // Fails only for rates that a 32-bit counter at 84 MHz cannot have.
    if counter.start(EVENT_HZ.Hz()).is_err() {
        defmt::panic!("TIM2 cannot run at {=u32} Hz", EVENT_HZ);
    }
}

/// ADC1 on PA2, one conversion per event, result by DMA2 stream 0 channel 0 (RM table 43).
///
/// 21 MHz (DS: at most 36) and 480 cycles of sampling: 23.4 µs of the 31.25 µs between events, the
/// longest that fits, so that the amplifier's filter may be as slow as 50 kΩ.
fn load_cell(
    adc: ADC1,
    pin: PA2<Analog>,
    stream: Stream0<DMA2>,
    rcc: &mut Rcc,
) -> Ring<Stream0<DMA2>> {
    let config = AdcConfig::default()
        .clock(Clock::Pclk2_div_4)
        .external_trigger(TriggerMode::RisingEdge, ExternalTrigger::Tim_2_trgo)
        .dma(Dma::Continuous);
    let mut adc = Adc::new(adc, true, config, rcc);
    adc.configure_channel(&pin, Sequence::One, SampleTime::Cycles_480);
    let mut ring = Ring::new(
        stream,
        DmaChannel::Channel0,
        adc.address(),
        &FORCES,
        Priority::VeryHigh,
    );
    ring.listen();
    ring
}

/// TIM3 counts the quadrature edges on PB4/PB5 and copies its count into CCR3 at every event;
/// DMA1 stream 7 channel 5 collects the copies (RM table 42).
fn encoder(
    tim3: TIM3,
    pins: (PB4<Alternate<2>>, PB5<Alternate<2>>),
    stream: Stream7<DMA1>,
    rcc: &mut Rcc,
) -> Ring<Stream7<DMA1>> {
    let (tim3, _) = Qei::new(tim3, pins, rcc).release();
    tim3.cr1().modify(|_, w| w.cen().clear_bit());
    // Eight equal readings at 84 MHz make an edge: spikes below 95 ns do not count, 5 MHz do.
    tim3.ccmr1_input()
        .modify(|_, w| w.ic1f().fck_int_n8().ic2f().fck_int_n8());
    // The trigger may be selected only while the slave mode is off (RM 18.4.3, TS).
    tim3.smcr().modify(|_, w| w.sms().disabled());
    tim3.smcr().modify(|_, w| w.ts().itr1());
    tim3.smcr().modify(|_, w| w.sms().encoder_mode_3());
    // Channel 3 captures on TRC, the selected internal trigger (RM 18.4.8, CC3S = 11).
    tim3.ccmr2_input().modify(|_, w| w.cc3s().trc());
    tim3.ccer().modify(|_, w| w.cc3e().set_bit());
    tim3.dier().modify(|_, w| w.cc3de().set_bit());
    tim3.cr1().modify(|_, w| w.cen().set_bit());
    let latch = tim3.ccr3().as_ptr() as u32;
    Ring::new(
        stream,
        DmaChannel::Channel5,
        latch,
        &POSITIONS,
        Priority::High,
    )
}

/// Both channels, and the time that their blocks belong to.
pub struct LoadCellAndEncoder {
    forces: Ring<Stream0<DMA2>>,
    positions: Ring<Stream7<DMA1>>,
    ticks: u64,
    /// [`F405::now`] of the last tick, had it been on time.
    on_time: Option<u32>,
    /// What the timer counted last, and what that is without its 16 bits.
    counter: u16,
    count: i32,
}

impl LoadCellAndEncoder {
    fn new(forces: Ring<Stream0<DMA2>>, positions: Ring<Stream7<DMA1>>) -> Self {
        LoadCellAndEncoder {
            forces,
            positions,
            ticks: 0,
            on_time: None,
            counter: 0,
            count: 0,
        }
    }

    /// Ticks since the last call: 1, or more if calls were missed. Core and events run from one
    /// clock, so ticks stay where the first one was; a sixteenth of slack is for a first call that
    /// came later than usual.
    fn elapsed_ticks(&mut self) -> u32 {
        let now = F405::now();
        let on_time = *self.on_time.get_or_insert(now.wrapping_sub(F405::TICK));
        let ticks = (now.wrapping_sub(on_time) + F405::TICK / 16) / F405::TICK;
        self.on_time = Some(on_time.wrapping_add(ticks * F405::TICK));
        ticks
    }

    /// The sum of the last 32 latches, in position codes. Each 16-bit count is taken on from the
    /// last: right as long as the probe moves less than 32 768 counts between two of them.
    ///
    /// The latest, not the last block: should the first event have reached only one of the two
    /// channels, they are one event (31 µs) apart instead of a block.
    fn position(&mut self) -> i32 {
        let mut sum = 0_i32;
        for count in self.positions.latest() {
            let moved = count.wrapping_sub(self.counter) as i16;
            self.counter = count;
            self.count = self.count.wrapping_add(i32::from(moved));
            sum = sum.wrapping_add(self.count);
        }
        sum
    }
}

impl Sensors for LoadCellAndEncoder {
    fn sample(&mut self) -> Acquired {
        self.forces.acknowledge();
        let ticks = self.elapsed_ticks();
        if ticks == 0 {
            return Acquired::Nothing;
        }
        self.ticks += u64::from(ticks);
        let (force, force_low, force_high) = sum_of_force(self.forces.finished());
        Acquired::Codes(Codes {
            time_us: self.ticks * u64::from(1_000_000 / RATE_HZ),
            force,
            force_low,
            force_high,
            position: self.position(),
            faults: match ticks > 1 {
                true => Faults::NONE.with(Fault::Overrun),
                false => Faults::NONE,
            },
        })
    }
}

/// The sum of a block's conversions, the lowest and the highest of them: one that stood at a rail
/// does not hide in the sum.
fn sum_of_force(conversions: impl Iterator<Item = u16>) -> (i32, i32, i32) {
    conversions
        .map(i32::from)
        .fold((0, i32::MAX, i32::MIN), |(sum, low, high), code| {
            (sum + code, low.min(code), high.max(code))
        })
}
