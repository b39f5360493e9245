//! The start of the PLL: 168 MHz from the 8 MHz crystal or, where it is dead, from the internal oscillator,
//! with a bound on every wait. Sections are those of reference manual RM0090, tables those of the data sheet
//! DocID022152; tests/clock.rs runs it against a model of the registers.

/// A register of the reset and clock controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Register {
    /// CR switches the oscillators and the PLL on and shows which are ready (7.3.1).
    Cr,
    /// PLLCFGR has the PLL's input and factors (7.3.2).
    Pllcfgr,
}

/// The reset and clock controller right after a reset: the core runs from the internal oscillator, and
/// the PLL is off.
pub trait Registers {
    /// Reads all bits of a register.
    fn read(&self, register: Register) -> u32;
    /// Writes all bits of a register.
    fn write(&mut self, register: Register, value: u32);
    /// Waits for at least 10 µs.
    fn pause(&mut self);
}

/// CR: switches the crystal's oscillator on.
const HSEON: u32 = 1 << 16;
/// CR: the crystal's oscillator is ready.
const HSERDY: u32 = 1 << 17;
/// CR: switches the PLL on.
const PLLON: u32 = 1 << 24;
/// CR: the PLL has locked.
const PLLRDY: u32 = 1 << 25;
/// PLLCFGR: the PLL's input is the crystal.
const PLLSRC_HSE: u32 = 1 << 22;

/// Pauses until a crystal counts as dead: 100 ms. A good one takes 2 ms (table 40).
const CRYSTAL_PAUSES: u32 = 10_000;
/// Pauses until the PLL counts as not locking: 5 ms. It locks within 0.3 ms (table 43).
const LOCK_PAUSES: u32 = 500;

/// The input of the PLL.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// The crystal has 8 MHz to within some 10⁻⁵.
    Crystal,
    /// The internal oscillator has 16 MHz to within 1 % at 25 °C, 4 % from −10 to 85 °C, and −8 to 4.5 % from −40 to
    /// 105 °C (table 41): times, rates and the baud rate are off by as much. A serial line fails from 4 % on.
    Internal,
}

impl Source {
    /// Returns PLLCFGR for 168 MHz: the input is divided to 2 MHz, where the PLL's jitter is least (7.3.2),
    /// multiplied by 168 and divided by 2. Q = 7 makes 48 MHz, which nothing here uses; bit 29 keeps its
    /// value.
    pub const fn pllcfgr(self) -> u32 {
        const N_Q_KEPT: u32 = 168 << 6 | 7 << 24 | 1 << 29;
        match self {
            Source::Crystal => N_Q_KEPT | PLLSRC_HSE | 4,
            Source::Internal => N_Q_KEPT | 8,
        }
    }
}

/// The PLL has locked on neither source.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotLocked;

/// Locks the PLL on the crystal, or else on the internal oscillator, and leaves the core running from the
/// internal oscillator. A crystal on which the PLL does not lock counts as dead. Takes 111 ms at most.
///
/// # Errors
/// [`NotLocked`]; crystal and PLL are then off again.
pub fn start(rcc: &mut impl Registers) -> Result<Source, NotLocked> {
    if becomes_ready(rcc, HSEON, HSERDY, CRYSTAL_PAUSES) && locks(rcc, Source::Crystal) {
        return Ok(Source::Crystal);
    }
    change(rcc, HSEON, 0);
    match locks(rcc, Source::Internal) {
        true => Ok(Source::Internal),
        false => Err(NotLocked),
    }
}

/// Returns whether the PLL locks on a source. If not, it is off again: PLLCFGR may be written only then.
fn locks(rcc: &mut impl Registers, source: Source) -> bool {
    rcc.write(Register::Pllcfgr, source.pllcfgr());
    let locked = becomes_ready(rcc, PLLON, PLLRDY, LOCK_PAUSES);
    if !locked {
        change(rcc, PLLON, 0);
    }
    locked
}

/// Sets the bit `on` of CR and returns whether the bit `ready` is set within a number of pauses.
fn becomes_ready(rcc: &mut impl Registers, on: u32, ready: u32, pauses: u32) -> bool {
    change(rcc, 0, on);
    (0..pauses).any(|_| {
        rcc.pause();
        rcc.read(Register::Cr) & ready != 0
    })
}

/// Clears and sets bits of CR.
fn change(rcc: &mut impl Registers, clear: u32, set: u32) {
    let before = rcc.read(Register::Cr);
    rcc.write(Register::Cr, before & !clear | set);
}
