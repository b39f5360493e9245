//! A ring of two blocks that a DMA stream fills in turn without end: while it fills one, the other is read.
//!
//! The HAL's `Transfer` wants a buffer handed over for every block, and a call that comes late then
//! stops the stream. Here a late call only loses a block.

use super::analog::OVERSAMPLING;
use core::sync::atomic::{AtomicU16, Ordering, fence};
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

/// A stream with its ring.
pub struct Ring<S> {
    stream: S,
    blocks: &'static Blocks,
    /// The block with which the stream started.
    first: CurrentBuffer,
}

impl<S: Stream + StreamISR> Ring<S> {
    /// Moves 16-bit values from the register `peripheral` whenever it asks on `channel`, from
    /// [`Ring::start`] on.
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
        stream.set_memory_increment(true);
        stream.set_peripheral_increment(false);
        stream.set_double_buffer(true);
        stream.set_fifo_enable(false);
        stream.set_priority(priority);
        // SAFETY: values and both registers (ADC_DR, TIM3_CCR3) are 16 bits wide.
        unsafe {
            stream.set_memory_size(DmaDataSize::HalfWord);
            stream.set_peripheral_size(DmaDataSize::HalfWord);
        }
        Ring {
            first: stream.current_buffer(),
            stream,
            blocks,
        }
    }

    /// Starts the stream, or starts it anew, with the block at which it stands, while nothing asks for transfers. A
    /// request from before, which the stream serves at once, would shift the block: then it starts once more.
    pub fn start(&mut self) {
        for _ in 0..3 {
            self.start_once();
            // A transfer takes some cycles.
            cortex_m::asm::delay(50);
            if self.stream.number_of_transfers() == OVERSAMPLING {
                break;
            }
        }
    }

    fn start_once(&mut self) {
        // SAFETY: the stream is off while its registers change; the memory is static and has a value for each
        // transfer; nothing else uses the stream, since `self` owns it.
        unsafe {
            self.stream.disable();
            // It finishes a transfer first (RM 10.3.14), which takes some cycles.
            for _ in 0..32 {
                if !self.stream.is_enabled() {
                    break;
                }
            }
            self.stream.clear_all_flags();
            let [zero, one] = self.blocks;
            self.stream.set_memory_address(zero.as_ptr() as u32);
            self.stream
                .set_alternate_memory_address(one.as_ptr() as u32);
            self.stream.set_number_of_transfers(OVERSAMPLING);
            self.first = self.stream.current_buffer();
            self.stream.enable();
        }
    }

    /// Raises the stream's interrupt after every block.
    pub fn listen(&mut self) {
        self.stream.listen_transfer_complete();
    }

    /// Returns whether a block has ended since the last call, and clears the interrupt's request. A block that
    /// ends afterwards raises it again: one that ends between the look and the answer is not cleared.
    pub fn has_ended(&mut self) -> bool {
        let ended = self.stream.is_transfer_complete();
        if ended {
            self.stream.clear_transfer_complete();
        }
        ended
    }

    /// Returns whether the stream runs: an error of a transfer switches it off.
    pub fn runs(&self) -> bool {
        self.stream.is_enabled()
    }

    /// Returns whether this stream and another one have filled as many blocks, of two, since they started.
    pub fn in_step_with<T: Stream + StreamISR>(&self, other: &Ring<T>) -> bool {
        let odd = self.stream.current_buffer() != self.first;
        odd == (other.stream.current_buffer() != other.first)
    }

    /// Returns the values of the block that is not being filled. They last for 1 ms, until the other block
    /// is full.
    pub fn finished(&self) -> impl Iterator<Item = u16> + use<S> {
        let blocks = self.blocks;
        let full = match self.stream.current_buffer() {
            CurrentBuffer::FirstBuffer => &blocks[1],
            CurrentBuffer::SecondBuffer => &blocks[0],
        };
        // The values are read after the look at which block is full, and not before.
        fence(Ordering::Acquire);
        full.iter().map(|value| value.load(Ordering::Relaxed))
    }
}
