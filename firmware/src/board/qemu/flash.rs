//! Flash in memory, kept in a file: the emulated flash controller does nothing.

use core::convert::Infallible;
use core::ffi::CStr;
use embedded_storage::nor_flash::{ErrorType, NorFlash, ReadNorFlash};
use estimator_core::board::settings::store::SLOT;
use semihosting::fs::File;
use semihosting::io::{Read, Write};

const FILE: &CStr = c"settings.flash";
/// Four slots: every fourth save erases, so that a test meets erases.
pub const SECTOR: u32 = 4 * SLOT as u32;
const SIZE: usize = 2 * SECTOR as usize;

/// Two sectors.
pub struct FlashFile {
    bytes: [u8; SIZE],
}

impl FlashFile {
    /// What the file holds; blank where it holds nothing.
    pub fn open() -> Self {
        let mut bytes = [0xff; SIZE];
        if let Ok(mut file) = File::open(FILE) {
            // A short file is blank at its end.
            let _ = file.read(&mut bytes);
        }
        FlashFile { bytes }
    }

    fn keep(&self) {
        let written = File::create(FILE).and_then(|mut file| file.write_all(&self.bytes));
        if written.is_err() {
            defmt::panic!("cannot write settings.flash");
        }
    }
}

impl ErrorType for FlashFile {
    type Error = Infallible;
}

impl ReadNorFlash for FlashFile {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Infallible> {
        let start = offset as usize;
        bytes.copy_from_slice(&self.bytes[start..start + bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        SIZE
    }
}

impl NorFlash for FlashFile {
    const WRITE_SIZE: usize = 1;
    const ERASE_SIZE: usize = SECTOR as usize;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Infallible> {
        self.bytes[from as usize..to as usize].fill(0xff);
        self.keep();
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Infallible> {
        for (slot, byte) in self.bytes[offset as usize..].iter_mut().zip(bytes) {
            *slot &= byte;
        }
        self.keep();
        Ok(())
    }
}
