//! What an image takes of the board's memories.

use std::fs;
use std::path::Path;

/// The bytes of flash and of RAM (without stack) that an image for the board takes.
pub fn footprint(elf: &Path) -> Result<(u64, u64), String> {
    let bytes = fs::read(elf).map_err(|e| format!("{}: {e}", elf.display()))?;
    load_segments(&bytes).ok_or_else(|| format!("{}: not a 32-bit ELF", elf.display()))
}

/// A segment that is loaded: its address in flash, its address where it runs, its bytes in the file, and its
/// length in memory.
pub(super) struct Segment<'a> {
    pub(super) stored_at: u32,
    runs_at: u32,
    pub(super) bytes: &'a [u8],
    in_memory: u32,
}

/// The segments that are loaded from a little-endian ELF32.
pub(super) fn segments(elf: &[u8]) -> Option<Vec<Segment<'_>>> {
    const LOAD: u32 = 1;
    let half = |at: usize| Some(u16::from_le_bytes(elf.get(at..at + 2)?.try_into().ok()?));
    let word = |at: usize| Some(u32::from_le_bytes(elf.get(at..at + 4)?.try_into().ok()?));
    if elf.get(..5)? != b"\x7fELF\x01" {
        return None;
    }
    let (table, size, count) = (word(28)?, half(42)?, half(44)?);
    let mut segments = Vec::new();
    for index in 0..count {
        let header = table as usize + usize::from(index) * usize::from(size);
        if word(header)? == LOAD {
            let (from, length) = (word(header + 4)? as usize, word(header + 16)? as usize);
            segments.push(Segment {
                stored_at: word(header + 12)?,
                runs_at: word(header + 8)?,
                bytes: elf.get(from..from + length)?,
                in_memory: word(header + 20)?,
            });
        }
    }
    Some(segments)
}

fn load_segments(elf: &[u8]) -> Option<(u64, u64)> {
    let (mut flash, mut ram) = (0, 0);
    for segment in segments(elf)? {
        flash += segment.bytes.len() as u64;
        ram += u64::from(segment.in_memory) * u64::from(segment.runs_at >= 0x2000_0000);
    }
    Some((flash, ram))
}
