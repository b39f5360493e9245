//! What a flashing tool writes: the bytes of an image from the start of flash, and as Intel HEX.

use super::elf::segments;
use std::fmt::Write;
use std::fs;
use std::path::Path;

/// The address at which flash starts, and every image.
pub const FLASH_START: u32 = 0x0800_0000;

/// The bytes of an image from [`FLASH_START`] on.
pub struct Image {
    /// They end with the last one that is stored; gaps are 0xff, as erased flash is.
    pub bytes: Vec<u8>,
}

impl Image {
    /// Reads an ELF.
    ///
    /// # Errors
    /// The file is no 32-bit ELF, or has a part that is not in flash.
    pub fn of(elf: &Path) -> Result<Image, String> {
        let file = fs::read(elf).map_err(|e| format!("{}: {e}", elf.display()))?;
        Image::in_elf(&file).ok_or_else(|| format!("{}: no ELF of a board", elf.display()))
    }

    fn in_elf(file: &[u8]) -> Option<Image> {
        let mut bytes = Vec::new();
        for segment in segments(file)?.iter().filter(|s| !s.bytes.is_empty()) {
            let start = segment.stored_at.checked_sub(FLASH_START)? as usize;
            let end = start + segment.bytes.len();
            // A part that claims to be far outside of 1 MiB of flash is none of it.
            if end > 1 << 20 {
                return None;
            }
            if bytes.len() < end {
                bytes.resize(end, 0xff);
            }
            bytes[start..end].copy_from_slice(segment.bytes);
        }
        Some(Image { bytes })
    }

    /// The image as Intel HEX: records of 16 bytes, with the upper half of the address in a record of its own.
    pub fn to_hex(&self) -> String {
        let mut text = String::new();
        for (index, line) in self.bytes.chunks(16).enumerate() {
            let address = FLASH_START + 16 * index as u32;
            if address & 0xffff == 0 {
                record(&mut text, 0, 4, &((address >> 16) as u16).to_be_bytes());
            }
            record(&mut text, address as u16, 0, line);
        }
        record(&mut text, 0, 1, &[]);
        text
    }
}

/// Writes a record: length, address, kind, data, and what makes the sum of all bytes 0.
fn record(text: &mut String, address: u16, kind: u8, data: &[u8]) {
    let [high, low] = address.to_be_bytes();
    let mut bytes = vec![data.len() as u8, high, low, kind];
    bytes.extend_from_slice(data);
    let sum = bytes.iter().fold(0_u8, |sum, byte| sum.wrapping_add(*byte));
    bytes.push(sum.wrapping_neg());
    text.push(':');
    for byte in bytes {
        // Writing into a String cannot fail.
        let _ = write!(text, "{byte:02X}");
    }
    text.push('\n');
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hex_file_has_addresses_data_and_sums() {
        // 64 KiB and 3 bytes: two upper halves of the address, and a short last record.
        let mut bytes = vec![0; 0x1_0003];
        bytes[0x1_0000..].copy_from_slice(&[0x12, 0x34, 0x56]);
        let text = Image { bytes }.to_hex();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], ":020000040800F2");
        assert_eq!(lines[1], ":1000000000000000000000000000000000000000F0");
        let count = lines.len();
        assert_eq!(
            lines[count - 3..],
            [":020000040801F1", ":0300000012345661", ":00000001FF"]
        );
        assert_eq!(count, 2 + 4096 + 1 + 1);
    }
}
