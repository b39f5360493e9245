//! 168 MHz from the 8 MHz crystal or, where that is dead, from the internal oscillator, with a bound
//! on every wait. Sections are those of reference manual RM0090, figures those of the data sheet
//! DocID022152; tests/clock.rs runs it against a model of the registers.

/// A register of the reset and clock controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Register {
    /// 7.3.1: what is on, and what is ready.
    Cr,
    /// 7.3.2: the PLL's input and factors.
    Pllcfgr,
}

/// The reset and clock controller, right after a reset: the core runs from the internal oscillator,
/// the PLL is off.
pub trait Registers {
    /// All bits of a register.
    fn read(&self, register: Register) -> u32;
    /// As above.
    fn write(&mut self, register: Register, value: u32);
    /// At least 10 µs.
    fn pause(&mut self);
}

/// Of CR: the crystal's oscillator is to run.
const HSEON: u32 = 1 << 16;
/// Of CR: it does.
const HSERDY: u32 = 1 << 17;
/// Of CR: the PLL is to run.
const PLLON: u32 = 1 << 24;
/// Of CR: it has locked.
const PLLRDY: u32 = 1 << 25;
/// Of PLLCFGR: the PLL's input is the crystal.
const PLLSRC_HSE: u32 = 1 << 22;

/// 100 ms: a crystal takes 2 ms (table 40).
const CRYSTAL_PAUSES: u32 = 10_000;
/// 5 ms: the PLL locks within 0.3 ms (table 43).
const LOCK_PAUSES: u32 = 500;

/// What the PLL multiplies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// 8 MHz, to within some 10⁻⁵.
    Crystal,
    /// 16 MHz, to within 1 % at 25 °C (table 41): times, rates and the baud rate are off by as much.
    Internal,
}

impl Source {
    /// PLLCFGR for 168 MHz: 2 MHz into the PLL, where its jitter is least (7.3.2), times 168, by 2.
    /// Q = 7 makes the 48 MHz that nothing here uses; bit 29 has to stay as it is.
    pub const fn pllcfgr(self) -> u32 {
        const N_Q_KEPT: u32 = 168 << 6 | 7 << 24 | 1 << 29;
        match self {
            Source::Crystal => N_Q_KEPT | PLLSRC_HSE | 4,
            Source::Internal => N_Q_KEPT | 8,
        }
    }
}

/// The PLL locked on neither source.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotLocked;

/// Leaves the PLL locked, on the crystal if that runs, and the core where it was, on the internal
/// oscillator. A crystal that runs but that the PLL does not lock on counts as dead. Takes 111 ms at
/// most.
///
/// # Errors
/// [`NotLocked`]; both are then off again.
pub fn start(rcc: &mut impl Registers) -> Result<Source, NotLocked> {
    if comes(rcc, HSEON, HSERDY, CRYSTAL_PAUSES) && locks(rcc, Source::Crystal) {
        return Ok(Source::Crystal);
    }
    change(rcc, HSEON, 0);
    match locks(rcc, Source::Internal) {
        true => Ok(Source::Internal),
        false => Err(NotLocked),
    }
}

/// Off again if it does not lock: only then may PLLCFGR be written once more.
fn locks(rcc: &mut impl Registers, source: Source) -> bool {
    rcc.write(Register::Pllcfgr, source.pllcfgr());
    let locked = comes(rcc, PLLON, PLLRDY, LOCK_PAUSES);
    if !locked {
        change(rcc, PLLON, 0);
    }
    locked
}

/// Sets a bit of CR and waits for another.
fn comes(rcc: &mut impl Registers, on: u32, ready: u32, pauses: u32) -> bool {
    change(rcc, 0, on);
    (0..pauses).any(|_| {
        rcc.pause();
        rcc.read(Register::Cr) & ready != 0
    })
}

fn change(rcc: &mut impl Registers, clear: u32, set: u32) {
    let before = rcc.read(Register::Cr);
    rcc.write(Register::Cr, before & !clear | set);
}
