//! A debug probe: it reads the log out of the board's memory (RTT), or leaves.

use crate::elf::Image;
use crate::machine::Machine;
use defmt_decoder::{DecodeError, Table};

/// Blocking mode of a channel: the board waits until there is room.
const BLOCKING: u32 = 2;

/// The probe.
pub struct Probe {
    block: u32,
    bytes: Vec<u8>,
}

impl Probe {
    /// A probe at a board with this image.
    pub fn new(image: &Image) -> Self {
        Probe {
            block: image.symbols.get("_SEGGER_RTT").copied().unwrap_or(0),
            bytes: Vec::new(),
        }
    }

    /// Takes what has been logged since the last time.
    pub fn read(&mut self, machine: &mut Machine) {
        let chip = &mut machine.chip;
        let field = |index: u32| self.block + 24 + 4 * index;
        let (buffer, size) = (chip.word(field(1)), chip.word(field(2)));
        let (write, mut read) = (chip.word(field(3)), chip.word(field(4)));
        if size == 0
            || size > 65_536
            || write >= size
            || read >= size
            || chip.word(self.block) != u32::from_le_bytes(*b"SEGG")
        {
            return;
        }
        while read != write {
            let word = chip.word((buffer + read) & !3);
            self.bytes.push((word >> (8 * ((buffer + read) & 3))) as u8);
            read = (read + 1) % size;
        }
        chip.poke(field(4), read);
    }

    /// Makes the board wait for the probe when its log is full, as probe-rs does.
    pub fn block(&self, machine: &mut Machine) {
        let flags = self.block + 24 + 20;
        let value = machine.chip.word(flags) & !3 | BLOCKING;
        machine.chip.poke(flags, value);
    }

    /// Fills the log, as a program does that has logged much since the probe has left.
    pub fn fill(&self, machine: &mut Machine) {
        let field = |index: u32| self.block + 24 + 4 * index;
        let size = machine.chip.word(field(2));
        let read = machine.chip.word(field(4));
        machine.chip.poke(field(3), (read + size - 1) % size.max(1));
    }

    /// The lines of the log so far.
    pub fn log(&self, image: &Image) -> Vec<String> {
        let Ok(Some(table)) = Table::parse(&image.file) else {
            return Vec::new();
        };
        let mut decoder = table.new_stream_decoder();
        decoder.received(&self.bytes);
        let mut lines = Vec::new();
        loop {
            match decoder.decode() {
                Ok(frame) => {
                    let level = frame.level().map_or("println", |level| level.as_str());
                    lines.push(format!("{level:5} {}", frame.display_message()));
                }
                Err(DecodeError::UnexpectedEof) => return lines,
                // A reset in the middle of a line; rzCOBS is in step again at the next zero.
                Err(DecodeError::Malformed) => lines.push("(malformed)".into()),
            }
        }
    }
}
