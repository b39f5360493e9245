//! ADS1220: 24-bit converter for bridges, SPI mode 1, up to 6.6 MHz. Sections are those of its data
//! sheet (TI SBAS501).
//!
//! Every conversion is started by the tick and fetched at the next one, so that force and position
//! belong to the same instants; a converter that runs by itself would drift against the tick.

use embedded_hal::spi::{Operation, SpiDevice};

/// Commands (8.5.3).
const RESET: u8 = 0x06;
const START: u8 = 0x08;
const RDATA: u8 = 0x10;
/// All four registers from the first.
const RREG_ALL: u8 = 0x23;
const WREG_ALL: u8 = 0x43;

/// The registers (8.6): AIN1 against AIN2 with gain 128 (a bridge of 2 mV/V at 3.3 V makes 6.6 mV of
/// the ±26 mV); 2000 conversions a second in turbo mode, one at a time, 0.5 ms each; against the
/// bridge's own supply on REFP0 and REFN0, so that its drift cancels; no current sources, DRDY on its
/// own pin.
pub const REGISTERS: [u8; 4] = [0x3e, 0xd0, 0x40, 0x00];

/// After a reset: 50 µs and 32 periods of its 4.096 MHz (8.5.3.1).
const RESET_NS: u32 = 60_000;

/// Why there is no reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Error<E> {
    /// The bus failed.
    Spi(E),
    /// The registers read other than what was written: no converter, or a disturbed line.
    Readback([u8; 4]),
}

/// Resets the converter, writes its registers and reads them back.
///
/// # Errors
/// [`Error`].
pub fn set_up<D: SpiDevice>(spi: &mut D) -> Result<(), Error<D::Error>> {
    let reset = &mut [Operation::Write(&[RESET]), Operation::DelayNs(RESET_NS)];
    spi.transaction(reset).map_err(Error::Spi)?;
    let [a, b, c, d] = REGISTERS;
    spi.write(&[WREG_ALL, a, b, c, d]).map_err(Error::Spi)?;
    let mut read = [RREG_ALL, 0, 0, 0, 0];
    spi.transfer_in_place(&mut read).map_err(Error::Spi)?;
    let [_, a, b, c, d] = read;
    match [a, b, c, d] {
        REGISTERS => Ok(()),
        other => Err(Error::Readback(other)),
    }
}

/// Fetches the conversion that is done, and starts the next.
///
/// # Errors
/// [`Error::Spi`].
pub fn fetch_and_start<D: SpiDevice>(spi: &mut D) -> Result<i32, Error<D::Error>> {
    // Zeros while the data come: DIN must not say anything (8.5.4).
    let mut data = [0; 3];
    spi.transaction(&mut [
        Operation::Write(&[RDATA]),
        Operation::TransferInPlace(&mut data),
        Operation::Write(&[START]),
    ])
    .map_err(Error::Spi)?;
    let [high, middle, low] = data;
    // Two's complement of 24 bits, sign extended.
    Ok(i32::from_be_bytes([high, middle, low, 0]) >> 8)
}
