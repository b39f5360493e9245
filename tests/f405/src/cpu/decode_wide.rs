//! The instructions of 32 bits: DDI 0403E, A5.3.

use super::decode::{access, bits, constant, hint, plain, reg, shift_of, shifted};
use super::decode_float::float;
use super::op::{Alu, Carry, Extend, Lanes, Long, Mode, NOWHERE, Op, Shift, Unary, Width, ZERO};

/// Decodes an instruction of two half words; a branch has its own condition.
pub(crate) fn wide(at: u32, first: u32, second: u32) -> (Op, Option<u8>) {
    let undefined = Op::Undefined {
        code: first << 16 | second,
    };
    let op = match (bits(first, 11, 2), bits(first, 9, 2)) {
        (1, 0) if first & 0x40 == 0 => many(first, second),
        (1, 0) => dual_or_exclusive(first, second),
        (1, 1) => data_shifted(first, second),
        (1, _) => float(first, second),
        (2, _) if second & 0x8000 != 0 => return branch(at, first, second),
        (2, group) if group & 1 == 0 => data_immediate(first, second),
        (2, _) => data_plain(at, first, second),
        (_, 0) => single(at, first, second),
        (_, 1) if first & 0x100 == 0 => data_register(first, second),
        (_, 1) if first & 0x80 == 0 => multiply(first, second),
        (_, 1) => multiply_long(first, second),
        _ => None,
    };
    (op.unwrap_or(undefined), None)
}

fn many(first: u32, second: u32) -> Option<Op> {
    let (n, list, back) = (reg(first, 0), second as u16, first & 0x20 != 0);
    let before = match bits(first, 7, 2) {
        1 => false,
        2 => true,
        _ => return None,
    };
    Some(match first & 0x10 != 0 {
        true => Op::LoadMany {
            n,
            list,
            back,
            before,
        },
        false => Op::StoreMany {
            n,
            list,
            back,
            before,
        },
    })
}

fn dual_or_exclusive(first: u32, second: u32) -> Option<Op> {
    let (p, u, w) = (first & 0x100 != 0, first & 0x80 != 0, first & 0x20 != 0);
    let load = first & 0x10 != 0;
    let (n, t, t2) = (reg(first, 0), reg(second, 12), reg(second, 8));
    let imm = 4 * bits(second, 0, 8);
    if p || w {
        let imm = if u { imm as i32 } else { -(imm as i32) };
        let mode = mode(p, w);
        return Some(match load {
            true => Op::LoadTwo {
                t,
                t2,
                n,
                imm,
                mode,
            },
            false => Op::StoreTwo {
                t,
                t2,
                n,
                imm,
                mode,
            },
        });
    }
    let exclusive = |width, imm, d| match load {
        true => Op::LoadEx { width, t, n, imm },
        false => Op::StoreEx {
            width,
            d,
            t,
            n,
            imm,
        },
    };
    Some(match (u, bits(second, 4, 4)) {
        (false, _) => exclusive(Width::Word, imm as u16, t2),
        (true, half @ (0 | 1)) if load => Op::TableBranch {
            half: half == 1,
            n,
            m: reg(second, 0),
        },
        (true, 4) => exclusive(Width::Byte, 0, reg(second, 0)),
        (true, 5) => exclusive(Width::Half, 0, reg(second, 0)),
        _ => return None,
    })
}

fn mode(p: bool, w: bool) -> Mode {
    match (p, w) {
        (true, false) => Mode::Offset,
        (true, true) => Mode::Pre,
        (false, _) => Mode::Post,
    }
}

/// The function of a data instruction, with source and destination.
fn function(first: u32, second: u32) -> Option<(Alu, bool, u8, u8)> {
    let (s, n, d) = (first & 0x10 != 0, reg(first, 0), reg(second, 8));
    let compare = d == 15 && s;
    let compared = if compare { NOWHERE } else { d };
    Some(match bits(first, 5, 4) {
        0 => (Alu::And, s, n, compared),
        1 => (Alu::Bic, s, n, d),
        2 if n == 15 => (Alu::Mov, s, ZERO, d),
        2 => (Alu::Orr, s, n, d),
        3 if n == 15 => (Alu::Mvn, s, ZERO, d),
        3 => (Alu::Orn, s, n, d),
        4 => (Alu::Eor, s, n, compared),
        8 => (Alu::Add, s, n, compared),
        10 => (Alu::Adc, s, n, d),
        11 => (Alu::Sbc, s, n, d),
        13 => (Alu::Sub, s, n, compared),
        14 => (Alu::Rsb, s, n, d),
        _ => return None,
    })
}

fn data_shifted(first: u32, second: u32) -> Option<Op> {
    let by = bits(second, 12, 3) << 2 | bits(second, 6, 2);
    let m = reg(second, 0);
    if bits(first, 5, 4) == 6 {
        let top = second & 0x20 != 0;
        let by = if top && by == 0 { 32 } else { by };
        return Some(Op::Pkh {
            d: reg(second, 8),
            n: reg(first, 0),
            m,
            by: by as u8,
            top,
        });
    }
    let (f, s, n, d) = function(first, second)?;
    Some(shifted(f, s, d, n, m, shift_of(bits(second, 4, 2), by)))
}

