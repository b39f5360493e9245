//! The settings' flash: its last two sectors.
//!
//! The part has one bank: while it erases (up to 4 s for 128 KiB) or programs (16 µs a byte, so 4 ms
//! for a record) the core cannot fetch and stands still, and the sampling task too. The responder
//! saves in free air only; the samples that are missing then are counted, and the filters restart.

use embedded_storage::nor_flash::{ErrorType, NorFlash, ReadNorFlash};
use stm32f4xx_hal::flash::{Error, FlashExt, LockedFlash};
use stm32f4xx_hal::pac::FLASH;

/// Offset of sectors 10 and 11, which memory.x leaves out of the program's flash.
pub const SETTINGS: u32 = 768 * 1024;
/// Bytes of one sector.
pub const SECTOR: u32 = 128 * 1024;

/// The flash, unlocked only while it is written to.
pub struct Flash(LockedFlash);

impl Flash {
    /// Takes the flash.
    pub fn new(flash: FLASH) -> Self {
        Flash(LockedFlash::new(flash))
    }

    /// Clears the flags of earlier errors by writing 1 to them (RM 3.9.5). The HAL never clears them and
    /// would report the next operation as failed.
    fn clear_errors() {
        // SAFETY: nothing else uses this register, since `self.0` owns the flash.
        unsafe {
            (*FLASH::ptr()).sr().write(|w| w.bits(0xf3));
        }
    }

    /// Turns the data cache off, resets it, and turns it on: it may hold the old contents (RM 3.5.2).
    fn refresh_cache() {
        // SAFETY: nothing else uses this register, since `self.0` owns the flash.
        let acr = unsafe { (*FLASH::ptr()).acr() };
        if acr.read().dcen().bit_is_set() {
            acr.modify(|_, w| w.dcen().clear_bit());
            acr.modify(|_, w| w.dcrst().set_bit());
            acr.modify(|_, w| w.dcrst().clear_bit());
            acr.modify(|_, w| w.dcen().set_bit());
        }
    }
}

impl ErrorType for Flash {
    type Error = Error;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Error> {
        ReadNorFlash::read(&mut self.0, offset, bytes)
    }

    fn capacity(&self) -> usize {
        ReadNorFlash::capacity(&self.0)
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = 1;
    const ERASE_SIZE: usize = SECTOR as usize;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Error> {
        Self::clear_errors();
        let erased = NorFlash::erase(&mut self.0.unlocked(), from, to);
        Self::refresh_cache();
        erased
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Error> {
        Self::clear_errors();
        let written = NorFlash::write(&mut self.0.unlocked(), offset, bytes);
        Self::refresh_cache();
        written
    }
}
