//! The first set of sensors: a load cell's amplifier on the ADC, and an encoder on the quadrature timer.
//!
//! In each of 32 000 periods a second the ADC holds what it has sampled of the load cell, and at the same instant
//! the encoder is latched ([`super::duty`]); DMA collects both. After 32 periods the ADC's stream raises the
//! 1 kHz interrupt. The last latch has been collected 0.6 µs before, while the ADC converted, so the sums of both
//! blocks that are full belong to the same 32 instants, however late the task reads them.
//!
//! SysTick looks after the streams: where no block ends for 1.5 ms, it raises the interrupt.

use super::Clock;
use super::clock::CORE_HZ;
use super::{event, event::PER_SAMPLE, ring, ring::Blocks, ring::Ring};
use crate::board::{Acquired, Sensors};
use crate::systick;
use cortex_m::peripheral::SYST;
use estimator_core::board::instants::{Counter, summed};
use estimator_core::board::sampling::Reading;
use estimator_core::board::sensing::{CODES_PER_COUNT, Codes};
use estimator_core::board::settings::Key;
use estimator_core::{Fault, Faults};
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
    /// SysTick looks after the streams.
    pub guard: SYST,
}

/// Milliseconds between two looks of SysTick: a stream that stops is started again within 5.5 ms.
const GUARD_MS: u32 = 4;

/// Sets both channels and the event up. Nothing moves before [`Sensors::start`].
pub fn set_up(wires: Wires, clock: Clock, rcc: &mut Rcc) -> AnalogAndQuadrature {
    let (adc, forces) = load_cell(
        wires.adc,
        wires.force.into_analog(),
        wires.force_stream,
        rcc,
    );
    let positions = encoder(wires.tim3, wires.quadrature, wires.position_stream, rcc);
    event::set_up(wires.tim2, rcc);
    AnalogAndQuadrature {
        adc,
        forces,
        positions,
        clock,
        counter: Counter::new(),
        last: Codes::default(),
        guard: Some(wires.guard),
    }
}

/// Sets ADC1 up on PA2: one conversion per event, whose result goes by DMA2 stream 0 channel 0 (RM table 43).
///
/// The ADC runs at 21 MHz (DS: at most 36) and samples for 480 cycles: with the conversion 23.4 µs of the
/// 31.25 µs between events. This is the longest time that fits; the source may have a resistance of 50 kΩ.
fn load_cell(
    adc: ADC1,
    pin: PA2<Analog>,
    stream: Stream0<DMA2>,
    rcc: &mut Rcc,
) -> (Adc<ADC1>, Ring<Stream0<DMA2>>) {
    let config = AdcConfig::default()
        .clock(config::Clock::Pclk2_div_4)
        .external_trigger(TriggerMode::RisingEdge, ExternalTrigger::Tim_2_cc_4)
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
    (adc, ring)
}

/// Sets TIM3 up: it counts the quadrature edges on PB4/PB5 and copies its count into CCR3 at every hold;
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
    adc: Adc<ADC1>,
    forces: Ring<Stream0<DMA2>>,
    positions: Ring<Stream7<DMA1>>,
    clock: Clock,
    counter: Counter,
    /// The last codes, for an instant without others.
    last: Codes,
    guard: Option<SYST>,
}

impl AnalogAndQuadrature {
    /// Starts both streams and then the event, so that both count from the same one. The converter is switched off
    /// and on in between: a conversion that is underway, or one that nobody fetched (RM 13.8.1), would be the
    /// first value of the block.
    fn start_streams(&mut self) {
        event::stop();
        // SAFETY: the sensors own the converter.
        let adc = unsafe { &*ADC1::ptr() };
        adc.cr2()
            .modify(|_, w| w.adon().clear_bit().dma().clear_bit());
        // Nothing that was converted before is left, and no overrun: all flags are cleared by 0.
        // SAFETY: the flags are the only bits.
        adc.sr().write(|w| unsafe { w.bits(0) });
        self.forces.start();
        self.positions.start();
        adc.cr2().modify(|_, w| w.dma().set_bit());
        // It is ready after 3 µs (DS table 67); the first conversion is triggered after 5.
        self.adc.enable();
        event::start();
        self.clock.resume();
    }

    /// Returns the faults of both channels since the last block.
    fn faults(&mut self) -> Faults {
        // SAFETY: reading a register changes nothing.
        let overrun = unsafe { &*ADC1::ptr() }.sr().read().ovr().bit_is_set();
        let positions_ended = self.positions.has_ended();
        let mut faults = Faults::NONE;
        if overrun || !self.forces.runs() {
            faults = faults.with(Fault::ForceUnusable);
        }
        let in_step = self.forces.in_step_with(&self.positions);
        if !positions_ended || !self.positions.runs() || !in_step {
            faults = faults.with(Fault::PositionUnusable);
        }
        faults
    }

    /// Returns the sums of the blocks that are full. Each 16-bit count continues the one before it, which is right
    /// as long as the probe moves less than 32 768 counts between two of them; where ticks are missing, the core says
    /// whether it may have moved more ([`Sensors::COUNTS`]).
    fn read(&mut self) -> Codes {
        let (force, force_low, force_high) = summed(self.forces.finished());
        let mut position = 0_i32;
        for count in self.positions.finished() {
            position = position.wrapping_add(self.counter.follow(count));
        }
        Codes {
            force,
            force_low,
            force_high,
            position,
            ..Codes::default()
        }
    }
}

impl Sensors for AnalogAndQuadrature {
    // TIM3 has 16 bits.
    const COUNTS: u32 = 1 << 16;

    fn start(&mut self) {
        if let Some(guard) = self.guard.take() {
            systick::start(guard, CORE_HZ, GUARD_MS);
            // Its looks come in the middle of a tick, not together with the end of a block.
            cortex_m::asm::delay(CORE_HZ / 1000 * 3 / 5);
        }
        self.start_streams();
    }

    fn sample(&mut self) -> Acquired {
        let ended = self.forces.has_ended();
        if !ended && !self.clock.is_overdue() {
            return Acquired::Nothing;
        }
        let Some(at) = self.clock.tick() else {
            return Acquired::Nothing;
        };
        let stopped = match ended {
            true => self.faults(),
            false => Faults::NONE.with(Fault::ForceUnusable),
        };
        if stopped == Faults::NONE {
            self.last = self.read();
        } else {
            self.start_streams();
        }
        let codes = Codes {
            time_us: at.time_us,
            faults: at.faults | stopped,
            ..self.last
        };
        Acquired::Reading(Reading::Codes(codes), at.due)
    }
}
