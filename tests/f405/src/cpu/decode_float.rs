//! The instructions of the FPU, of single precision: DDI 0403E, A6.

use super::decode::{bits, reg};
use super::op::{Float, FloatUnary, Op};

/// The number of a single register: four bits and one more below them.
fn single(value: u32, low: u32, least: u32) -> u8 {
    (bits(value, low, 4) << 1 | least & 1) as u8
}

/// The first single register of a double one.
fn double(value: u32, low: u32) -> u8 {
    2 * bits(value, low, 4) as u8
}

/// Decodes an instruction of coprocessor 10 or 11.
pub(crate) fn float(first: u32, second: u32) -> Option<Op> {
    if bits(second, 9, 3) != 0b101 || first & 0x1000 != 0 {
        return None;
    }
    match bits(first, 8, 4) {
        0xe if second & 0x10 == 0 => arithmetic(first, second),
        0xe => transfer(first, second),
        _ if first & 0xffe0 == 0xec40 => transfer_two(first, second),
        _ => memory(first, second),
    }
}

fn arithmetic(first: u32, second: u32) -> Option<Op> {
    if second & 0x100 != 0 {
        return None;
    }
    let d = single(second, 12, first >> 6);
    let n = single(first, 0, second >> 7);
    let m = single(second, 0, second >> 5);
    let kind = bits(first, 7, 1) << 2 | bits(first, 4, 2);
    let f = match (kind, second & 0x40 != 0) {
        (0, false) => Float::Mla,
        (0, true) => Float::Mls,
        (1, false) => Float::Nmls,
        (1, true) => Float::Nmla,
        (2, false) => Float::Mul,
        (2, true) => Float::Nmul,
        (3, false) => Float::Add,
        (3, true) => Float::Sub,
        (4, false) => Float::Div,
        (5, false) => Float::Fnms,
        (5, true) => Float::Fnma,
        (6, false) => Float::Fma,
        (6, true) => Float::Fms,
        (7, false) => {
            let bits = constant(bits(first, 0, 4) << 4 | bits(second, 0, 4));
            return Some(Op::FloatImm { d, bits });
        }
        _ => return unary(first, second, d, m),
    };
    Some(Op::Float { f, d, n, m })
}

/// The constant of eight bits (A6.4.1).
fn constant(imm: u32) -> u32 {
    let (sign, b, low) = (imm >> 7, imm >> 6 & 1, imm & 0x3f);
    let exponent = if b == 1 { 0b01_1111 } else { 0b10_0000 };
    sign << 31 | exponent << 25 | low << 19
}

fn unary(first: u32, second: u32, d: u8, m: u8) -> Option<Op> {
    let seven = second & 0x80 != 0;
    let f = match (bits(first, 0, 4), seven) {
        (0, false) => FloatUnary::Mov,
        (0, true) => FloatUnary::Abs,
        (1, false) => FloatUnary::Neg,
        (1, true) => FloatUnary::Sqrt,
        (4, _) => return Some(Op::FloatCompare { d, m }),
        (5, _) => return Some(Op::FloatCompare { d, m: 32 }),
        (8, false) => FloatUnary::FromUnsigned,
        (8, true) => FloatUnary::FromSigned,
        (12, true) => FloatUnary::ToUnsigned,
        (12, false) => FloatUnary::ToUnsignedRounded,
        (13, true) => FloatUnary::ToSigned,
        (13, false) => FloatUnary::ToSignedRounded,
        (kind @ (10 | 11 | 14 | 15), long) => {
            let imm = bits(second, 0, 4) << 1 | bits(second, 5, 1);
            let size: u32 = if long { 32 } else { 16 };
            return Some(Op::Fixed {
                d,
                to_fixed: kind >= 14,
                unsigned: kind & 1 == 1,
                half: !long,
                fraction: size.checked_sub(imm)? as u8,
            });
        }
        _ => return None,
    };
    Some(Op::FloatUnary { f, d, m })
}

fn transfer(first: u32, second: u32) -> Option<Op> {
    let (load, t) = (first & 0x10 != 0, reg(second, 12));
    let s = match (second & 0x100 != 0, bits(first, 5, 3)) {
        (false, 0) => single(first, 0, second >> 7),
        (false, 7) if load => return Some(Op::FloatStatus { t }),
        (false, 7) => return Some(Op::SetFloatStatus { t }),
        (true, half @ (0 | 1)) => double(first, 0) + half as u8,
        _ => return None,
    };
    Some(match load {
        true => Op::FloatToCore { s, t },
        false => Op::FloatFromCore { s, t },
    })
}

fn transfer_two(first: u32, second: u32) -> Option<Op> {
    let (t, t2) = (reg(second, 12), reg(first, 0));
    let s = match second & 0x100 != 0 {
        true => double(second, 0),
        false => single(second, 0, second >> 5),
    };
    Some(match first & 0x10 != 0 {
        true => Op::FloatsToCore { s, t, t2 },
        false => Op::FloatsFromCore { s, t, t2 },
    })
}

fn memory(first: u32, second: u32) -> Option<Op> {
    let is_double = second & 0x100 != 0;
    let s = match is_double {
        true => double(second, 12),
        false => single(second, 12, first >> 6),
    };
    let (n, load) = (reg(first, 0), first & 0x10 != 0);
    let (p, u, back) = (first & 0x100 != 0, first & 0x80 != 0, first & 0x20 != 0);
    let count = bits(second, 0, 8);
    if p && !back {
        let way = 4 * count as i32;
        let imm = if u { way } else { -way };
        let words = if is_double { 2 } else { 1 };
        return Some(match load {
            true => Op::FloatLoad { s, words, n, imm },
            false => Op::FloatStore { s, words, n, imm },
        });
    }
    Some(Op::FloatMany {
        load,
        s,
        words: count as u8,
        n,
        back,
        before: p && !u,
    })
}
