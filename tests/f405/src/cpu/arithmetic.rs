//! Integer arithmetic with its flags.

use super::Core;
use super::op::{Alu, Extend, Lanes, Long, Shift, Unary};

/// A sum with a carry, and the carry and overflow that come of it.
fn sum(a: u32, b: u32, carry: bool) -> (u32, bool, bool) {
    let wide = u64::from(a) + u64::from(b) + u64::from(carry);
    let result = wide as u32;
    let overflow = (a ^ result) & (b ^ result) & 1 << 31 != 0;
    (result, wide >> 32 != 0, overflow)
}

/// A shifted value and the carry that falls out; nothing falls out of a shift by 0.
pub(super) fn shifted(value: u32, shift: Shift, by: u32, carry: bool) -> (u32, bool) {
    if by == 0 {
        return (value, carry);
    }
    let out = |bit: u32| value >> bit & 1 == 1;
    match (shift, by) {
        (Shift::Rrx, _) => (value >> 1 | u32::from(carry) << 31, out(0)),
        (Shift::Lsl, 1..=31) => (value << by, out(32 - by)),
        (Shift::Lsl, 32) => (0, out(0)),
        (Shift::Lsr, 1..=31) => (value >> by, out(by - 1)),
        (Shift::Lsr, 32) => (0, out(31)),
        (Shift::Lsl | Shift::Lsr, _) => (0, false),
        (Shift::Asr, 1..=31) => ((value as i32 >> by) as u32, out(by - 1)),
        (Shift::Asr, _) => ((value as i32 >> 31) as u32, out(31)),
        (Shift::Ror, _) => {
            let result = value.rotate_right(by % 32);
            (result, result >> 31 == 1)
        }
    }
}

impl Core {
    /// A function of two operands; `carry` is that of the shifter.
    pub(super) fn alu(&mut self, f: Alu, s: bool, a: u32, b: u32, carry: bool) -> u32 {
        let (result, carry, overflow) = match f {
            Alu::And => (a & b, carry, self.v),
            Alu::Bic => (a & !b, carry, self.v),
            Alu::Orr => (a | b, carry, self.v),
            Alu::Orn => (a | !b, carry, self.v),
            Alu::Eor => (a ^ b, carry, self.v),
            Alu::Mov => (b, carry, self.v),
            Alu::Mvn => (!b, carry, self.v),
            Alu::Add => sum(a, b, false),
            Alu::Adc => sum(a, b, self.c),
            Alu::Sbc => sum(a, !b, self.c),
            Alu::Sub => sum(a, !b, true),
            Alu::Rsb => sum(!a, b, true),
        };
        if s {
            self.signs(result);
            (self.c, self.v) = (carry, overflow);
        }
        result
    }

    pub(super) fn signs(&mut self, result: u32) {
        self.n = result >> 31 == 1;
        self.z = result == 0;
    }

    pub(super) fn long(&mut self, f: Long, (low, high): (u8, u8), a: u32, b: u32) {
        let before = u64::from(self.r[high as usize]) << 32 | u64::from(self.r[low as usize]);
        let signed = (i64::from(a as i32) * i64::from(b as i32)) as u64;
        let unsigned = u64::from(a) * u64::from(b);
        let result = match f {
            Long::Smull => signed,
            Long::Umull => unsigned,
            Long::Smlal => before.wrapping_add(signed),
            Long::Umlal => before.wrapping_add(unsigned),
            Long::Umaal => unsigned
                .wrapping_add(before >> 32)
                .wrapping_add(before & 0xffff_ffff),
        };
        self.r[low as usize] = result as u32;
        self.r[high as usize] = (result >> 32) as u32;
    }

    /// Saturates to `to` bits and sets Q if that changes the value.
    pub(super) fn saturate(&mut self, signed: bool, value: u32, to: u8) -> u32 {
        let value = i64::from(value as i32);
        let (least, most) = match signed {
            true => (-(1_i64 << (to - 1)), (1_i64 << (to - 1)) - 1),
            false => (0, (1_i64 << to) - 1),
        };
        let result = value.clamp(least, most);
        self.q |= result != value;
        result as u32
    }
}

pub(super) fn extended(kind: Extend, value: u32) -> u32 {
    match kind {
        Extend::SignedByte => value as i8 as u32,
        Extend::SignedHalf => value as i16 as u32,
        Extend::Byte => value & 0xff,
        Extend::Half => value & 0xffff,
        Extend::Bytes => value & 0x00ff_00ff,
        Extend::SignedBytes => {
            let (low, high) = (value as i8 as u16, (value >> 16) as i8 as u16);
            u32::from(low) | u32::from(high) << 16
        }
    }
}

pub(super) fn unary(f: Unary, value: u32) -> u32 {
    match f {
        Unary::Clz => value.leading_zeros(),
        Unary::Rbit => value.reverse_bits(),
        Unary::Rev => value.swap_bytes(),
        Unary::Rev16 => value.swap_bytes().rotate_left(16),
        Unary::Revsh => (value as u16).swap_bytes() as i16 as u32,
    }
}

/// Saturating sums of lanes.
pub(super) fn lanes(f: Lanes, a: u32, b: u32) -> u32 {
    let width = if f.bytes { 8 } else { 16 };
    let mask = (1_u32 << width) - 1;
    let lane = |value: u32, index: u32| {
        let lane = i64::from(value >> (index * width) & mask);
        match f.signed && lane >> (width - 1) == 1 {
            true => lane - (1 << width),
            false => lane,
        }
    };
    let (least, most) = match f.signed {
        true => (-(1_i64 << (width - 1)), (1_i64 << (width - 1)) - 1),
        false => (0, i64::from(mask)),
    };
    (0..32 / width).fold(0, |all, index| {
        let (a, b) = (lane(a, index), lane(b, index));
        let result = if f.subtract { a - b } else { a + b };
        all | (result.clamp(least, most) as u32 & mask) << (index * width)
    })
}
