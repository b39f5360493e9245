//! ADC1 (RM0090, chapter 13): one regular conversion a trigger. The value is that of the instant at which the
//! hold capacitor closes, at the end of the sampling time; a value that nobody has fetched when the next one
//! comes is an overrun, after which triggers and DMA requests stand still.

use super::NEVER;

/// Cycles of the sampling times.
const SAMPLING: [u64; 8] = [3, 15, 28, 56, 84, 112, 144, 480];
/// Cycles of a conversion of 12 bits after that.
const CONVERSION: u64 = 12;
const EOC: u32 = 1 << 1;
const STRT: u32 = 1 << 4;
const OVR: u32 = 1 << 5;

/// What happens at an instant.
pub(crate) enum Happening {
    Hold,
    Done,
}

pub(crate) struct Adc {
    pub(crate) sr: u32,
    cr1: u32,
    pub(crate) cr2: u32,
    smpr: [u32; 2],
    sqr: [u32; 3],
    others: [u32; 16],
    ccr: u32,
    dr: u32,
    held: u32,
    /// The ADC's clock before its divider, in units of time.
    clock: u64,
    hold_at: u64,
    done_at: u64,
}

impl Adc {
    pub(crate) fn new() -> Self {
        Adc {
            sr: 0,
            cr1: 0,
            cr2: 0,
            smpr: [0; 2],
            sqr: [0; 3],
            others: [0; 16],
            ccr: 0,
            dr: 0,
            held: 0,
            clock: 1,
            hold_at: NEVER,
            done_at: NEVER,
        }
    }

    pub(crate) fn set_clock(&mut self, clock: u64) {
        self.clock = clock;
    }

    fn cycle(&self) -> u64 {
        self.clock * 2 * (u64::from(self.ccr >> 16 & 3) + 1)
    }

    /// The channel that is converted.
    pub(crate) fn channel(&self) -> u32 {
        self.sqr[2] & 0x1f
    }

    /// The trigger that is selected, with the edges that count: bit 0 rising, bit 1 falling.
    pub(crate) fn trigger(&self) -> (u32, u32) {
        (self.cr2 >> 24 & 0xf, self.cr2 >> 28 & 3)
    }

    /// A trigger arrives.
    pub(crate) fn start(&mut self, now: u64) {
        let stopped = self.sr & OVR != 0 && self.cr2 & 1 << 8 != 0;
        if self.cr2 & 1 == 0 || self.done_at != NEVER || stopped {
            return;
        }
        let channel = self.channel();
        let coded = match channel {
            0..=9 => self.smpr[1] >> (3 * channel),
            _ => self.smpr[0] >> (3 * (channel - 10)),
        };
        let sampling = SAMPLING[(coded & 7) as usize];
        self.sr |= STRT;
        self.hold_at = now + sampling * self.cycle();
        self.done_at = self.hold_at + CONVERSION * self.cycle();
    }

    pub(crate) fn event(&self) -> u64 {
        self.hold_at.min(self.done_at)
    }

    pub(crate) fn at_event(&mut self) -> Happening {
        if self.hold_at != NEVER {
            self.hold_at = NEVER;
            return Happening::Hold;
        }
        self.done_at = NEVER;
        Happening::Done
    }

    pub(crate) fn hold(&mut self, code: u32) {
        self.held = code;
    }

    /// The conversion is done; returns whether it asks for DMA.
    pub(crate) fn done(&mut self, waiting: bool) -> bool {
        let dma = self.cr2 & 1 << 8 != 0;
        if self.sr & EOC != 0 && (dma || self.cr2 & 1 << 10 != 0) || waiting {
            self.sr |= OVR;
            return false;
        }
        self.dr = self.held;
        self.sr |= EOC;
        dma && self.sr & OVR == 0
    }

    /// Whether the interrupt line is high.
    pub(crate) fn line(&self) -> bool {
        self.cr1 & 1 << 5 != 0 && self.sr & EOC != 0
            || self.cr1 & 1 << 26 != 0 && self.sr & OVR != 0
    }

    pub(crate) fn read(&mut self, offset: u32) -> u32 {
        match offset {
            0x00 => self.sr,
            0x04 => self.cr1,
            0x08 => self.cr2,
            0x0c | 0x10 => self.smpr[(offset as usize - 0x0c) / 4],
            0x2c..=0x34 => self.sqr[(offset as usize - 0x2c) / 4],
            0x4c => {
                self.sr &= !EOC;
                self.dr
            }
            0x304 => self.ccr,
            _ => self.others[(offset / 4 % 16) as usize],
        }
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, now: u64) {
        match offset {
            0x00 => self.sr &= value,
            0x04 => self.cr1 = value,
            0x08 => {
                self.cr2 = value & !(1 << 30);
                if value & 1 << 30 != 0 {
                    self.start(now);
                }
                if value & 1 == 0 {
                    (self.hold_at, self.done_at) = (NEVER, NEVER);
                }
            }
            0x0c | 0x10 => self.smpr[(offset as usize - 0x0c) / 4] = value,
            0x2c..=0x34 => self.sqr[(offset as usize - 0x2c) / 4] = value,
            0x304 => self.ccr = value,
            _ => self.others[(offset / 4 % 16) as usize] = value,
        }
    }
}
