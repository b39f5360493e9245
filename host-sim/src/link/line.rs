//! The line of a simulated board, which drains as the board's does: the hardware sends one stretch of the
//! outbox after the other, whose room is free when its last byte has gone, and an interrupt starts the next.

use std::collections::VecDeque;
use std::sync::atomic::Ordering;

use estimator_core::board::outbox::Outbox;

/// The pause between two stretches (µs): the interrupt of the line waits while the sampling task runs, which
/// takes 50 µs of a tick.
const PAUSE_US: usize = 50;

/// A line of limited speed.
pub(super) struct Line {
    /// The bytes that wait.
    pub(super) outbox: Outbox,
    /// The bytes that have come to the other end.
    pub(super) arrived: VecDeque<u8>,
    bytes_per_ms: usize,
    /// The rest of the stretch that is being sent.
    underway: VecDeque<u8>,
    /// The part of a byte's time that is left of the last millisecond, or that a pause still takes (byte · µs).
    credit: isize,
}

impl Line {
    /// Starts an idle line.
    pub(super) fn new(bytes_per_ms: usize) -> Self {
        Line {
            outbox: Outbox::new(),
            arrived: VecDeque::new(),
            bytes_per_ms,
            underway: VecDeque::new(),
            credit: 0,
        }
    }

    /// Carries what a millisecond allows.
    pub(super) fn carry_for_a_millisecond(&mut self) {
        const MS_US: isize = 1000;
        self.credit += (self.bytes_per_ms * 1000) as isize;
        while self.credit >= MS_US {
            if self.underway.is_empty() && !self.start() {
                // An idle line saves nothing up.
                self.credit = 0;
                return;
            }
            if let Some(byte) = self.underway.pop_front() {
                self.arrived.push_back(byte);
                self.credit -= MS_US;
            }
            if self.underway.is_empty() {
                self.credit -= (self.bytes_per_ms * PAUSE_US) as isize;
            }
        }
    }

    /// Starts the next stretch and returns whether there is one.
    fn start(&mut self) -> bool {
        let stretch = self.outbox.next_stretch().unwrap_or(&[]);
        let bytes = stretch.iter().map(|byte| byte.load(Ordering::Relaxed));
        self.underway.extend(bytes);
        !self.underway.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 2 Mbaud carry 200 bytes a millisecond. WHEN there is always something to send, THEN the pauses between
    /// the stretches cost a fourteenth, and every byte arrives in order.
    #[test]
    fn a_busy_line_carries_its_speed_less_the_pauses() {
        let mut line = Line::new(200);
        let mut next = 0_u8;
        for _ in 0..1000 {
            while line.outbox.room() > 0 {
                line.outbox.write(&[next]);
                next = next.wrapping_add(1);
            }
            line.carry_for_a_millisecond();
        }
        let arrived = line.arrived.len();
        assert!((184_000..188_000).contains(&arrived), "{arrived}");
        let in_order = (0_u64..)
            .zip(&line.arrived)
            .all(|(i, byte)| i as u8 == *byte);
        assert!(in_order);
    }

    #[test]
    fn an_idle_line_sends_what_comes_at_its_speed_and_no_faster() {
        let mut line = Line::new(92);
        for _ in 0..10 {
            line.carry_for_a_millisecond();
        }
        line.outbox.write(&[1; 300]);
        line.carry_for_a_millisecond();
        assert_eq!(line.arrived.len(), 92);
    }
}
