//! What an image takes of the board's memories.

use std::fs;
use std::path::Path;

/// The bytes of flash and of RAM (without stack) that an image for the board takes.
pub fn footprint(elf: &Path) -> Result<(u64, u64), String> {
    let bytes = fs::read(elf).map_err(|e| format!("{}: {e}", elf.display()))?;
    load_segments(&bytes).ok_or_else(|| format!("{}: not a 32-bit ELF", elf.display()))
}

/// The sums over the segments that are loaded from a little-endian ELF32.
fn load_segments(elf: &[u8]) -> Option<(u64, u64)> {
    let half = |at: usize| Some(u16::from_le_bytes(elf.get(at..at + 2)?.try_into().ok()?));
    let word = |at: usize| Some(u32::from_le_bytes(elf.get(at..at + 4)?.try_into().ok()?));
    if elf.get(..5)? != b"\x7fELF\x01" {
        return None;
    }
    let (table, size, count) = (word(28)?, half(42)?, half(44)?);
    let (mut flash, mut ram) = (0, 0);
    for index in 0..count {
        let header = table as usize + usize::from(index) * usize::from(size);
        const LOAD: u32 = 1;
        if word(header)? == LOAD {
            let (address, in_file, in_memory) =
                (word(header + 8)?, word(header + 16)?, word(header + 20)?);
            flash += u64::from(in_file);
            ram += u64::from(in_memory) * u64::from(address >= 0x2000_0000);
        }
    }
    Some((flash, ram))
}
