//! Flash in memory: the settings' flash of the emulator and of the host's simulated board.

use crate::board::settings::store::SLOT;
use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash};

/// Bytes of a sector. It holds four slots: every fourth save erases, so that tests include erases.
pub const SECTOR: u32 = 4 * SLOT as u32;
/// Bytes of the flash: two sectors.
pub const SIZE: usize = 2 * SECTOR as usize;

/// A flash of two sectors whose contents are lost with it, unless `changed` keeps them.
#[derive(Clone, Debug)]
pub struct RamFlash {
    bytes: [u8; SIZE],
    changed: fn(&[u8]),
}

impl Default for RamFlash {
    fn default() -> Self {
        RamFlash::new([0xff; SIZE], |_| {})
    }
}

impl RamFlash {
    /// Makes a flash with these contents, and calls `changed` with the new ones after every change.
    pub fn new(bytes: [u8; SIZE], changed: fn(&[u8])) -> Self {
        RamFlash { bytes, changed }
    }

    /// Returns the contents.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    fn area(&mut self, from: usize, to: usize) -> Result<&mut [u8], NorFlashErrorKind> {
        let area = self.bytes.get_mut(from..to);
        area.ok_or(NorFlashErrorKind::OutOfBounds)
    }
}

impl ErrorType for RamFlash {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for RamFlash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        let from = offset as usize;
        let area = self.area(from, from.saturating_add(bytes.len()))?;
        bytes.copy_from_slice(area);
        Ok(())
    }

    fn capacity(&self) -> usize {
        SIZE
    }
}

impl NorFlash for RamFlash {
    const WRITE_SIZE: usize = 1;
    const ERASE_SIZE: usize = SECTOR as usize;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        self.area(from as usize, to as usize)?.fill(0xff);
        (self.changed)(&self.bytes);
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        let from = offset as usize;
        let area = self.area(from, from.saturating_add(bytes.len()))?;
        // A write clears bits; only an erase sets them.
        area.iter_mut()
            .zip(bytes)
            .for_each(|(stored, byte)| *stored &= byte);
        (self.changed)(&self.bytes);
        Ok(())
    }
}
