//! The image: what is loaded where, and where its symbols are.

use std::collections::BTreeMap;
use std::path::Path;

/// An image for the board.
pub struct Image {
    /// The whole file, which a decoder of its log wants.
    pub file: Vec<u8>,
    /// Pieces of the flash: address and bytes.
    pub(crate) pieces: Vec<(u32, Vec<u8>)>,
    /// Addresses of the symbols.
    pub symbols: BTreeMap<String, u32>,
    /// Those that are functions.
    pub(crate) functions: Vec<Function>,
}

/// A function in flash.
pub(crate) struct Function {
    pub(crate) at: u32,
    pub(crate) bytes: u32,
    pub(crate) name: String,
}

fn half(bytes: &[u8], at: usize) -> Option<usize> {
    let two = bytes.get(at..at + 2)?.try_into().ok()?;
    Some(usize::from(u16::from_le_bytes(two)))
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    let four = bytes.get(at..at + 4)?.try_into().ok()?;
    Some(u32::from_le_bytes(four))
}

impl Image {
    /// Reads an ELF file.
    ///
    /// # Errors
    /// The file cannot be read, or is no ELF of 32 bits.
    pub fn read(path: &Path) -> Result<Image, String> {
        let file = std::fs::read(path).map_err(|e| format!("{}: {e}", path.display()))?;
        let parsed = pieces(&file).zip(symbols(&file));
        let (pieces, (symbols, functions)) =
            parsed.ok_or_else(|| format!("{}: not a 32-bit ELF", path.display()))?;
        Ok(Image {
            file,
            pieces,
            symbols,
            functions,
        })
    }

    /// The half word at an address; 0 where nothing is loaded.
    pub(crate) fn half(&self, at: u32) -> u16 {
        let halves = self.pieces.iter().filter_map(|(start, bytes)| {
            let from = at.checked_sub(*start)? as usize;
            Some(u16::from_le_bytes(
                bytes.get(from..from + 2)?.try_into().ok()?,
            ))
        });
        halves.last().unwrap_or(0)
    }
}

/// The segments that are loaded, at the addresses that they are loaded to.
fn pieces(file: &[u8]) -> Option<Vec<(u32, Vec<u8>)>> {
    if file.get(..5)? != b"\x7fELF\x01" {
        return None;
    }
    let (table, size, count) = (word(file, 28)? as usize, half(file, 42)?, half(file, 44)?);
    let mut pieces = Vec::new();
    for index in 0..count {
        let header = table + index * size;
        let (kind, from) = (word(file, header)?, word(file, header + 4)? as usize);
        let (to, bytes) = (word(file, header + 12)?, word(file, header + 16)? as usize);
        if kind == 1 && bytes > 0 {
            pieces.push((to, file.get(from..from + bytes)?.to_vec()));
        }
    }
    Some(pieces)
}

fn symbols(file: &[u8]) -> Option<(BTreeMap<String, u32>, Vec<Function>)> {
    const SYMTAB: u32 = 2;
    const FUNCTION: u8 = 2;
    let (table, size, count) = (word(file, 32)? as usize, half(file, 46)?, half(file, 48)?);
    let (mut symbols, mut functions) = (BTreeMap::new(), Vec::new());
    for index in 0..count {
        let section = table + index * size;
        if word(file, section + 4)? != SYMTAB {
            continue;
        }
        let (from, bytes) = (
            word(file, section + 16)? as usize,
            word(file, section + 20)?,
        );
        let names = table + word(file, section + 24)? as usize * size;
        let names = file.get(word(file, names + 16)? as usize..)?;
        for symbol in (from..from + bytes as usize).step_by(16) {
            let name = names.get(word(file, symbol)? as usize..)?;
            let end = name.iter().position(|byte| *byte == 0)?;
            let name = String::from_utf8_lossy(&name[..end]).into_owned();
            let at = word(file, symbol + 4)?;
            if file.get(symbol + 12)? & 0xf == FUNCTION {
                functions.push(Function {
                    at: at & !1,
                    bytes: word(file, symbol + 8)?,
                    name: name.clone(),
                });
            }
            symbols.insert(name, at);
        }
    }
    Some((symbols, functions))
}
