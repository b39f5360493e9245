//! A ring of two blocks that a DMA stream fills in turn without end: while it fills one, the other is read.
//!
//! The HAL's `Transfer` wants a buffer handed over for every block, and a call that comes late then
//! stops the stream. Here a late call only loses a block.

use super::analog::OVERSAMPLING;
use core::sync::atomic::{AtomicU16, Ordering};
use stm32f4xx_hal::dma::config::Priority;
use stm32f4xx_hal::dma::traits::{Stream, StreamISR};
use stm32f4xx_hal::dma::{CurrentBuffer, DmaChannel, DmaDataSize, DmaDirection};

/// The values of one sample. They are atomic, since the DMA writes them without the compiler's knowledge.
type Block = [AtomicU16; OVERSAMPLING as usize];

/// The memory of a ring.
pub type Blocks = [Block; 2];

/// Returns the initial value of a static of [`Blocks`].
pub const fn blocks() -> Blocks {
    [const { [const { AtomicU16::new(0) }; OVERSAMPLING as usize] }; 2]
}

/// A running stream with its ring.
pub struct Ring<S> {
    stream: S,
    blocks: &'static Blocks,
}

impl<S: Stream + StreamISR> Ring<S> {
    /// Starts moving 16-bit values from the register `peripheral` whenever it asks on `channel`.
    ///
    /// In double-buffer mode (RM 10.3.10) the stream changes the block by itself. In direct mode, without
    /// the FIFO, a value is in memory before the next comes.
    pub fn new(
        mut stream: S,
        channel: DmaChannel,
        peripheral: u32,
        blocks: &'static Blocks,
        priority: Priority,
    ) -> Self {
        stream.set_channel(channel);
        stream.set_direction(DmaDirection::PeripheralToMemory);
        stream.set_peripheral_address(peripheral);
        stream.set_memory_address(blocks[0].as_ptr() as u32);
        stream.set_alternate_memory_address(blocks[1].as_ptr() as u32);
        stream.set_number_of_transfers(OVERSAMPLING);
        stream.set_memory_increment(true);
        stream.set_peripheral_increment(false);
        stream.set_double_buffer(true);
        stream.set_fifo_enable(false);
        stream.set_priority(priority);
        // SAFETY: values and both registers (ADC_DR, TIM3_CCR3) are 16 bits wide, the memory is
        // static, and nothing else uses the stream, since `self` owns it.
        unsafe {
            stream.set_memory_size(DmaDataSize::HalfWord);
            stream.set_peripheral_size(DmaDataSize::HalfWord);
            stream.enable();
        }
        Ring { stream, blocks }
    }

    /// Raises the stream's interrupt after every block.
    pub fn listen(&mut self) {
        self.stream.listen_transfer_complete();
    }

    /// Clears the interrupt's request. Call this before [`Ring::finished`]: a block that ends in between
    /// then raises it again.
    pub fn acknowledge(&mut self) {
        self.stream.clear_transfer_complete();
    }

    /// Returns the values of the block that is not being filled. They last for 1 ms, until the other block
    /// is full.
    pub fn finished(&self) -> impl Iterator<Item = u16> + use<S> {
        let block = match self.stream.current_buffer() {
            CurrentBuffer::FirstBuffer => &self.blocks[1],
            CurrentBuffer::SecondBuffer => &self.blocks[0],
        };
        block.iter().map(|value| value.load(Ordering::Relaxed))
    }

    /// Returns the last values, as many as a block has, from whichever blocks they are in. They last for 1 ms.
    pub fn latest(&self) -> impl Iterator<Item = u16> + use<S> {
        const BLOCK: usize = OVERSAMPLING as usize;
        let values = self.blocks.as_flattened();
        let oldest = self.next() + values.len() - BLOCK;
        (0..BLOCK).map(move |i| values[(oldest + i) % (2 * BLOCK)].load(Ordering::Relaxed))
    }

    /// Returns the index of the next value, counted over both blocks.
    fn next(&self) -> usize {
        loop {
            let before = self.stream.current_buffer();
            let left = self.stream.number_of_transfers();
            // A block ends between the two reads at most once in a millisecond.
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
