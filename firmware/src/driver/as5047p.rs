//! Driver of the AS5047P, a magnetic encoder of 14 bits a turn: SPI mode 1, up to 10 MHz. Figures are those of
//! its data sheet (ams DS000324).
//!
//! A command has 16 bits: even parity, a read flag, 14 bits of address (fig. 12). Its answer comes with the
//! next frame: even parity, an error flag for the command before, 14 bits of data (fig. 13).

use embedded_hal::spi::SpiDevice;

/// Counts of a turn, after which the angle begins again.
pub const COUNTS: u32 = 1 << 14;

const READ: u16 = 0x4000;
const ERROR_FLAG: u16 = 0x4000;
const DATA: u16 = (COUNTS - 1) as u16;
/// The addresses (fig. 17).
const NOP: u16 = 0x0000;
const ERRFL: u16 = 0x0001;
const DIAAGC: u16 = 0x3ffc;
const ANGLECOM: u16 = 0x3fff;

/// The reason why there is no reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Error<E> {
    /// The bus failed.
    Spi(E),
    /// An answer has odd parity: the line is disturbed, or there is no sensor. (A line that is always high
    /// has even parity and shows as a reported error.)
    Parity(u16),
    /// The sensor has flagged an error. Reading the error register has cleared it.
    Reported(Reported),
}

/// The errors of a command that the sensor reports (fig. 18).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reported {
    /// The frame did not have 16 clocks.
    pub framing: bool,
    /// There is no such address.
    pub command: bool,
    /// The command had the wrong parity.
    pub parity: bool,
}

/// The state of the magnet's field (fig. 20).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Diagnosis {
    /// The gain for the field: 0 means strong, 255 weak.
    pub gain: u8,
    /// The sensor has started up.
    pub ready: bool,
    /// The calculation of the angle has overflowed: readings are wrong.
    pub overflow: bool,
    /// The magnet is too near.
    pub too_strong: bool,
    /// The magnet is too far away, or missing.
    pub too_weak: bool,
}

/// Reads the angle, 0…16383, which the sensor compensates for the delay of a turning shaft. This takes two
/// frames: the first asks for the angle of now, the second brings it.
///
/// # Errors
/// [`Error`].
pub fn angle<D: SpiDevice>(spi: &mut D) -> Result<u16, Error<D::Error>> {
    register(spi, ANGLECOM)
}

/// Reads the state of the magnet's field.
///
/// # Errors
/// [`Error`].
pub fn diagnose<D: SpiDevice>(spi: &mut D) -> Result<Diagnosis, Error<D::Error>> {
    let bits = register(spi, DIAAGC)?;
    Ok(Diagnosis {
        gain: bits as u8,
        ready: bits & 1 << 8 != 0,
        overflow: bits & 1 << 9 != 0,
        too_strong: bits & 1 << 10 != 0,
        too_weak: bits & 1 << 11 != 0,
    })
}

/// Reads a register. If the sensor flags an error, reads and so clears the error register.
fn register<D: SpiDevice>(spi: &mut D, address: u16) -> Result<u16, Error<D::Error>> {
    let answer = raw(spi, address)?;
    if answer & ERROR_FLAG == 0 {
        return Ok(answer & DATA);
    }
    // This answer still has the flag set.
    let bits = raw(spi, ERRFL)?;
    Err(Error::Reported(Reported {
        framing: bits & 1 != 0,
        command: bits & 2 != 0,
        parity: bits & 4 != 0,
    }))
}

/// Returns the answer to a read, with its flag, if its parity is right.
fn raw<D: SpiDevice>(spi: &mut D, address: u16) -> Result<u16, Error<D::Error>> {
    // The word that comes with the command answers the command before.
    exchange(spi, with_parity(READ | address))?;
    let answer = exchange(spi, with_parity(READ | NOP))?;
    match answer.count_ones() % 2 {
        0 => Ok(answer),
        _ => Err(Error::Parity(answer)),
    }
}

/// Exchanges one frame.
fn exchange<D: SpiDevice>(spi: &mut D, command: u16) -> Result<u16, Error<D::Error>> {
    let mut bytes = command.to_be_bytes();
    spi.transfer_in_place(&mut bytes).map_err(Error::Spi)?;
    Ok(u16::from_be_bytes(bytes))
}

/// Sets bit 15 where the number of ones is odd.
fn with_parity(bits: u16) -> u16 {
    bits | (((bits.count_ones() % 2) as u16) << 15)
}
