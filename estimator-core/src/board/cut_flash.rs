//! The flash of the tests: memory that loses power.

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};
extern crate std;
use std::vec;
use std::vec::Vec;

use crate::board::ram_flash::{SECTOR, SIZE};

/// Bytes that an erase clears in a step: a cut leaves a part erased.
const ERASE_STEP: usize = 64;

/// Flash in memory that loses power after so many steps: a byte written, or [`ERASE_STEP`] bytes
/// erased. Like the real one, a write only clears bits.
#[derive(Clone)]
pub(in crate::board) struct CutFlash {
    pub(in crate::board) bytes: Vec<u8>,
    pub(in crate::board) steps_left: u64,
    /// The bits that the byte in work still has after the cut.
    pub(in crate::board) torn: u8,
}

#[derive(Debug, PartialEq, Eq)]
pub(in crate::board) struct PowerCut;

impl NorFlashError for PowerCut {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

impl ErrorType for CutFlash {
    type Error = PowerCut;
}

impl CutFlash {
    pub(in crate::board) fn new(fill: u8) -> Self {
        CutFlash {
            bytes: vec![fill; SIZE],
            steps_left: u64::MAX,
            torn: 0,
        }
    }

    /// One step, unless the power is gone: `last` is then the step that it was cut in.
    fn step(&mut self) -> Result<(), bool> {
        match self.steps_left {
            0 => Err(false),
            1 => {
                self.steps_left = 0;
                Err(true)
            }
            _ => {
                self.steps_left -= 1;
                Ok(())
            }
        }
    }
}

impl ReadNorFlash for CutFlash {
    const READ_SIZE: usize = 1;
    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), PowerCut> {
        let start = offset as usize;
        bytes.copy_from_slice(&self.bytes[start..start + bytes.len()]);
        if self.steps_left == 0 {
            Err(PowerCut)
        } else {
            Ok(())
        }
    }
    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl NorFlash for CutFlash {
    const WRITE_SIZE: usize = 1;
    const ERASE_SIZE: usize = SECTOR as usize;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), PowerCut> {
        for start in (from as usize..to as usize).step_by(ERASE_STEP) {
            match self.step() {
                Ok(()) => self.bytes[start..start + ERASE_STEP].fill(0xff),
                Err(in_work) => {
                    if in_work {
                        let torn = self.torn;
                        let piece = &mut self.bytes[start..start + ERASE_STEP];
                        piece.iter_mut().for_each(|byte| *byte |= torn);
                    }
                    return Err(PowerCut);
                }
            }
        }
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), PowerCut> {
        for (index, byte) in bytes.iter().enumerate() {
            let at = offset as usize + index;
            match self.step() {
                Ok(()) => self.bytes[at] &= byte,
                Err(in_work) => {
                    if in_work {
                        self.bytes[at] &= byte | self.torn;
                    }
                    return Err(PowerCut);
                }
            }
        }
        Ok(())
    }
}
