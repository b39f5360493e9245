//! How much of the stack has never been used: cortex-m-rt paints it before the program starts.

use core::ptr;
use cortex_m_rt::STACK_PAINT_VALUE;

unsafe extern "C" {
    /// Lowest word of the stack, from the linker; its address counts.
    static _stack_end: u32;
    /// One past the highest.
    static _stack_start: u32;
}

/// Bytes from the stack's low end up to the deepest word that was ever written. Reads as many words:
/// a millisecond for 100 KiB on the board; for low priorities.
pub fn never_used() -> u32 {
    let (end, start) = (&raw const _stack_end, &raw const _stack_start);
    let words = (start as usize - end as usize) / 4;
    let painted = (0..words).take_while(|index| {
        // SAFETY: between the linker's two symbols lies the stack, words of RAM that are always
        // readable; volatile, since other tasks write it behind the compiler's back.
        unsafe { ptr::read_volatile(end.add(*index)) == STACK_PAINT_VALUE }
    });
    4 * painted.count() as u32
}
