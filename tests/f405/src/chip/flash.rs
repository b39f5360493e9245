//! The flash and its controller (RM0090, chapter 3): programming and erasing take their time, in which the
//! core cannot fetch; a power cut in the middle leaves a byte or a sector half done.

/// Bytes of the main flash.
pub(crate) const SIZE: usize = 1024 * 1024;
/// Time to program once, whatever the width (µs): data sheet DocID022152, table 44, typical.
const PROGRAM_US: u64 = 16;
const LOCK: u32 = 1 << 31;
const PGSERR: u32 = 1 << 7;
const PGPERR: u32 = 1 << 6;
const WRPERR: u32 = 1 << 4;

/// How long an erase takes (ms), for 16, 64 and 128 KiB: table 44, at the slowest parallelism.
#[derive(Clone, Copy, Debug)]
pub struct EraseTimes(pub [u64; 3]);

impl EraseTimes {
    /// Byte by byte, the largest times.
    pub const LONGEST: EraseTimes = EraseTimes([800, 2400, 4000]);
    /// Byte by byte, the typical times.
    pub const TYPICAL: EraseTimes = EraseTimes([400, 1200, 2000]);
}

/// An operation on the flash.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operation {
    /// A write of some bytes at an offset, with the value.
    Program {
        /// Offset in the flash.
        at: usize,
        /// Bytes at once.
        bytes: u32,
        /// The value written.
        value: u32,
    },
    /// An erase of a sector: offset and length.
    Erase {
        /// Offset in the flash.
        at: usize,
        /// Bytes of the sector.
        bytes: usize,
    },
}

pub(crate) struct Flash {
    pub(crate) memory: Vec<u8>,
    acr: u32,
    keys: u32,
    sr: u32,
    cr: u32,
    optcr: u32,
    /// Until when the controller is busy, in units.
    pub(crate) busy_until: u64,
    pub(crate) erase: EraseTimes,
    /// Every operation that was started, with the contents of the settings' sectors before it if they are kept.
    pub(crate) operations: Vec<(u64, Operation)>,
}

impl Flash {
    pub(crate) fn new(erase: EraseTimes) -> Self {
        Flash {
            memory: vec![0xff; SIZE],
            acr: 0,
            keys: 0,
            sr: 0,
            cr: LOCK,
            optcr: 0x0fff_aaed,
            busy_until: 0,
            erase,
            operations: Vec::new(),
        }
    }

    pub(crate) fn reset(&mut self) {
        (self.acr, self.keys, self.sr, self.cr) = (0, 0, 0, LOCK);
        self.busy_until = 0;
    }

    pub(crate) fn read(&self, offset: u32, now: u64) -> u32 {
        let busy = u32::from(now < self.busy_until) << 16;
        match offset {
            0x00 => self.acr,
            0x0c => self.sr | busy,
            0x10 => self.cr & !(1 << 16) | busy & self.cr,
            0x14 => self.optcr,
            _ => 0,
        }
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, now: u64, us: u64) {
        match offset {
            0x00 => self.acr = value,
            0x04 => match (self.keys, value) {
                (0, 0x4567_0123) => self.keys = 1,
                (1, 0xcdef_89ab) => (self.cr, self.keys) = (self.cr & !LOCK, 0),
                _ => self.keys = 2,
            },
            0x0c => self.sr &= !value,
            0x10 if self.cr & LOCK == 0 => {
                self.cr = value;
                if value & 1 << 16 != 0 && value & 2 != 0 {
                    self.erase_sector(now, us);
                }
                if value & LOCK != 0 {
                    self.keys = 0;
                }
            }
            _ => {}
        }
    }

    /// The offset and the length of a sector.
    fn sector(number: u32) -> (usize, usize) {
        const K: usize = 1024;
        match number as usize {
            n @ 0..=3 => (16 * K * n, 16 * K),
            4 => (64 * K, 64 * K),
            n => (128 * K * (n - 4), 128 * K),
        }
    }

    fn erase_sector(&mut self, now: u64, us: u64) {
        let (at, bytes) = Self::sector(self.cr >> 3 & 0xf);
        let EraseTimes(times) = self.erase;
        let ms = times[match bytes / 1024 {
            16 => 0,
            64 => 1,
            _ => 2,
        }];
        self.operations.push((now, Operation::Erase { at, bytes }));
        if let Some(sector) = self.memory.get_mut(at..at + bytes) {
            sector.fill(0xff);
        }
        self.cr &= !(1 << 16);
        self.busy_until = now + ms * 1000 * us;
    }

    /// A write into the flash itself.
    pub(crate) fn program(&mut self, at: usize, bytes: u32, value: u32, now: u64, us: u64) {
        if self.cr & LOCK != 0 || self.cr & 1 == 0 {
            self.sr |= if self.cr & LOCK != 0 { WRPERR } else { PGSERR };
            return;
        }
        if 1 << (self.cr >> 8 & 3) != bytes {
            self.sr |= PGPERR;
            return;
        }
        self.operations
            .push((now, Operation::Program { at, bytes, value }));
        apply(
            &mut self.memory,
            Operation::Program { at, bytes, value },
            1.0,
        );
        self.busy_until = now + PROGRAM_US * us;
    }
}

/// Does an operation to a share: what a power cut in the middle leaves. A program has pulled only some of the
/// bits down, and an erase has only raised a part of the sector.
pub fn apply(memory: &mut [u8], operation: Operation, share: f64) {
    match operation {
        Operation::Program { at, bytes, value } => {
            for index in 0..bytes as usize {
                let mut byte = (value >> (8 * index)) as u8;
                if share < 1.0 {
                    byte |= 0xff << (8.0 * share) as u32;
                }
                memory[at + index] &= byte;
            }
        }
        Operation::Erase { at, bytes } => {
            let done = (bytes as f64 * share) as usize;
            memory[at..at + done].fill(0xff);
        }
    }
}
