//! Oscillators, PLL and prescalers (RM0090, chapter 7), with a crystal that may be dead, late, or die, and the
//! clock security system.

use super::{MICROSECOND, MILLISECOND, NEVER, UNITS_PER_SECOND};

/// Time until a good crystal swings and the PLL has locked: data sheet DocID022152, tables 40 and 43.
const CRYSTAL_START: u64 = 2 * MILLISECOND;
const PLL_LOCK: u64 = 200 * MICROSECOND;
const HSEON: u32 = 1 << 16;
const HSERDY: u32 = 1 << 17;
const CSSON: u32 = 1 << 19;
const PLLON: u32 = 1 << 24;
const PLLRDY: u32 = 1 << 25;
/// CIR: the crystal has failed.
const CSSF: u32 = 1 << 7;

/// The crystal on the board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Crystal {
    /// It swings 2 ms after it is switched on.
    Good,
    /// It never swings.
    Dead,
    /// It swings so long after it is switched on (ms).
    Late(u64),
    /// It swings, but so badly that the PLL never locks on it.
    Unlockable,
    /// It stops so long after the board was switched on (µs).
    Dies(u64),
}

pub(crate) struct Rcc {
    cr: u32,
    pub(crate) pllcfgr: u32,
    pub(crate) cfgr: u32,
    pub(crate) cir: u32,
    pub(crate) csr: u32,
    others: [u32; 36],
    hse_at: u64,
    pll_at: u64,
    pub(crate) crystal: Crystal,
    /// The PLL never locks on the internal oscillator.
    pub(crate) internal_unlockable: bool,
    /// The internal oscillator's frequency in parts of 16 MHz.
    pub(crate) internal: f64,
    /// The clock that drives the core has stopped.
    pub(crate) stopped: bool,
}

impl Rcc {
    pub(crate) fn new(crystal: Crystal, internal: f64) -> Self {
        Rcc {
            cr: 0x83,
            pllcfgr: 0x2400_3010,
            cfgr: 0,
            cir: 0,
            csr: 0x0e00_0000,
            others: [0; 36],
            hse_at: NEVER,
            pll_at: NEVER,
            crystal,
            internal_unlockable: false,
            internal,
            stopped: false,
        }
    }

    /// As after a reset; `flags` say why (CSR), and the flags of before stay until the program clears them.
    pub(crate) fn reset(&mut self, flags: u32) {
        let csr = self.csr & 0xfe00_0000 | flags;
        let (crystal, internal) = (self.crystal, self.internal);
        let internal_unlockable = self.internal_unlockable;
        *self = Rcc {
            csr,
            internal_unlockable,
            ..Rcc::new(crystal, internal)
        };
    }

    fn swings(&self, now: u64) -> bool {
        match self.crystal {
            Crystal::Dead => false,
            Crystal::Dies(at) => now < at * MICROSECOND && self.hse_at <= now,
            _ => self.hse_at <= now,
        }
    }

    fn locked(&self, now: u64) -> bool {
        self.pll_at <= now
    }

    fn is_from_crystal(&self) -> bool {
        self.pllcfgr & 1 << 22 != 0
    }

    pub(crate) fn read(&mut self, offset: u32, now: u64) -> u32 {
        match offset {
            0x00 => {
                let hse = if self.cr & HSEON != 0 && self.swings(now) {
                    HSERDY
                } else {
                    0
                };
                let pll = if self.cr & PLLON != 0 && self.locked(now) {
                    PLLRDY
                } else {
                    0
                };
                self.cr | hse | pll
            }
            0x04 => self.pllcfgr,
            0x08 => self.cfgr & !0xc | (self.cfgr & 3) << 2,
            0x0c => self.cir,
            0x74 => self.csr | (self.csr & 1) << 1,
            _ => self.others[(offset / 4 % 36) as usize],
        }
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, now: u64) {
        match offset {
            0x00 => self.set_cr(value, now),
            0x04 if self.cr & PLLON == 0 => self.pllcfgr = value,
            0x04 => {}
            0x08 => self.cfgr = value,
            0x0c => {
                if value & 1 << 23 != 0 {
                    self.cir &= !CSSF;
                }
                self.cir = self.cir & 0xff | value & 0x7f00;
            }
            0x74 => {
                self.csr = self.csr & 0xfe00_0000 | value & 1;
                if value & 1 << 24 != 0 {
                    self.csr &= 1;
                }
            }
            _ => self.others[(offset / 4 % 36) as usize] = value,
        }
    }

