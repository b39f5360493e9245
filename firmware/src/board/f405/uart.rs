//! Telemetry and commands on UART4, both by DMA. Frames go out of a ring: the stream sends one stretch of
//! it after the other, and the interrupt at a stretch's end starts the next, so that the line is busy as long as
//! something waits. Commands come into a ring that the DMA fills without end and [`Link::receive`] follows.

use crate::board::Link;
use core::sync::atomic::{AtomicU8, Ordering, fence};
use cortex_m::peripheral::NVIC;
use estimator_core::board::link::BAUD;
use estimator_core::board::outbox::Outbox;
use stm32f4xx_hal::dma::config::Priority;
use stm32f4xx_hal::dma::traits::{PeriAddress, Stream};
use stm32f4xx_hal::dma::{DmaChannel, DmaDataSize, DmaDirection, Stream2, Stream4};
use stm32f4xx_hal::gpio::{PA0, PA1};
use stm32f4xx_hal::pac::{DMA1, Interrupt, NVIC_PRIO_BITS, UART4};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::serial::{Rx, Serial, Tx, config};

/// Bytes of the ring of commands. The longest command, an impedance to render, has 72 bytes, and telemetry looks
/// every millisecond, in which 200 can come. A host waits for the answer before its next command.
const INBOX: usize = 256;

/// The priority of the interrupt that starts the next stretch, as RTIC counts: above the telemetry task, below
/// the sampling task, which makes it wait for 50 µs at most.
const PRIORITY: u8 = 2;

/// All flags of stream 4 in DMA_HIFCR (RM 10.5.4).
const STREAM4_FLAGS: u32 = 0x3d;

// The divider is exact: 42 MHz / 16 / 2 Mbaud = 1 5/16.
const _: () = assert!(42_000_000 % BAUD == 0);

/// The ring is atomic, since the DMA writes it without the compiler's knowledge.
static RECEIVED: [AtomicU8; INBOX] = [const { AtomicU8::new(0) }; INBOX];

/// The telemetry task writes, the interrupt below sends.
static OUTBOX: Outbox = Outbox::new();

/// Starts the next stretch unless one is underway. Raised at the end of a stretch, also by an error of the
/// stream, which switches it off, and by [`Link::poll`].
#[unsafe(no_mangle)]
extern "C" fn DMA1_STREAM4() {
    // SAFETY: after the start only this handler touches stream 4 and its flags.
    let dma = unsafe { &*DMA1::ptr() };
    let stream = dma.st(4);
    if stream.cr().read().en().bit_is_set() {
        return;
    }
    // SAFETY: the bits are those of stream 4 (RM 10.5.4); a stretch is static memory that stays as it is until
    // the stream has sent it.
    unsafe {
        dma.hifcr().write(|w| w.bits(STREAM4_FLAGS));
        if let Some(stretch) = OUTBOX.next_stretch() {
            stream.m0ar().write(|w| w.bits(stretch.as_ptr() as u32));
            stream.ndtr().write(|w| w.bits(stretch.len() as u32));
            stream.cr().modify(|_, w| w.en().set_bit());
        }
    }
}

/// The serial link.
pub struct Uart {
    received: Stream2<DMA1>,
    /// Index in [`RECEIVED`] of the next byte to fetch.
    fetched: usize,
}

/// Sets up the stream of the frames: DMA1 stream 4 channel 4 (RM table 42), byte by byte, with its interrupt.
fn send(tx: &Tx<UART4>, mut stream: Stream4<DMA1>) {
    stream.set_channel(DmaChannel::Channel4);
    stream.set_direction(DmaDirection::MemoryToPeripheral);
    stream.set_peripheral_address(tx.address());
    stream.set_memory_increment(true);
    stream.set_peripheral_increment(false);
    stream.set_fifo_enable(false);
    stream.set_priority(Priority::Low);
    stream.listen_transfer_complete();
    stream.listen_transfer_error();
    let priority = (1 << NVIC_PRIO_BITS) - PRIORITY;
    // SAFETY: the sizes are those of the register and the ring. The interrupt is the handler's above, which
    // takes nothing that another task owns.
    unsafe {
        stream.set_memory_size(DmaDataSize::Byte);
        stream.set_peripheral_size(DmaDataSize::Byte);
        let mut nvic = cortex_m::Peripherals::steal().NVIC;
        nvic.set_priority(Interrupt::DMA1_STREAM4, priority << (8 - NVIC_PRIO_BITS));
        NVIC::unmask(Interrupt::DMA1_STREAM4);
    }
}

/// Starts the stream of the commands: DMA1 stream 2 channel 4 (RM table 42), circular, byte by byte.
fn receive(rx: &Rx<UART4>, mut stream: Stream2<DMA1>) -> Stream2<DMA1> {
    stream.set_channel(DmaChannel::Channel4);
    stream.set_direction(DmaDirection::PeripheralToMemory);
    stream.set_peripheral_address(rx.address());
    stream.set_memory_address(RECEIVED.as_ptr() as u32);
    stream.set_number_of_transfers(INBOX as u16);
    stream.set_memory_increment(true);
    stream.set_peripheral_increment(false);
    stream.set_circular_mode(true);
    stream.set_fifo_enable(false);
    // SAFETY: the memory is static and has a byte for each transfer; nothing else uses the stream.
    unsafe {
        stream.set_memory_size(DmaDataSize::Byte);
        stream.set_peripheral_size(DmaDataSize::Byte);
        stream.enable();
    }
    stream
}

impl Uart {
    /// Starts UART4: it transmits on PA0 by DMA1 stream 4 channel 4 (RM table 42) and receives on PA1.
    pub fn new(
        uart: UART4,
        pins: (PA0, PA1),
        (out, inbox): (Stream4<DMA1>, Stream2<DMA1>),
        rcc: &mut Rcc,
    ) -> Self {
        let config = config::Config::default()
            .baudrate(BAUD.bps())
            .dma(config::DmaConfig::TxRx);
        let Ok(serial) = Serial::<UART4, u8>::new(uart, pins, config, rcc) else {
            defmt::panic!("UART4 cannot run at {=u32} baud", BAUD);
        };
        let (tx, rx) = serial.split();
        send(&tx, out);
        // A zero ends a frame: a host that listens already is in step from here on.
        OUTBOX.write(&[0]);
        Uart {
            received: receive(&rx, inbox),
            fetched: 0,
        }
    }
}

impl Link for Uart {
    fn room(&self) -> usize {
        OUTBOX.room()
    }

    fn send(&mut self, bytes: &[u8]) {
        OUTBOX.write(bytes);
    }

    fn poll(&mut self) {
        NVIC::pend(Interrupt::DMA1_STREAM4);
    }

    fn receive(&mut self) -> Option<u8> {
        // The stream counts the bytes that are left of the ring down to 1 and starts again at INBOX.
        let filled = INBOX - usize::from(self.received.number_of_transfers());
        if self.fetched == filled % INBOX {
            return None;
        }
        // The byte is read after the count that says that it is there.
        fence(Ordering::Acquire);
        let byte = RECEIVED[self.fetched].load(Ordering::Relaxed);
        self.fetched = (self.fetched + 1) % INBOX;
        Some(byte)
    }

    fn finish(&mut self) {
        while OUTBOX.waiting() > 0 {
            self.poll();
        }
    }
}