fn data_immediate(first: u32, second: u32) -> Option<Op> {
    let (f, s, n, d) = function(first, second)?;
    let coded = bits(first, 10, 1) << 11 | bits(second, 12, 3) << 8 | bits(second, 0, 8);
    let (imm, carry) = expanded(coded);
    Some(Op::AluImm {
        f,
        s,
        d,
        n,
        imm,
        carry,
    })
}

/// The constant of 12 bits (A5.3.2).
fn expanded(coded: u32) -> (u32, Carry) {
    let byte = coded & 0xff;
    let imm = match coded >> 8 {
        0 => byte,
        1 => byte << 16 | byte,
        2 => byte << 24 | byte << 8,
        3 => byte * 0x0101_0101,
        _ => {
            let imm = (0x80 | coded & 0x7f).rotate_right(coded >> 7);
            let carry = if imm >> 31 == 1 {
                Carry::Set
            } else {
                Carry::Clear
            };
            return (imm, carry);
        }
    };
    (imm, Carry::Kept)
}

fn data_plain(at: u32, first: u32, second: u32) -> Option<Op> {
    let (n, d) = (reg(first, 0), reg(second, 8));
    let twelve = bits(first, 10, 1) << 11 | bits(second, 12, 3) << 8 | bits(second, 0, 8);
    let sixteen = bits(first, 0, 4) << 12 | twelve;
    let lsb = (bits(second, 12, 3) << 2 | bits(second, 6, 2)) as u8;
    let five = bits(second, 0, 5) as u8;
    let here = (at + 4) & !3;
    let signed = first & 0x80 == 0;
    let saturate = |kind| {
        let (shift, by) = if kind {
            (Shift::Asr, lsb)
        } else {
            (Shift::Lsl, lsb)
        };
        let to = if signed { five + 1 } else { five };
        Op::Saturate {
            signed,
            d,
            n,
            to,
            shift,
            by,
        }
    };
    Some(match bits(first, 4, 5) {
        0 if n == 15 => constant(d, here + twelve),
        0 => plain(Alu::Add, false, d, n, twelve),
        4 => constant(d, sixteen),
        10 if n == 15 => constant(d, here - twelve),
        10 => plain(Alu::Sub, false, d, n, twelve),
        12 => Op::Movt {
            d,
            imm: sixteen as u16,
        },
        16 | 24 => saturate(false),
        18 | 26 => saturate(true),
        20 | 28 => Op::Bfx {
            signed,
            d,
            n,
            lsb,
            width: five + 1,
        },
        22 => Op::Bfi {
            d,
            n: if n == 15 { ZERO } else { n },
            lsb,
            width: five + 1 - lsb,
        },
        _ => return None,
    })
}

fn branch(at: u32, first: u32, second: u32) -> (Op, Option<u8>) {
    let s = bits(first, 10, 1);
    let (j1, j2) = (bits(second, 13, 1), bits(second, 11, 1));
    let to = |offset: u32, count: u32| {
        let signed = (offset << (32 - count)) as i32 >> (32 - count);
        at.wrapping_add(4).wrapping_add_signed(signed)
    };
    let far = || {
        let (i1, i2) = (1 ^ j1 ^ s, 1 ^ j2 ^ s);
        let offset = s << 24 | i1 << 23 | i2 << 22 | bits(first, 0, 10) << 12;
        to(offset | bits(second, 0, 11) << 1, 25)
    };
    let op = match (second & 0x4000 != 0, second & 0x1000 != 0) {
        (true, true) => Op::BranchLink { target: far() },
        (false, true) => Op::Branch { target: far() },
        (false, false) if bits(first, 7, 3) != 7 => {
            let offset = s << 20 | j2 << 19 | j1 << 18 | bits(first, 0, 6) << 12;
            let target = to(offset | bits(second, 0, 11) << 1, 21);
            return (Op::Branch { target }, Some(bits(first, 6, 4) as u8));
        }
        _ => control(first, second),
    };
    (op, None)
}

fn control(first: u32, second: u32) -> Op {
    match (first, first & 0xffe0, bits(second, 4, 4)) {
        (_, 0xf380, _) => Op::Msr {
            n: reg(first, 0),
            special: bits(second, 0, 8) as u8,
        },
        (_, 0xf3e0, _) => Op::Mrs {
            d: reg(second, 8),
            special: bits(second, 0, 8) as u8,
        },
        (0xf3af, ..) => hint(bits(second, 0, 8)),
        (0xf3bf, _, 2) => Op::Clrex,
        // Barriers: the interpreter does everything in order.
        (0xf3bf, _, 4..=6) => Op::Nop,
        _ => Op::Undefined {
            code: first << 16 | second,
        },
    }
}

