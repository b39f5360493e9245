//! The watermark of the stack: cortex-m-rt paints the stack before the program starts, and the paint that is
//! left shows how much has never been used.

use core::ptr;
use cortex_m_rt::STACK_PAINT_VALUE;

unsafe extern "C" {
    /// The linker puts this symbol at the lowest word of the stack; only its address has a meaning.
    static _stack_end: u32;
    /// The linker puts this symbol one past the highest word.
    static _stack_start: u32;
}

/// Returns how many bytes lie between the low end of the stack and the deepest word that was ever written.
/// It reads all of them, which takes a millisecond for 100 KiB on the board: only for low priorities.
pub fn never_used() -> u32 {
    let (end, start) = (&raw const _stack_end, &raw const _stack_start);
    let words = (start as usize - end as usize) / 4;
    let painted = (0..words).take_while(|index| {
        // SAFETY: between the linker's two symbols lies the stack, words of RAM that are always
        // readable. The read is volatile, since other tasks write there without the compiler's knowledge.
        unsafe { ptr::read_volatile(end.add(*index)) == STACK_PAINT_VALUE }
    });
    4 * painted.count() as u32
}
