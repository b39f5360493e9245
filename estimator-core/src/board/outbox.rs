//! The bytes that wait for a line: a ring between the task that writes frames and the hardware that sends
//! them, one stretch after the other. A stretch lies in one piece in memory, as a DMA needs it.

use core::sync::atomic::{AtomicU8, AtomicUsize, Ordering};

/// The length of a ring (bytes). At 2 Mbaud it lasts 5 ms.
pub const OUTBOX: usize = 1024;
/// The longest stretch (bytes): 0.64 ms at 2 Mbaud. Its room is free again when it has been sent.
pub const STRETCH: usize = 128;
// The positions wrap where `usize` does, so the length must divide that.
const _: () = assert!(OUTBOX.is_power_of_two() && STRETCH <= OUTBOX);

/// A ring of bytes with one writer and one sender, which may interrupt the writer.
#[derive(Debug)]
pub struct Outbox {
    bytes: [AtomicU8; OUTBOX],
    /// How many bytes were ever written, and how many of them sent; both wrap.
    written: AtomicUsize,
    sent: AtomicUsize,
    /// The length of the stretch that is being sent.
    underway: AtomicUsize,
}

impl Default for Outbox {
    fn default() -> Self {
        Outbox::new()
    }
}

impl Outbox {
    /// Starts empty.
    pub const fn new() -> Self {
        Outbox {
            bytes: [const { AtomicU8::new(0) }; OUTBOX],
            written: AtomicUsize::new(0),
            sent: AtomicUsize::new(0),
            underway: AtomicUsize::new(0),
        }
    }

    /// Returns how many bytes [`Outbox::write`] takes now.
    pub fn room(&self) -> usize {
        OUTBOX.saturating_sub(self.waiting())
    }

    /// Returns how many bytes have been written and not sent, the stretch that is underway included.
    pub fn waiting(&self) -> usize {
        let written = self.written.load(Ordering::Relaxed);
        written.wrapping_sub(self.sent.load(Ordering::Acquire))
    }

    /// Writes at most [`Outbox::room`] bytes and cuts off the rest. Only the writer calls this.
    pub fn write(&self, bytes: &[u8]) {
        let fits = bytes.len().min(self.room());
        let at = self.written.load(Ordering::Relaxed);
        // Up to the ring's end, and on from its start: half of the work of finding the place of every byte.
        let place = at % OUTBOX;
        let to_end = fits.min(OUTBOX - place);
        self.put(place, bytes.get(..to_end).unwrap_or(&[]));
        self.put(0, bytes.get(to_end..fits).unwrap_or(&[]));
        self.written.store(at.wrapping_add(fits), Ordering::Release);
    }

    /// Puts bytes at a place behind which there is room for them.
    fn put(&self, place: usize, bytes: &[u8]) {
        for (slot, byte) in self.bytes.iter().skip(place).zip(bytes) {
            slot.store(*byte, Ordering::Relaxed);
        }
    }

    /// Takes the last stretch as sent and returns the next one, which stays as it is until the next call;
    /// `None` while nothing waits. Only the sender calls this.
    pub fn next_stretch(&self) -> Option<&[AtomicU8]> {
        let done = self.underway.load(Ordering::Relaxed);
        let sent = self.sent.load(Ordering::Relaxed).wrapping_add(done);
        self.sent.store(sent, Ordering::Release);
        let waiting = self.written.load(Ordering::Acquire).wrapping_sub(sent);
        let start = sent % OUTBOX;
        let length = waiting.min(STRETCH).min(OUTBOX - start);
        self.underway.store(length, Ordering::Relaxed);
        self.bytes
            .get(start..start + length)
            .filter(|stretch| !stretch.is_empty())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    extern crate std;
    use std::vec::Vec;

    /// WHEN frames of any length are written as there is room, THEN the stretches bring every byte once and in
    /// order, through many turns of the ring.
    #[test]
    fn every_byte_comes_once_and_in_order_in_stretches_of_one_piece() {
        let outbox = Outbox::new();
        let (mut next, mut sent) = (0_u32, Vec::new());
        for turn in 0..2000_usize {
            let frame: Vec<u8> = (0..turn % 300).map(|i| (next as usize + i) as u8).collect();
            if outbox.room() >= frame.len() {
                outbox.write(&frame);
                next += frame.len() as u32;
            }
            if turn % 3 > 0
                && let Some(stretch) = outbox.next_stretch()
            {
                assert!(stretch.len() <= STRETCH);
                sent.extend(stretch.iter().map(|byte| byte.load(Ordering::Relaxed)));
            }
        }
        while let Some(stretch) = outbox.next_stretch() {
            sent.extend(stretch.iter().map(|byte| byte.load(Ordering::Relaxed)));
        }
        assert_eq!(sent.len(), next as usize);
        assert!(sent.len() > 20 * OUTBOX, "{}", sent.len());
        assert!((0_u32..).zip(&sent).all(|(i, byte)| i as u8 == *byte));
    }

    #[test]
    fn the_room_of_a_stretch_is_free_when_it_has_been_sent_and_not_before() {
        let outbox = Outbox::new();
        outbox.write(&[7; OUTBOX + 5]);
        assert_eq!((outbox.room(), outbox.waiting()), (0, OUTBOX));
        assert_eq!(outbox.next_stretch().map(<[_]>::len), Some(STRETCH));
        assert_eq!(outbox.room(), 0);
        assert!(outbox.next_stretch().is_some());
        assert_eq!(outbox.room(), STRETCH);
    }
}
