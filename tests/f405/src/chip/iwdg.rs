//! The independent watchdog (RM0090, chapter 21) with its own oscillator, of 17 to 47 kHz.

use super::{NEVER, UNITS_PER_SECOND};

pub(crate) struct Iwdg {
    /// Frequency of the oscillator (Hz).
    pub(crate) hz: u64,
    pr: u32,
    rlr: u32,
    unlocked: bool,
    running: bool,
    deadline: u64,
    /// The longest time between two feeds, in units.
    pub(crate) longest: u64,
    fed: u64,
}

impl Iwdg {
    pub(crate) fn new(hz: u64) -> Self {
        Iwdg {
            hz,
            pr: 0,
            rlr: 0xfff,
            unlocked: false,
            running: false,
            deadline: NEVER,
            longest: 0,
            fed: 0,
        }
    }

    /// The time that a feed lasts, in units.
    pub(crate) fn window(&self) -> u64 {
        let divider = 4 << self.pr.min(6);
        (u64::from(self.rlr) + 1) * divider * (UNITS_PER_SECOND / self.hz)
    }

    pub(crate) fn event(&self) -> u64 {
        self.deadline
    }

    pub(crate) fn read(&self, offset: u32) -> u32 {
        match offset {
            0x04 => self.pr,
            0x08 => self.rlr,
            _ => 0,
        }
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, now: u64) {
        match (offset, value & 0xffff) {
            (0x00, 0x5555) => self.unlocked = true,
            (0x00, 0xaaaa) => {
                self.unlocked = false;
                self.feed(now);
            }
            (0x00, 0xcccc) => {
                self.unlocked = false;
                self.running = true;
                self.feed(now);
            }
            (0x04, pr) if self.unlocked => self.pr = pr & 7,
            (0x08, rlr) if self.unlocked => self.rlr = rlr & 0xfff,
            _ => {}
        }
    }

    fn feed(&mut self, now: u64) {
        if self.running {
            if self.fed != 0 {
                self.longest = self.longest.max(now - self.fed);
            }
            self.fed = now;
            self.deadline = now + self.window();
        }
    }
}
