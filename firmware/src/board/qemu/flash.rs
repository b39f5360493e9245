//! The settings' flash: in memory, with its contents in a file, since the emulated flash controller does
//! nothing.

use core::ffi::CStr;
use estimator_core::board::ram_flash::{RamFlash, SIZE};
use semihosting::fs::File;
use semihosting::io::{Read, Write};

/// Name of the file in QEMU's working directory.
const FILE: &CStr = c"settings.flash";

/// Reads the file; without a file, and after its end, the flash is blank.
pub fn open() -> RamFlash {
    let mut bytes = [0xff; SIZE];
    if let Ok(mut file) = File::open(FILE) {
        // A read of a short file leaves the rest blank.
        let _ = file.read(&mut bytes);
    }
    RamFlash::new(bytes, keep)
}

/// Writes the contents to the file.
fn keep(bytes: &[u8]) {
    let written = File::create(FILE).and_then(|mut file| file.write_all(bytes));
    if written.is_err() {
        defmt::panic!("cannot write settings.flash");
    }
}
