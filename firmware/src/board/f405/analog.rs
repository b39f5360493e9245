//! The first set of sensors: a load cell's amplifier on the ADC, and an encoder on the quadrature timer.
//!
//! One timer event, 32 000 times a second, starts a conversion of the load cell and latches the
//! encoder; DMA collects both. After 32 events the ADC's stream raises the 1 kHz interrupt, and
//! the sums of both channels belong to the same 32 instants.

use super::Clock;
use super::{event, event::PER_SAMPLE, ring, ring::Blocks, ring::Ring};
use crate::board::{Acquired, Sensors};
use estimator_core::board::instants::{Counter, summed};
use estimator_core::board::sampling::Reading;
use estimator_core::board::sensing::{CODES_PER_COUNT, Codes};
use estimator_core::board::settings::Key;
use stm32f4xx_hal::adc::Adc;
use stm32f4xx_hal::adc::config::{
    self, AdcConfig, Dma, ExternalTrigger, SampleTime, Sequence, TriggerMode,
};
use stm32f4xx_hal::dma::config::Priority;
use stm32f4xx_hal::dma::traits::PeriAddress;
use stm32f4xx_hal::dma::{DmaChannel, Stream0, Stream7};
use stm32f4xx_hal::gpio::{Alternate, Analog, PA2, PB4, PB5};
use stm32f4xx_hal::pac::{ADC1, DMA1, DMA2, TIM2, TIM3};
use stm32f4xx_hal::qei::Qei;
use stm32f4xx_hal::rcc::Rcc;

/// Conversions that are summed into one sample: 32 kHz down to 1 kHz. The sum is not divided: 12 bits
/// become 17, and the noise of the mean drops by √32. The encoder's latches are summed as well.
pub const OVERSAMPLING: u16 = PER_SAMPLE;
// The settings have the defaults of this wiring: 0 N is at half the range of the sum.
const _: () = assert!(Key::ForceZeroCode.info().default == 2048.0 * OVERSAMPLING as f32);
const _: () = assert!(CODES_PER_COUNT == OVERSAMPLING as i32);

static FORCES: Blocks = ring::blocks();
static POSITIONS: Blocks = ring::blocks();

/// The timers and the converter with their streams and pins.
pub struct Wires {
    /// The load cell's amplifier is on PA2.
    pub force: PA2,
    /// The encoder's A and B are on PB4 and PB5.
    pub quadrature: (PB4<Alternate<2>>, PB5<Alternate<2>>),
    /// This stream collects the ADC's conversions.
    pub force_stream: Stream0<DMA2>,
    /// This stream collects the encoder's latches.
    pub position_stream: Stream7<DMA1>,
    /// The ADC converts the load cell's signal.
    pub adc: ADC1,
    /// TIM2 makes the event.
    pub tim2: TIM2,
    /// TIM3 counts the encoder's edges.
    pub tim3: TIM3,
}

/// Starts both channels and then the event: from the first event on, both streams count in step.
pub fn start(wires: Wires, clock: Clock, rcc: &mut Rcc) -> AnalogAndQuadrature {
    let forces = load_cell(
        wires.adc,
        wires.force.into_analog(),
        wires.force_stream,
        rcc,
    );
    let positions = encoder(wires.tim3, wires.quadrature, wires.position_stream, rcc);
    event::start(wires.tim2, rcc);
    AnalogAndQuadrature {
        forces,
        positions,
        clock,
        counter: Counter::new(),
    }
}

/// Sets ADC1 up on PA2: one conversion per event, whose result goes by DMA2 stream 0 channel 0 (RM table 43).
///
/// The ADC runs at 21 MHz (DS: at most 36) and samples for 480 cycles: 23.4 µs of the 31.25 µs between
/// events. This is the longest time that fits; the source may have a resistance of 50 kΩ.
fn load_cell(
    adc: ADC1,
    pin: PA2<Analog>,
    stream: Stream0<DMA2>,
    rcc: &mut Rcc,
) -> Ring<Stream0<DMA2>> {
    let config = AdcConfig::default()
        .clock(config::Clock::Pclk2_div_4)
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

/// Sets TIM3 up: it counts the quadrature edges on PB4/PB5 and copies its count into CCR3 at every event;
/// DMA1 stream 7 channel 5 collects the copies (RM table 42).
fn encoder(
    tim3: TIM3,
    pins: (PB4<Alternate<2>>, PB5<Alternate<2>>),
    stream: Stream7<DMA1>,
    rcc: &mut Rcc,
) -> Ring<Stream7<DMA1>> {
    let (tim3, _) = Qei::new(tim3, pins, rcc).release();
    tim3.cr1().modify(|_, w| w.cen().clear_bit());
    // Eight equal readings at 84 MHz make an edge: spikes below 95 ns are ignored, 5 MHz passes.
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

/// Both channels, with the clock that stamps their blocks.
pub struct AnalogAndQuadrature {
    forces: Ring<Stream0<DMA2>>,
    positions: Ring<Stream7<DMA1>>,
    clock: Clock,
    counter: Counter,
}

impl AnalogAndQuadrature {
    /// Returns the sum of the last 32 latches, in position codes. Each 16-bit count continues the one before
    /// it, which is right as long as the probe moves less than 32 768 counts between two of them.
    ///
    /// The sum is over the latest values and not over the last block: if the first event reached only one of
    /// the two channels, they are one event (31 µs) apart instead of a block.
    fn position(&mut self) -> i32 {
        let mut sum = 0_i32;
        for count in self.positions.latest() {
            sum = sum.wrapping_add(self.counter.follow(count));
        }
        sum
    }
}

impl Sensors for AnalogAndQuadrature {
    fn sample(&mut self) -> Acquired {
        self.forces.acknowledge();
        let Some((time_us, faults)) = self.clock.tick() else {
            return Acquired::Nothing;
        };
        let (force, force_low, force_high) = summed(self.forces.finished());
        Acquired::Reading(Reading::Codes(Codes {
            time_us,
            force,
            force_low,
            force_high,
            position: self.position(),
            faults,
        }))
    }
}
