//! Telemetry and commands on UART4, both by DMA. Frames go out from two chunks: one is sent while the other
//! fills. Commands come into a ring that the DMA fills without end and [`Link::receive`] follows.

use crate::board::Link;
use core::sync::atomic::{AtomicU8, Ordering};
use cortex_m::singleton;
use embedded_dma::ReadBuffer;
use estimator_core::board::link::BAUD;
use stm32f4xx_hal::dma::config::DmaConfig;
use stm32f4xx_hal::dma::traits::{PeriAddress, Stream};
use stm32f4xx_hal::dma::{DmaChannel, DmaDataSize, DmaDirection, DmaFlag, MemoryToPeripheral};
use stm32f4xx_hal::dma::{Stream2, Stream4, Transfer};
use stm32f4xx_hal::gpio::{PA0, PA1};
use stm32f4xx_hal::pac::{DMA1, UART4};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::serial::{Rx, Serial, Tx, config};

/// Bytes of a chunk: 2.5 ms at full speed.
const CHUNK: usize = 512;

/// Bytes of the ring of commands. The longest command has 15 bytes, and telemetry looks every
/// millisecond, in which 200 can come. A host waits for the answer before its next command.
const INBOX: usize = 256;

// The divider is exact: 42 MHz / 16 / 2 Mbaud = 1 5/16.
const _: () = assert!(42_000_000 % BAUD == 0);

/// The ring is atomic, since the DMA writes it without the compiler's knowledge.
static RECEIVED: [AtomicU8; INBOX] = [const { AtomicU8::new(0) }; INBOX];

/// A buffer that the DMA may read, since it never moves.
pub struct Chunk {
    bytes: &'static mut [u8; CHUNK],
    length: usize,
}

// SAFETY: the bytes are static and `length` is at most their number. While the DMA reads them, the
// transfer owns the chunk.
unsafe impl ReadBuffer for Chunk {
    type Word = u8;

    unsafe fn read_buffer(&self) -> (*const u8, usize) {
        (self.bytes.as_ptr(), self.length)
    }
}

/// The serial link.
pub struct Uart {
    transfer: Transfer<Stream4<DMA1>, 4, Tx<UART4>, MemoryToPeripheral, Chunk>,
    /// The chunk that fills; it is `None` only within [`Link::poll`].
    filling: Option<Chunk>,
    received: Stream2<DMA1>,
    /// Index in [`RECEIVED`] of the next byte to fetch.
    fetched: usize,
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
        let (Some(first), Some(second)) = (
            singleton!(: [u8; CHUNK] = [0; CHUNK]),
            singleton!(: [u8; CHUNK] = [0; CHUNK]),
        ) else {
            defmt::panic!("the board was started twice");
        };
        // A zero ends a frame: a host that listens already is in step from here on.
        let opening = Chunk {
            bytes: first,
            length: 1,
        };
        let config = DmaConfig::default().memory_increment(true);
        let mut transfer = Transfer::init_memory_to_peripheral(out, tx, opening, None, config);
        transfer.start(|_| {});
        Uart {
            transfer,
            filling: Some(Chunk {
                bytes: second,
                length: 0,
            }),
            received: receive(&rx, inbox),
            fetched: 0,
        }
    }
}

impl Link for Uart {
    fn room(&self) -> usize {
        self.filling
            .as_ref()
            .map_or(0, |chunk| CHUNK - chunk.length)
    }

    fn send(&mut self, bytes: &[u8]) {
        let Some(chunk) = &mut self.filling else {
            return;
        };
        for (slot, byte) in chunk.bytes[chunk.length..].iter_mut().zip(bytes) {
            *slot = *byte;
            chunk.length += 1;
        }
    }

    fn poll(&mut self) {
        if !self.transfer.flags().contains(DmaFlag::TransferComplete) {
            return;
        }
        let Some(chunk) = self.filling.take_if(|chunk| chunk.length > 0) else {
            return;
        };
        self.filling = Some(match self.transfer.next_transfer(chunk) {
            Ok((sent, _)) => Chunk { length: 0, ..sent },
            // Only double-buffered transfers fail, and this is none. The bytes would be lost, and the
            // sequence numbers would show it.
            Err(error) => Chunk {
                length: 0,
                ..chunk_of(error)
            },
        });
    }

    fn receive(&mut self) -> Option<u8> {
        // The stream counts the bytes that are left of the ring down to 1 and starts again at INBOX.
        let filled = INBOX - usize::from(self.received.number_of_transfers());
        if self.fetched == filled % INBOX {
            return None;
        }
        let byte = RECEIVED[self.fetched].load(Ordering::Relaxed);
        self.fetched = (self.fetched + 1) % INBOX;
        Some(byte)
    }

    fn finish(&mut self) {
        self.poll();
        self.transfer.wait();
    }
}

/// Returns the chunk that an error hands back.
fn chunk_of(error: stm32f4xx_hal::dma::DMAError<Chunk>) -> Chunk {
    use stm32f4xx_hal::dma::DMAError::{NotReady, Overrun, SmallBuffer};
    match error {
        NotReady(chunk) | SmallBuffer(chunk) | Overrun(chunk) => chunk,
    }
}
