//! The independent watchdog. Its oscillator has 32 kHz nominally and 17 to 47 kHz in truth (DS table 42), so every
//! length below is a range.

use crate::board::Watchdog;
use stm32f4xx_hal::pac::{DBGMCU, IWDG};

/// A length: the prescaler's code and the reload value.
struct Length(u16, u16);

/// 500 counts of 1 kHz: 0.34 to 0.94 s. It is fed every 0.1 s.
const SHORT: Length = Length(0b011, 499);
/// 1250 counts of 125 Hz: 6.8 to 18.8 s, for the start and for an erase of a 128 KiB sector, up to 4 s (DS
/// table 44).
const LONG: Length = Length(0b110, 1249);

const UNLOCK: u16 = 0x5555;
const RELOAD: u16 = 0xaaaa;
const START: u16 = 0xcccc;
/// Looks at the status until a length counts: five periods of the oscillator (RM 21.4.4), 0.3 ms, of ten cycles
/// a look.
const LOOKS: u32 = 20_000;

/// The independent watchdog, which runs from the start.
pub struct IwdgWatchdog {
    iwdg: IWDG,
    long: bool,
}

impl IwdgWatchdog {
    /// Starts the long watchdog; it stands still while a debugger holds the core. A debugger that had the trace's pins
    /// leaves them assigned, until the power goes: PB3 would be its output and not the force's.
    pub fn start(iwdg: IWDG, debug: &DBGMCU) -> Self {
        debug.cr().modify(|_, w| w.trace_ioen().clear_bit());
        debug.apb1_fz().modify(|_, w| w.dbg_iwdg_stop().set_bit());
        let mut watchdog = IwdgWatchdog { iwdg, long: false };
        watchdog.key(START);
        watchdog.lengthen();
        watchdog
    }

    fn key(&mut self, key: u16) {
        // SAFETY: the register takes these keys (RM 21.4.1).
        self.iwdg.kr().write(|w| unsafe { w.bits(key) });
    }

    /// Sets a length and waits until it counts.
    fn set(&mut self, Length(prescaler, reload): Length) {
        self.settle();
        self.key(UNLOCK);
        // SAFETY: the values are within their fields (RM 21.4.2 and 21.4.3).
        unsafe {
            self.iwdg.pr().write(|w| w.bits(prescaler));
            self.iwdg.rlr().write(|w| w.bits(reload));
        }
        self.settle();
        self.key(RELOAD);
    }

    /// Waits until the last values are in the oscillator's domain; before, writes are ignored.
    fn settle(&self) {
        let _ = (0..LOOKS).find(|_| self.iwdg.sr().read().bits() == 0);
    }
}

impl Watchdog for IwdgWatchdog {
    fn feed(&mut self) {
        match self.long {
            true => self.set(SHORT),
            false => self.key(RELOAD),
        }
        self.long = false;
    }

    fn lengthen(&mut self) {
        self.set(LONG);
        self.long = true;
    }
}
