//! AS5047P: magnetic encoder, 14 bits a turn, SPI mode 1, up to 10 MHz. Figures are those of its data
//! sheet (ams DS000324).
//!
//! A command is 16 bits: even parity, read, 14 bits of address (fig. 12). Its answer comes with the
//! next frame: even parity, an error flag that is about the command before, 14 bits of data (fig. 13).

use embedded_hal::spi::SpiDevice;

const READ: u16 = 0x4000;
const ERROR_FLAG: u16 = 0x4000;
const DATA: u16 = 0x3fff;
/// Addresses (fig. 17).
const NOP: u16 = 0x0000;
const ERRFL: u16 = 0x0001;
const DIAAGC: u16 = 0x3ffc;
const ANGLECOM: u16 = 0x3fff;

/// Why there is no reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Error<E> {
    /// The bus failed.
    Spi(E),
    /// An answer with odd parity: a disturbed line, or no sensor (a line that is always high has
    /// even parity and shows as a reported error).
    Parity(u16),
    /// The sensor flags an error; the register is cleared by having been read.
    Reported(Reported),
}

/// What the sensor says was wrong with a command (fig. 18).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reported {
    /// Not 16 clocks.
    pub framing: bool,
    /// No such address.
    pub command: bool,
    /// The command's parity.
    pub parity: bool,
}

/// How the magnet is (fig. 20).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Diagnosis {
    /// Gain of the field: 0 strong, 255 weak.
    pub gain: u8,
    /// The sensor has started up.
    pub ready: bool,
    /// The angle's calculation overflowed: readings are wrong.
    pub overflow: bool,
    /// The magnet is too near.
    pub too_strong: bool,
    /// The magnet is too far, or not there.
    pub too_weak: bool,
}

/// The angle, 0…16383, compensated for the delay of a turning shaft. Two frames, so that it is the
/// one of now, not of the last call.
///
/// # Errors
/// [`Error`].
pub fn angle<D: SpiDevice>(spi: &mut D) -> Result<u16, Error<D::Error>> {
    register(spi, ANGLECOM)
}

/// How the magnet is.
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

fn register<D: SpiDevice>(spi: &mut D, address: u16) -> Result<u16, Error<D::Error>> {
    let answer = raw(spi, address)?;
    if answer & ERROR_FLAG == 0 {
        return Ok(answer & DATA);
    }
    // Reading it clears it; its own answer still carries the flag.
    let bits = raw(spi, ERRFL)?;
    Err(Error::Reported(Reported {
        framing: bits & 1 != 0,
        command: bits & 2 != 0,
        parity: bits & 4 != 0,
    }))
}

/// The answer to a read, of right parity, with its flag.
fn raw<D: SpiDevice>(spi: &mut D, address: u16) -> Result<u16, Error<D::Error>> {
    // What comes with the command answers the one before.
    exchange(spi, with_parity(READ | address))?;
    let answer = exchange(spi, with_parity(READ | NOP))?;
    match answer.count_ones() % 2 {
        0 => Ok(answer),
        _ => Err(Error::Parity(answer)),
    }
}

fn exchange<D: SpiDevice>(spi: &mut D, command: u16) -> Result<u16, Error<D::Error>> {
    let mut bytes = command.to_be_bytes();
    spi.transfer_in_place(&mut bytes).map_err(Error::Spi)?;
    Ok(u16::from_be_bytes(bytes))
}

/// Bit 15 makes the number of ones even.
fn with_parity(bits: u16) -> u16 {
    bits | (((bits.count_ones() % 2) as u16) << 15)
}
