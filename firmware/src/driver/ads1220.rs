//! Driver of the ADS1220, a 24-bit converter for bridges: SPI mode 1, up to 6.6 MHz. Sections are those of its
//! data sheet (TI SBAS501).
//!
//! A tick starts every conversion and the next tick fetches it, so that force and position belong to the same
//! instants; a converter that runs by itself would drift against the tick.

use embedded_hal::spi::{Operation, SpiDevice};

/// The commands (8.5.3).
const RESET: u8 = 0x06;
const START: u8 = 0x08;
const RDATA: u8 = 0x10;
/// Reads and writes of all four registers, from the first.
const RREG_ALL: u8 = 0x23;
const WREG_ALL: u8 = 0x43;

/// The registers (8.6) select AIN1 against AIN2 with gain 128 (a bridge of 2 mV/V at 3.3 V makes 6.6 mV of
/// the ±26 mV); turbo mode with 2000 conversions a second, one at a time, 0.5 ms each; the bridge's supply on
/// REFP0 and REFN0 as the reference, so that its drift cancels; no current sources; DRDY on a pin of its own.
pub const REGISTERS: [u8; 4] = [0x3e, 0xd0, 0x40, 0x00];

/// Wait after a reset (ns): 50 µs and 32 periods of the converter's 4.096 MHz (8.5.3.1).
const RESET_NS: u32 = 60_000;

/// The reason why there is no reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Error<E> {
    /// The bus failed.
    Spi(E),
    /// The registers read back other values than were written: no converter, or a disturbed line.
    Readback([u8; 4]),
}

/// Resets the converter, writes its registers and reads them back.
///
/// # Errors
/// [`Error`].
pub fn set_up<D: SpiDevice>(spi: &mut D) -> Result<(), Error<D::Error>> {
    let reset = &mut [Operation::Write(&[RESET]), Operation::DelayNs(RESET_NS)];
    spi.transaction(reset).map_err(Error::Spi)?;
    write_registers(spi)?;
    let mut read = [RREG_ALL, 0, 0, 0, 0];
    spi.transfer_in_place(&mut read).map_err(Error::Spi)?;
    let [_, a, b, c, d] = read;
    match [a, b, c, d] {
        REGISTERS => Ok(()),
        other => Err(Error::Readback(other)),
    }
}

/// Writes the registers, 8 µs at 5.25 MHz.
///
/// # Errors
/// [`Error::Spi`].
pub fn write_registers<D: SpiDevice>(spi: &mut D) -> Result<(), Error<D::Error>> {
    let [a, b, c, d] = REGISTERS;
    spi.write(&[WREG_ALL, a, b, c, d]).map_err(Error::Spi)
}

/// The ticks in a row without a conversion. A converter whose supply was gone for an instant has the registers of its
/// start, with 20 conversions a second, of which every tick breaks the one of the tick before.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silence {
    ticks: u8,
}

/// Ticks without a conversion until the registers are written again: 0.1 s.
pub const PATIENCE: u8 = 100;

impl Silence {
    /// Takes note of a tick, `ready` if there was a conversion, and returns whether the registers are to be written
    /// again: at every hundredth tick in a row without one.
    pub fn lasts(&mut self, ready: bool) -> bool {
        self.ticks = match ready {
            true => 0,
            false => self.ticks.saturating_add(1),
        };
        let lasts = self.ticks >= PATIENCE;
        if lasts {
            self.ticks = 0;
        }
        lasts
    }
}

/// Fetches the conversion that is done and starts the next one.
///
/// # Errors
/// [`Error::Spi`].
pub fn fetch_and_start<D: SpiDevice>(spi: &mut D) -> Result<i32, Error<D::Error>> {
    // DIN must be zero while the data come (8.5.4).
    let mut data = [0; 3];
    spi.transaction(&mut [
        Operation::Write(&[RDATA]),
        Operation::TransferInPlace(&mut data),
        Operation::Write(&[START]),
    ])
    .map_err(Error::Spi)?;
    let [high, middle, low] = data;
    // The code is a two's complement of 24 bits; the shift extends its sign.
    Ok(i32::from_be_bytes([high, middle, low, 0]) >> 8)
}
