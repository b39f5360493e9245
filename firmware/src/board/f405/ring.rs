//! Two blocks that a DMA stream fills in turn, for ever: while one is filled, the other is read.
//!
//! The HAL's `Transfer` wants a buffer handed over for every block; a call that comes late then
//! stops the stream. Here a late call loses a block and nothing else.

use super::analog::OVERSAMPLING;
use core::sync::atomic::{AtomicU16, Ordering};
use stm32f4xx_hal::dma::config::Priority;
use stm32f4xx_hal::dma::traits::{Stream, StreamISR};
use stm32f4xx_hal::dma::{CurrentBuffer, DmaChannel, DmaDataSize, DmaDirection};

/// The values of one sample. Atomic, since the DMA writes behind the compiler's back.
type Block = [AtomicU16; OVERSAMPLING as usize];

/// Both blocks.
pub type Memory = [Block; 2];

/// Memory for a ring, for a static.
pub const fn memory() -> Memory {
    [const { [const { AtomicU16::new(0) }; OVERSAMPLING as usize] }; 2]
}

/// A stream that runs.
pub struct Ring<S> {
    stream: S,
    memory: &'static Memory,
}

impl<S: Stream + StreamISR> Ring<S> {
    /// Starts moving 16-bit values from `peripheral` whenever it asks on `channel`.
    ///
    /// Double-buffer mode (RM 10.3.10): the stream changes the block by itself. No FIFO (direct
    /// mode): a value is in memory before the next comes.
    pub fn new(
        mut stream: S,
        channel: DmaChannel,
        peripheral: u32,
        memory: &'static Memory,
        priority: Priority,
    ) -> Self {
        stream.set_channel(channel);
        stream.set_direction(DmaDirection::PeripheralToMemory);
        stream.set_peripheral_address(peripheral);
        stream.set_memory_address(memory[0].as_ptr() as u32);
        stream.set_alternate_memory_address(memory[1].as_ptr() as u32);
        stream.set_number_of_transfers(OVERSAMPLING);
        stream.set_memory_increment(true);
        stream.set_peripheral_increment(false);
        stream.set_double_buffer(true);
        stream.set_fifo_enable(false);
        stream.set_priority(priority);
        // SAFETY: blocks and both registers (ADC_DR, TIM3_CCR3) are 16 bits wide, the memory is
        // static, and nothing else uses the stream: `self` owns it.
        unsafe {
            stream.set_memory_size(DmaDataSize::HalfWord);
            stream.set_peripheral_size(DmaDataSize::HalfWord);
            stream.enable();
        }
        Ring { stream, memory }
    }

    /// Raises the stream's interrupt after every block.
    pub fn listen(&mut self) {
        self.stream.listen_transfer_complete();
    }

    /// Takes the interrupt's request back. Before [`Ring::finished`], so that a block that ends in
    /// between raises it again.
    pub fn acknowledge(&mut self) {
        self.stream.clear_transfer_complete();
    }

    /// The block that is not being filled. Valid for the 1 ms that the other one takes.
    pub fn finished(&self) -> impl Iterator<Item = u16> + use<S> {
        let block = match self.stream.current_buffer() {
            CurrentBuffer::FirstBuffer => &self.memory[1],
            CurrentBuffer::SecondBuffer => &self.memory[0],
        };
        block.iter().map(|value| value.load(Ordering::Relaxed))
    }

    /// The last values, as many as a block has, wherever blocks begin. Valid for 1 ms.
    pub fn latest(&self) -> impl Iterator<Item = u16> + use<S> {
        const BLOCK: usize = OVERSAMPLING as usize;
        let values = self.memory.as_flattened();
        let oldest = self.next() + values.len() - BLOCK;
        (0..BLOCK).map(move |i| values[(oldest + i) % (2 * BLOCK)].load(Ordering::Relaxed))
    }

    /// Where the next value goes, counted over both blocks.
    fn next(&self) -> usize {
        loop {
            let before = self.stream.current_buffer();
            let left = self.stream.number_of_transfers();
            // A block that ends between the two reads does so once in a millisecond.
            if self.stream.current_buffer() == before {
                let start = match before {
                    CurrentBuffer::FirstBuffer => 0,
                    CurrentBuffer::SecondBuffer => OVERSAMPLING,
                };
                return usize::from(start + OVERSAMPLING.saturating_sub(left));
            }
        }
    }
}
