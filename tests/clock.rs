//! The start of the board's clocks against a model of the registers, as reference manual RM0090
//! describes them: 7.3.1 (CR) and 7.3.2 (PLLCFGR). Bits and limits are written down here once more.

// The firmware is a workspace of its own for another target; this file of it knows no hardware.
#[path = "../firmware/src/board/f405/pll.rs"]
#[allow(missing_docs, unreachable_pub)]
mod clock;

use clock::{NotLocked, Register, Registers, Source, start};

/// 7.3.1 after a reset: HSION, HSIRDY, and a trim in the middle.
const RESET_CR: u32 = 0x0000_0083;
const HSEON: u32 = 1 << 16;
const HSERDY: u32 = 1 << 17;
const PLLON: u32 = 1 << 24;
const PLLRDY: u32 = 1 << 25;

/// A chip. Times in pauses of 10 µs; `None`: never.
struct Chip {
    crystal_after: Option<u32>,
    lock_on_crystal_after: Option<u32>,
    lock_on_internal_after: Option<u32>,
    cr: u32,
    pllcfgr: u32,
    now: u32,
    crystal_on: u32,
    pll_on: u32,
}

impl Chip {
    fn new(crystal: Option<u32>, on_crystal: Option<u32>, on_internal: Option<u32>) -> Self {
        Chip {
            crystal_after: crystal,
            lock_on_crystal_after: on_crystal,
            lock_on_internal_after: on_internal,
            cr: RESET_CR,
            pllcfgr: 0x2400_3010,
            now: 0,
            crystal_on: 0,
            pll_on: 0,
        }
    }

    fn on_crystal(&self) -> bool {
        self.pllcfgr & 1 << 22 != 0
    }

    /// What the factors make of the source (Hz), each within its limits (7.3.2).
    fn core_hz(&self) -> u32 {
        let source = if self.on_crystal() {
            8_000_000
        } else {
            16_000_000
        };
        let (m, n) = (self.pllcfgr & 0x3f, self.pllcfgr >> 6 & 0x1ff);
        let p = 2 * (1 + (self.pllcfgr >> 16 & 3));
        assert!((2..=63).contains(&m) && (50..=432).contains(&n), "{m} {n}");
        let input = source / m;
        assert!((1_000_000..=2_000_000).contains(&input), "{input}");
        let vco = input * n;
        assert!((100_000_000..=432_000_000).contains(&vco), "{vco}");
        assert!((2..=15).contains(&(self.pllcfgr >> 24 & 0xf)), "Q");
        vco / p
    }

    fn since(&self, start: u32, needs: Option<u32>) -> bool {
        needs.is_some_and(|pauses| self.now - start >= pauses)
    }
}

impl Registers for Chip {
    fn read(&self, register: Register) -> u32 {
        if register == Register::Pllcfgr {
            return self.pllcfgr;
        }
        let mut cr = self.cr & !(HSERDY | PLLRDY);
        if cr & HSEON != 0 && self.since(self.crystal_on, self.crystal_after) {
            cr |= HSERDY;
        }
        let lock = match self.on_crystal() {
            true => self.lock_on_crystal_after,
            false => self.lock_on_internal_after,
        };
        if cr & PLLON != 0 && self.since(self.pll_on, lock) {
            cr |= PLLRDY;
        }
        cr
    }

    fn write(&mut self, register: Register, value: u32) {
        match register {
            Register::Pllcfgr => {
                assert_eq!(self.cr & PLLON, 0, "written while the PLL is on");
                let kept = 0xf0bc_8000;
                assert_eq!(value & kept, self.pllcfgr & kept, "reserved bits");
                self.pllcfgr = value;
            }
            Register::Cr => {
                let free = HSEON | HSERDY | PLLON | PLLRDY;
                assert_eq!(value & !free, RESET_CR, "nothing else is touched");
                let rising = value & !self.cr;
                if rising & HSEON != 0 {
                    self.crystal_on = self.now;
                }
                if rising & PLLON != 0 {
                    let ready = !self.on_crystal() || self.read(Register::Cr) & HSERDY != 0;
                    assert!(ready, "the PLL's source does not run");
                    self.pll_on = self.now;
                }
                let in_use = self.cr & PLLON != 0 && self.on_crystal();
                assert!(value & HSEON != 0 || !in_use, "the PLL loses its source");
                self.cr = value & !(HSERDY | PLLRDY);
            }
        }
    }

    fn pause(&mut self) {
        self.now += 1;
    }
}

/// Every chip ends in one of three ways, in bounded time, whatever is dead and however late it is.
#[test]
fn a_chip_ends_on_the_crystal_on_the_internal_oscillator_or_says_that_it_has_no_clock() {
    let (never, late) = (None, Some(1_000_000));
    // A crystal takes 2 ms, a lock 0.3 ms: with twice that and more, all is well.
    let (crystal, lock) = (Some(500), Some(60));
    let table = [
        (crystal, lock, lock, Ok(Source::Crystal)),
        (Some(0), Some(0), Some(0), Ok(Source::Crystal)),
        (never, lock, lock, Ok(Source::Internal)),
        (late, lock, lock, Ok(Source::Internal)),
        (crystal, never, lock, Ok(Source::Internal)),
        (crystal, late, lock, Ok(Source::Internal)),
        (crystal, never, never, Err(NotLocked)),
        (never, never, never, Err(NotLocked)),
        (late, late, late, Err(NotLocked)),
    ];
    for (crystal, on_crystal, on_internal, expected) in table {
        let mut chip = Chip::new(crystal, on_crystal, on_internal);
        let case = format!("{crystal:?} {on_crystal:?} {on_internal:?}");
        assert_eq!(start(&mut chip), expected, "{case}");
        // 111 ms.
        assert!(chip.now <= 11_100, "{case}: {} pauses", chip.now);
        let cr = chip.read(Register::Cr);
        let on = match expected {
            Ok(Source::Crystal) => HSEON | HSERDY | PLLON | PLLRDY,
            Ok(Source::Internal) => PLLON | PLLRDY,
            Err(NotLocked) => 0,
        };
        assert_eq!(cr, RESET_CR | on, "{case}");
        if let Ok(source) = expected {
            assert_eq!(chip.core_hz(), 168_000_000, "{case}");
            assert_eq!(chip.on_crystal(), source == Source::Crystal, "{case}");
            assert_eq!(chip.pllcfgr, source.pllcfgr(), "{case}");
        }
    }
}

/// The HAL writes PLLCFGR once more while the PLL runs: to change nothing, it must be what it
/// calculates (stm32f4xx-hal 0.23, `MainPll::fast_setup`): the least M that meets 336 MHz exactly,
/// P = 2, Q = ⌈336/48⌉, other bits as after a reset. The board compares at every start.
#[test]
fn the_factors_are_those_that_the_hal_would_choose() {
    for (source, input_hz, bit) in [
        (Source::Crystal, 8_000_000_u32, 1 << 22),
        (Source::Internal, 16_000_000, 0),
    ] {
        let least = input_hz.div_ceil(2_000_000);
        let m = (least..=input_hz / 1_000_000)
            .find(|m| 336_000_000 % (input_hz / m) == 0)
            .expect("a divider");
        let n = 336_000_000 / (input_hz / m);
        let q = 336_000_000_u32.div_ceil(48_000_000);
        assert_eq!(source.pllcfgr(), 0x2000_0000 | q << 24 | bit | n << 6 | m);
    }
}