    fn set_cr(&mut self, value: u32, now: u64) {
        let (was, new) = (self.cr, value & !(HSERDY | PLLRDY));
        self.cr = new;
        if new & HSEON == 0 {
            self.hse_at = NEVER;
        } else if was & HSEON == 0 {
            self.hse_at = match self.crystal {
                Crystal::Dead => NEVER,
                Crystal::Late(ms) => now + ms * MILLISECOND,
                _ => now + CRYSTAL_START,
            };
        }
        if new & PLLON == 0 {
            self.pll_at = NEVER;
        } else if was & PLLON == 0 {
            let locks = match self.is_from_crystal() {
                true => self.swings(now) && self.crystal != Crystal::Unlockable,
                false => !self.internal_unlockable,
            };
            self.pll_at = if locks { now + PLL_LOCK } else { NEVER };
        }
    }

    /// When the crystal dies, if it drives anything.
    pub(crate) fn event(&self) -> u64 {
        match self.crystal {
            Crystal::Dies(at) if self.cr & HSEON != 0 && !self.stopped => at * MICROSECOND,
            _ => NEVER,
        }
    }

    /// The crystal dies. With the clock security system the core goes on from the internal oscillator, and
    /// the result says that an NMI comes; without it, everything that the crystal drove stands still.
    pub(crate) fn at_event(&mut self) -> bool {
        let drives = match self.cfgr & 3 {
            1 => true,
            2 => self.is_from_crystal(),
            _ => false,
        };
        let security = self.cr & CSSON != 0;
        self.crystal = Crystal::Dead;
        self.hse_at = NEVER;
        if security {
            self.cir |= CSSF;
            self.cr &= !(HSEON | CSSON);
            if drives {
                self.cr &= !PLLON;
                self.pll_at = NEVER;
                self.cfgr &= !3;
            }
            return true;
        }
        self.stopped = drives;
        false
    }

    pub(crate) fn failed(&self) -> bool {
        self.cir & CSSF != 0
    }

    /// The frequency of the system clock (Hz).
    fn sysclk(&self) -> f64 {
        let internal = 16e6 * self.internal;
        match self.cfgr & 3 {
            0 => internal,
            1 => 8e6,
            _ => {
                let input = if self.is_from_crystal() {
                    8e6
                } else {
                    internal
                };
                let m = f64::from(self.pllcfgr & 0x3f);
                let n = f64::from(self.pllcfgr >> 6 & 0x1ff);
                let p = f64::from(2 * (self.pllcfgr >> 16 & 3) + 2);
                input / m * n / p
            }
        }
    }

    /// The periods of core, APB1 and APB2 and of their timers, in units of time.
    pub(crate) fn periods(&self) -> Periods {
        let ahb = match self.cfgr >> 4 & 0xf {
            coded @ 8..=15 => [2, 4, 8, 16, 64, 128, 256, 512][coded as usize - 8],
            _ => 1,
        };
        let core = (UNITS_PER_SECOND as f64 / self.sysclk()).round() as u64 * ahb;
        let apb = |low: u32| match self.cfgr >> low & 7 {
            coded @ 4..=7 => 2 << (coded - 4),
            _ => 1,
        };
        let (one, two) = (apb(10), apb(13));
        let timer = |divided: u64| core * divided / if divided == 1 { 1 } else { 2 };
        Periods {
            core,
            apb1: core * one,
            apb2: core * two,
            timers1: timer(one),
            timers2: timer(two),
        }
    }
}

/// Lengths of the clocks' periods, in units of time.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) struct Periods {
    pub(crate) core: u64,
    pub(crate) apb1: u64,
    pub(crate) apb2: u64,
    pub(crate) timers1: u64,
    pub(crate) timers2: u64,
}
