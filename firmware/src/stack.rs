//! The watermark of the stack: cortex-m-rt paints the stack before the program starts, and the paint that is
//! left shows how much has never been used.

use core::ptr;
use core::sync::atomic::{AtomicU32, Ordering};
use cortex_m_rt::STACK_PAINT_VALUE;

/// Bytes below the paint's end in which a later look searches for words that were written.
const GAP: usize = 256;

unsafe extern "C" {
    /// The linker puts this symbol at the lowest word of the stack; only its address has a meaning.
    static _stack_end: u32;
    /// The linker puts this symbol one past the highest word.
    static _stack_start: u32;
}

/// The bytes that were free at the last look.
static FREE: AtomicU32 = AtomicU32::new(u32::MAX);

/// Returns how many bytes lie between the low end of the stack and the deepest word that was ever written.
///
/// The first look goes through all of them, which takes a millisecond for 100 KiB on the board: it belongs to the
/// start. A later one finds the same or less, and begins where the paint ended: it looks at the words below as far
/// as they were written, and needs a dozen instructions where they were not. (A frame that leaves a gap of
/// [`GAP`] bytes unwritten is found once it is used.)
pub fn never_used() -> u32 {
    let (end, start) = (&raw const _stack_end, &raw const _stack_start);
    let words = (start as usize - end as usize) / 4;
    // SAFETY: between the linker's two symbols lies the stack, words of RAM that are always
    // readable. The read is volatile, since other tasks write there without the compiler's knowledge.
    let painted = |index: usize| unsafe { ptr::read_volatile(end.add(index)) == STACK_PAINT_VALUE };
    let known = FREE.load(Ordering::Relaxed) as usize / 4;
    let mut free = known;
    if known > words {
        free = (0..words).take_while(|index| painted(*index)).count();
    }
    // Goes down as long as there is a written word among the next ones below.
    while let Some(deeper) = (free.saturating_sub(GAP / 4)..free).find(|index| !painted(*index)) {
        free = deeper;
    }
    FREE.store(4 * free as u32, Ordering::Relaxed);
    4 * free as u32
}
