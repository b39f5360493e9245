//! Telemetry on UART4, sent by DMA from two chunks: one goes out, the other fills.

use crate::board::Link;
use cortex_m::singleton;
use embedded_dma::ReadBuffer;
use stm32f4xx_hal::dma::config::DmaConfig;
use stm32f4xx_hal::dma::{DmaFlag, MemoryToPeripheral, Stream4, Transfer};
use stm32f4xx_hal::gpio::PA0;
use stm32f4xx_hal::pac::{DMA1, UART4};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::serial::{Tx, config};

/// 200 bytes per millisecond; a sample with its estimate is at most 182 (frame.rs).
/// 42 MHz / 16 / 2 Mbaud = 1 5/16: exact.
const BAUD: u32 = 2_000_000;

/// 2.5 ms at full speed.
const CHUNK: usize = 512;

/// Bytes that DMA may read: they stay where they are.
pub struct Chunk {
    bytes: &'static mut [u8; CHUNK],
    length: usize,
}

// SAFETY: the bytes are static and `length` is at most their number; while the DMA reads them, the
// transfer owns the chunk.
unsafe impl ReadBuffer for Chunk {
    type Word = u8;

    unsafe fn read_buffer(&self) -> (*const u8, usize) {
        (self.bytes.as_ptr(), self.length)
    }
}

/// The link.
pub struct Uart {
    transfer: Transfer<Stream4<DMA1>, 4, Tx<UART4>, MemoryToPeripheral, Chunk>,
    /// `None` only within [`Link::poll`].
    filling: Option<Chunk>,
}

impl Uart {
    /// UART4 transmits on PA0, DMA1 stream 4 channel 4 (RM table 42).
    pub fn new(uart: UART4, pin: PA0, stream: Stream4<DMA1>, rcc: &mut Rcc) -> Self {
        let config = config::Config::default()
            .baudrate(BAUD.bps())
            .dma(config::DmaConfig::Tx);
        let Ok(tx) = uart.tx(pin, config, rcc) else {
            defmt::panic!("UART4 cannot run at {=u32} baud", BAUD);
        };
        let (Some(first), Some(second)) = (
            singleton!(: [u8; CHUNK] = [0; CHUNK]),
            singleton!(: [u8; CHUNK] = [0; CHUNK]),
        ) else {
            defmt::panic!("the board was started twice");
        };
        // One zero, the end of a frame: whoever listens already is in step from here on.
        let opening = Chunk {
            bytes: first,
            length: 1,
        };
        let config = DmaConfig::default().memory_increment(true);
        let mut transfer = Transfer::init_memory_to_peripheral(stream, tx, opening, None, config);
        transfer.start(|_| {});
        Uart {
            transfer,
            filling: Some(Chunk {
                bytes: second,
                length: 0,
            }),
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
            // Only for double-buffered transfers, which this is not; the bytes are lost, the
            // sequence numbers show it.
            Err(error) => Chunk {
                length: 0,
                ..chunk_of(error)
            },
        });
    }

    fn finish(&mut self) {
        self.poll();
        self.transfer.wait();
    }
}

fn chunk_of(error: stm32f4xx_hal::dma::DMAError<Chunk>) -> Chunk {
    use stm32f4xx_hal::dma::DMAError::{NotReady, Overrun, SmallBuffer};
    match error {
        NotReady(chunk) | SmallBuffer(chunk) | Overrun(chunk) => chunk,
    }
}