fn single(at: u32, first: u32, second: u32) -> Option<Op> {
    let (n, t) = (reg(first, 0), reg(second, 12));
    let load = first & 0x10 != 0;
    let width = match (bits(first, 5, 2), first & 0x100 != 0) {
        (0, false) => Width::Byte,
        (0, true) => Width::SignedByte,
        (1, false) => Width::Half,
        (1, true) => Width::SignedHalf,
        (2, false) => Width::Word,
        _ => return None,
    };
    if load && t == 15 && width != Width::Word {
        return Some(Op::Nop);
    }
    let up = first & 0x80 != 0;
    if load && n == 15 {
        let (here, imm) = ((at + 4) & !3, bits(second, 0, 12));
        let at = if up { here + imm } else { here - imm };
        return Some(Op::LoadAt { width, t, at });
    }
    if up {
        let imm = bits(second, 0, 12) as i32;
        return Some(access(load, width, t, n, (imm, Mode::Offset)));
    }
    if second & 0x800 != 0 {
        let imm = bits(second, 0, 8) as i32;
        let imm = if second & 0x200 != 0 { imm } else { -imm };
        let mode = mode(second & 0x400 != 0, second & 0x100 != 0);
        return Some(access(load, width, t, n, (imm, mode)));
    }
    let (m, by) = (reg(second, 0), bits(second, 4, 2) as u8);
    Some(match load {
        true => Op::LoadReg { width, t, n, m, by },
        false => Op::StoreReg { width, t, n, m, by },
    })
}

fn data_register(first: u32, second: u32) -> Option<Op> {
    let (n, d, m) = (reg(first, 0), reg(second, 8), reg(second, 0));
    let (kind, sub) = (bits(first, 4, 3), bits(second, 4, 4));
    if first & 0x80 == 0 && sub == 0 {
        let (shift, _) = shift_of(kind >> 1, 1);
        return Some(Op::ShiftReg {
            shift,
            s: kind & 1 != 0,
            d,
            n,
            m,
        });
    }
    if first & 0x80 == 0 && sub & 8 != 0 {
        let kind = match kind {
            0 => Extend::SignedHalf,
            1 => Extend::Half,
            2 => Extend::SignedBytes,
            3 => Extend::Bytes,
            4 => Extend::SignedByte,
            5 => Extend::Byte,
            _ => return None,
        };
        return Some(Op::Extend {
            kind,
            d,
            n: if n == 15 { ZERO } else { n },
            m,
            rotate: 8 * (sub & 3) as u8,
        });
    }
    let unary = |f| Op::Unary { f, d, m };
    Some(match (kind, sub) {
        (1, 8) => unary(Unary::Rev),
        (1, 9) => unary(Unary::Rev16),
        (1, 10) => unary(Unary::Rbit),
        (1, 11) => unary(Unary::Revsh),
        (3, 8) => unary(Unary::Clz),
        (0 | 1 | 4 | 5, 1 | 5) => Op::Lanes {
            f: Lanes {
                bytes: kind & 1 == 0,
                subtract: kind & 4 != 0,
                signed: sub == 1,
            },
            d,
            n,
            m,
        },
        _ => return None,
    })
}

fn multiply(first: u32, second: u32) -> Option<Op> {
    let (n, d, m) = (reg(first, 0), reg(second, 8), reg(second, 0));
    let a = match reg(second, 12) {
        15 => ZERO,
        a => a,
    };
    let sub = bits(second, 4, 4);
    let (top, m_top) = (sub & 2 != 0, sub & 1 != 0);
    Some(match (bits(first, 4, 3), sub) {
        (0, 0 | 1) => Op::Mla {
            subtract: sub == 1,
            d,
            n,
            m,
            a,
        },
        (1, 0..=3) => Op::SmlaHalf {
            d,
            n,
            m,
            a,
            n_top: top,
            m_top,
        },
        (3, 0 | 1) => Op::SmlaWord { d, n, m, a, m_top },
        (5, 0 | 1) => Op::Smmla {
            d,
            n,
            m,
            a,
            round: sub == 1,
        },
        _ => return None,
    })
}

fn multiply_long(first: u32, second: u32) -> Option<Op> {
    let (n, m) = (reg(first, 0), reg(second, 0));
    let (low, high) = (reg(second, 12), reg(second, 8));
    let f = match (bits(first, 4, 3), bits(second, 4, 4)) {
        (0, 0) => Long::Smull,
        (2, 0) => Long::Umull,
        (4, 0) => Long::Smlal,
        (6, 0) => Long::Umlal,
        (6, 6) => Long::Umaal,
        (kind @ (1 | 3), 15) => {
            return Some(Op::Div {
                signed: kind == 1,
                d: high,
                n,
                m,
            });
        }
        _ => return None,
    };
    Some(Op::Long { f, low, high, n, m })
}
