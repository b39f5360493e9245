//! The force output: PWM at 32 kHz on PB3, channel 2 of the timer that also triggers the conversions, with a
//! dead-man in hardware.
//!
//! At each period DMA1 stream 1 writes the compare register from a list: the code, 55 times, and then the code of
//! 0 N. Every tick starts the list anew. When no tick comes for whatever reason, its end puts the output to rest
//! 1.75 ms after the last one, and no instruction is needed for it.
//!
//! The DAC cannot serve: its pins, PA4 and PA5, are thermistors on the ODrive. Nor can PA15, the timer's
//! channel 1: after a reset it belongs to JTAG and is pulled up, 0.6 V over 10 kΩ; PB3 floats.

use super::duty::{PERIOD, Pulse};
use crate::board::ForceOutput;
use core::sync::atomic::{AtomicU32, Ordering, fence};
use estimator_core::board::sampling::FULL;
use stm32f4xx_hal::dma::config::Priority;
use stm32f4xx_hal::dma::traits::Stream;
use stm32f4xx_hal::dma::{DmaChannel, DmaDataSize, DmaDirection, Stream1};
use stm32f4xx_hal::gpio::{Alternate, PB3};
use stm32f4xx_hal::pac::{DMA1, GPIOB, TIM2, tim2};

const _: () = assert!(PERIOD == FULL);

/// Entries of the list, one a period: 1.75 ms, and 31 µs until the last counts. A tick may be 0.75 ms late.
const ENTRIES: usize = 56;
/// All flags of stream 1 in DMA_LIFCR (RM 10.5.3).
const STREAM1_FLAGS: u32 = 0xf40;

/// The list. The DMA reads it without the compiler's knowledge.
static LIST: [AtomicU32; ENTRIES] = [const { AtomicU32::new(0) }; ENTRIES];

/// The PWM output. Nothing else uses channel 2 of its timer, nor DMA1 stream 1.
pub struct Pwm {
    pulse: Pulse,
    /// What the list has: edge and edge at rest. `None` before the first code.
    listed: Option<(u16, u16)>,
}

impl Pwm {
    /// Takes the pin, which floats as after a reset until the first [`ForceOutput::put`], and the stream on the
    /// timer's update: channel 3 (RM table 42).
    pub fn new(_: PB3<Alternate<1>>, mut stream: Stream1<DMA1>) -> Self {
        // SAFETY: only the bits of channel 2 and of the update's request change, which belong to this output.
        let tim2 = unsafe { &*TIM2::ptr() };
        // RM 18.4.7: the pin is high while the count is below CCR2; a new CCR2 counts from the next period on.
        tim2.ccmr1_output()
            .modify(|_, w| w.oc2m().pwm_mode1().oc2pe().enabled());
        tim2.dier().modify(|_, w| w.ude().set_bit());
        stream.set_channel(DmaChannel::Channel3);
        stream.set_direction(DmaDirection::MemoryToPeripheral);
        stream.set_peripheral_address(tim2.ccr2().as_ptr() as u32);
        stream.set_memory_address(LIST.as_ptr() as u32);
        stream.set_memory_increment(true);
        stream.set_peripheral_increment(false);
        stream.set_fifo_enable(false);
        stream.set_priority(Priority::Medium);
        // SAFETY: list and register are 32 bits wide, and the list is static.
        unsafe {
            stream.set_memory_size(DmaDataSize::Word);
            stream.set_peripheral_size(DmaDataSize::Word);
        }
        Pwm {
            pulse: Pulse::default(),
            listed: None,
        }
    }

    /// Lets the pin float, whatever was put out: the channel is off, and the pin is an input, should it ever have
    /// another function than the timer's. Any code may call this.
    pub fn float() {
        // SAFETY: only the bit that turns channel 2 off changes, and the pin's mode; whoever calls this does not go on.
        let (tim2, gpiob) = unsafe { (&*TIM2::ptr(), &*GPIOB::ptr()) };
        tim2.ccer().modify(|_, w| w.cc2e().clear_bit());
        gpiob.moder().modify(|_, w| w.moder3().input());
    }

    /// Turns channel 2 on with a code's edge. A preloaded one would count from the next period on, and until then
    /// the output would be 0 % whatever stands for 0 N.
    fn begin(tim2: &tim2::RegisterBlock, edge: u16) {
        tim2.ccmr1_output().modify(|_, w| w.oc2pe().disabled());
        // SAFETY: the value is a count of the timer.
        tim2.ccr2().write(|w| unsafe { w.bits(edge.into()) });
        tim2.ccmr1_output().modify(|_, w| w.oc2pe().enabled());
        tim2.ccer().modify(|_, w| w.cc2e().set_bit());
    }

    /// Starts the list from its first entry.
    fn restart_list() {
        // SAFETY: nothing else uses stream 1; its flags have bits of their own. The list is static.
        let dma = unsafe { &*DMA1::ptr() };
        let stream = dma.st(1);
        stream.cr().modify(|_, w| w.en().clear_bit());
        // The stream finishes a transfer first (RM 10.3.14), which takes some cycles.
        for _ in 0..32 {
            if stream.cr().read().en().bit_is_clear() {
                break;
            }
        }
        // SAFETY: the flags are those of stream 1, the list has so many entries.
        unsafe {
            dma.lifcr().write(|w| w.bits(STREAM1_FLAGS));
            stream.ndtr().write(|w| w.bits(ENTRIES as u32));
        }
        // What the list has is in memory before the stream reads it.
        fence(Ordering::Release);
        stream.cr().modify(|_, w| w.en().set_bit());
    }
}

impl ForceOutput for Pwm {
    /// With this code the pin is always high: it is the timer's period ([`super::event`]).
    const FULL: u16 = FULL;

    fn put(&mut self, code: u16, rest: u16) {
        let before = self.pulse;
        let at_end = self.pulse.place(code);
        let edges = (self.pulse.edge(code), self.pulse.edge(rest));
        let last = self.listed.replace(edges);
        if last != Some(edges) {
            let (edge, at_rest) = edges;
            for entry in &LIST {
                entry.store(edge.into(), Ordering::Relaxed);
            }
            if let Some(last) = LIST.last() {
                last.store(at_rest.into(), Ordering::Relaxed);
            }
        }
        Pwm::restart_list();
        // SAFETY: only bits of channel 2 change, which belongs to this output alone.
        let tim2 = unsafe { &*TIM2::ptr() };
        if self.pulse != before {
            tim2.ccmr1_output().modify(|_, w| match at_end {
                false => w.oc2m().pwm_mode1(),
                true => w.oc2m().pwm_mode2(),
            });
        }
        if last.is_none() {
            Pwm::begin(tim2, edges.0);
        }
    }

    fn rested(&mut self) -> bool {
        // SAFETY: reading a register of the stream changes nothing.
        let stopped = unsafe { &*DMA1::ptr() }
            .st(1)
            .cr()
            .read()
            .en()
            .bit_is_clear();
        stopped && self.listed.is_some()
    }
}
