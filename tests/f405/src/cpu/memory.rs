//! Loads and stores, of one register and of several.

use super::Core;
use super::op::{Mode, Width};
use crate::chip::Chip;

fn bytes(width: Width) -> u32 {
    match width {
        Width::Word => 4,
        Width::Half | Width::SignedHalf => 2,
        Width::Byte | Width::SignedByte => 1,
    }
}

impl Core {
    pub(super) fn load(&mut self, chip: &mut Chip, width: Width, at: u32) -> u32 {
        let value = chip.read(at, bytes(width));
        match width {
            Width::SignedHalf => value as i16 as u32,
            Width::SignedByte => value as i8 as u32,
            _ => value,
        }
    }

    pub(super) fn store(&mut self, chip: &mut Chip, width: Width, at: u32, value: u32) {
        chip.write(at, bytes(width), value);
    }

    /// The address of an access; the base takes the offset over where the mode says so.
    pub(super) fn address(&mut self, n: u8, imm: i32, mode: Mode) -> u32 {
        let base = self.r[n as usize];
        let moved = base.wrapping_add_signed(imm);
        if mode != Mode::Offset {
            self.r[n as usize] = moved;
        }
        match mode {
            Mode::Post => base,
            _ => moved,
        }
    }

    /// The lowest address of an access to several words, after which the base is taken over.
    pub(super) fn span(&mut self, n: u8, words: u32, back: bool, before: bool) -> u32 {
        let base = self.r[n as usize];
        let (low, after) = match before {
            true => (base.wrapping_sub(4 * words), base.wrapping_sub(4 * words)),
            false => (base, base.wrapping_add(4 * words)),
        };
        if back {
            self.r[n as usize] = after;
        }
        low
    }

    pub(super) fn load_many(&mut self, chip: &mut Chip, n: u8, list: u16, (back, before): Many) {
        let mut at = self.span(n, list.count_ones(), back, before);
        for index in (0..15).filter(|index| list >> index & 1 == 1) {
            self.r[index] = chip.read(at, 4);
            at = at.wrapping_add(4);
        }
        if list >> 15 & 1 == 1 {
            let to = chip.read(at, 4);
            self.jump(chip, to);
        }
    }

    pub(super) fn store_many(&mut self, chip: &mut Chip, n: u8, list: u16, (back, before): Many) {
        let values = self.r;
        let mut at = self.span(n, list.count_ones(), back, before);
        for index in (0..16).filter(|index| list >> index & 1 == 1) {
            chip.write(at, 4, values[index]);
            at = at.wrapping_add(4);
        }
    }

    pub(super) fn float_many(
        &mut self,
        chip: &mut Chip,
        load: bool,
        s: u8,
        words: u8,
        mut at: u32,
    ) {
        for index in usize::from(s)..(usize::from(s) + usize::from(words)).min(32) {
            match load {
                true => self.s[index] = chip.read(at, 4),
                false => chip.write(at, 4, self.s[index]),
            }
            at = at.wrapping_add(4);
        }
    }
}

/// Whether the base is taken over, and whether the words lie below it.
pub(super) type Many = (bool, bool);
