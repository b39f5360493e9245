//! From half words to instructions: ARMv7-M reference manual DDI 0403E, chapter A5.

use super::decode_wide::wide;
use super::op::{Alu, Carry, Extend, Instruction, Mode, NOWHERE, Op, Shift, Unary, Width, ZERO};

/// Returns `count` bits of `value` from bit `low` on.
pub(crate) fn bits(value: u32, low: u32, count: u32) -> u32 {
    value >> low & ((1 << count) - 1)
}

/// Returns a register's number of four bits.
pub(crate) fn reg(value: u32, low: u32) -> u8 {
    bits(value, low, 4) as u8
}

fn low_reg(value: u32, low: u32) -> u8 {
    bits(value, low, 3) as u8
}

/// Decodes what is at `at`; `fetch` reads half words. An `it` gives the instructions after it, too, which
/// then have its conditions: up to five.
pub(crate) fn decode(at: u32, mut fetch: impl FnMut(u32) -> u16) -> Vec<(u32, Instruction)> {
    let first = fetch(at);
    if !(first & 0xff00 == 0xbf00 && first & 0xf != 0) {
        return vec![(at, one(at, &mut fetch, 14))];
    }
    let nop = Instruction {
        op: Op::Nop,
        condition: 14,
        length: 2,
    };
    let (mut all, mut next) = (vec![(at, nop)], at + 2);
    let (condition, mut mask) = (first >> 4 & 0xf, first & 0xf);
    let mut now = condition;
    while mask != 0 {
        let instruction = one(next, &mut fetch, now as u8);
        all.push((next, instruction));
        next += u32::from(instruction.length);
        now = condition & 0xe | mask >> 3;
        mask = mask << 1 & 0xf;
    }
    all
}

fn one(at: u32, fetch: &mut impl FnMut(u32) -> u16, condition: u8) -> Instruction {
    let first = u32::from(fetch(at));
    let in_it = condition != 14;
    if first >> 11 < 0b11101 {
        let (op, own) = narrow(at, first, in_it);
        let op = idle_loop(at, op, fetch);
        return Instruction {
            op,
            condition: own.unwrap_or(condition),
            length: 2,
        };
    }
    let second = u32::from(fetch(at + 2));
    let (op, own) = wide(at, first, second);
    Instruction {
        op,
        condition: own.unwrap_or(condition),
        length: 4,
    }
}

/// A jump back over nothing but `nop` waits for an interrupt.
fn idle_loop(at: u32, op: Op, fetch: &mut impl FnMut(u32) -> u16) -> Op {
    let Op::Branch { target } = op else {
        return op;
    };
    let over_nothing =
        target <= at && at - target <= 16 && (target..at).step_by(2).all(|at| fetch(at) == 0xbf00);
    match over_nothing {
        true => Op::Idle { target },
        false => op,
    }
}

/// An instruction of 16 bits, with its own condition if it is a branch.
fn narrow(at: u32, code: u32, in_it: bool) -> (Op, Option<u8>) {
    let s = !in_it;
    let op = match code >> 12 {
        0 | 1 => shift_add(code, s),
        2 | 3 => immediate(code, s),
        4 => match bits(code, 10, 2) {
            0 => data(code, s),
            1 => special(code),
            _ => Op::LoadAt {
                width: Width::Word,
                t: low_reg(code, 8),
                at: ((at + 4) & !3) + 4 * bits(code, 0, 8),
            },
        },
        5 => by_register(code),
        6..=9 => by_immediate(code),
        10 => {
            let (d, imm) = (low_reg(code, 8), 4 * bits(code, 0, 8));
            match bits(code, 11, 1) {
                0 => constant(d, ((at + 4) & !3) + imm),
                _ => plain(Alu::Add, false, d, 13, imm),
            }
        }
        11 => miscellaneous(at, code),
        12 => many(code),
        13 => match bits(code, 8, 4) {
            14 => Op::Undefined { code },
            15 => Op::Svc,
            condition => {
                let target = at.wrapping_add(4).wrapping_add_signed(signed(code, 8) * 2);
                return (Op::Branch { target }, Some(condition as u8));
            }
        },
        _ => Op::Branch {
            target: at.wrapping_add(4).wrapping_add_signed(signed(code, 11) * 2),
        },
    };
    (op, None)
}

/// The low `count` bits as a signed number.
fn signed(code: u32, count: u32) -> i32 {
    (code << (32 - count)) as i32 >> (32 - count)
}

pub(crate) fn constant(d: u8, value: u32) -> Op {
    plain(Alu::Mov, false, d, ZERO, value)
}

/// With an immediate that leaves the carry of the shifter alone.
pub(crate) fn plain(f: Alu, s: bool, d: u8, n: u8, imm: u32) -> Op {
    Op::AluImm {
        f,
        s,
        d,
        n,
        imm,
        carry: Carry::Kept,
    }
}

fn registers(f: Alu, s: bool, d: u8, n: u8, m: u8) -> Op {
    shifted(f, s, d, n, m, (Shift::Lsl, 0))
}

pub(crate) fn shifted(f: Alu, s: bool, d: u8, n: u8, m: u8, (shift, by): (Shift, u8)) -> Op {
    Op::Alu {
        f,
        s,
        d,
        n,
        m,
        shift,
        by,
    }
}

/// The shift of an operand: kind and amount as they are coded.
pub(crate) fn shift_of(kind: u32, by: u32) -> (Shift, u8) {
    match (kind, by) {
        (0, by) => (Shift::Lsl, by as u8),
        (1, 0) => (Shift::Lsr, 32),
        (1, by) => (Shift::Lsr, by as u8),
        (2, 0) => (Shift::Asr, 32),
        (2, by) => (Shift::Asr, by as u8),
        (_, 0) => (Shift::Rrx, 1),
        (_, by) => (Shift::Ror, by as u8),
    }
}

fn shift_add(code: u32, s: bool) -> Op {
    let (d, n, m) = (low_reg(code, 0), low_reg(code, 3), low_reg(code, 6));
    match bits(code, 9, 4) {
        0b1100 => registers(Alu::Add, s, d, n, m),
        0b1101 => registers(Alu::Sub, s, d, n, m),
        0b1110 => plain(Alu::Add, s, d, n, u32::from(m)),
        0b1111 => plain(Alu::Sub, s, d, n, u32::from(m)),
        _ => {
            let shift = shift_of(bits(code, 11, 2), bits(code, 6, 5));
            shifted(Alu::Mov, s, d, ZERO, n, shift)
        }
    }
}

fn immediate(code: u32, s: bool) -> Op {
    let (r, imm) = (low_reg(code, 8), bits(code, 0, 8));
    match bits(code, 11, 2) {
        0 => plain(Alu::Mov, s, r, ZERO, imm),
        1 => plain(Alu::Sub, true, NOWHERE, r, imm),
        2 => plain(Alu::Add, s, r, r, imm),
        _ => plain(Alu::Sub, s, r, r, imm),
    }
}

fn data(code: u32, s: bool) -> Op {
    let (d, m) = (low_reg(code, 0), low_reg(code, 3));
    let by_register = |shift| Op::ShiftReg {
        shift,
        s,
        d,
        n: d,
        m,
    };
    match bits(code, 6, 4) {
        0 => registers(Alu::And, s, d, d, m),
        1 => registers(Alu::Eor, s, d, d, m),
        2 => by_register(Shift::Lsl),
        3 => by_register(Shift::Lsr),
        4 => by_register(Shift::Asr),
        5 => registers(Alu::Adc, s, d, d, m),
        6 => registers(Alu::Sbc, s, d, d, m),
        7 => by_register(Shift::Ror),
        8 => registers(Alu::And, true, NOWHERE, d, m),
        9 => plain(Alu::Rsb, s, d, m, 0),
        10 => registers(Alu::Sub, true, NOWHERE, d, m),
        11 => registers(Alu::Add, true, NOWHERE, d, m),
        12 => registers(Alu::Orr, s, d, d, m),
        13 => Op::Mul { s, d, n: d, m },
        14 => registers(Alu::Bic, s, d, d, m),
        _ => registers(Alu::Mvn, s, d, ZERO, m),
    }
}

fn special(code: u32) -> Op {
    let d = (bits(code, 0, 3) | bits(code, 7, 1) << 3) as u8;
    let m = reg(code, 3);
    match bits(code, 8, 2) {
        0 => registers(Alu::Add, false, d, d, m),
        1 => registers(Alu::Sub, true, NOWHERE, d, m),
        2 => registers(Alu::Mov, false, d, ZERO, m),
        _ => Op::BranchReg {
            m,
            link: code & 0x80 != 0,
        },
    }
}

fn by_register(code: u32) -> Op {
    let (t, n, m) = (low_reg(code, 0), low_reg(code, 3), low_reg(code, 6));
    let (load, width) = match bits(code, 9, 3) {
        0 => (false, Width::Word),
        1 => (false, Width::Half),
        2 => (false, Width::Byte),
        3 => (true, Width::SignedByte),
        4 => (true, Width::Word),
        5 => (true, Width::Half),
        6 => (true, Width::Byte),
        _ => (true, Width::SignedHalf),
    };
    let by = 0;
    match load {
        true => Op::LoadReg { width, t, n, m, by },
        false => Op::StoreReg { width, t, n, m, by },
    }
}

fn by_immediate(code: u32) -> Op {
    let (mut t, mut n) = (low_reg(code, 0), low_reg(code, 3));
    let five = bits(code, 6, 5) as i32;
    let (width, imm) = match code >> 12 {
        6 => (Width::Word, 4 * five),
        7 => (Width::Byte, five),
        8 => (Width::Half, 2 * five),
        _ => {
            (t, n) = (low_reg(code, 8), 13);
            (Width::Word, 4 * bits(code, 0, 8) as i32)
        }
    };
    access(bits(code, 11, 1) == 1, width, t, n, (imm, Mode::Offset))
}

pub(crate) fn access(load: bool, width: Width, t: u8, n: u8, (imm, mode): (i32, Mode)) -> Op {
    match load {
        true => Op::Load {
            width,
            t,
            n,
            imm,
            mode,
        },
        false => Op::Store {
            width,
            t,
            n,
            imm,
            mode,
        },
    }
}

fn miscellaneous(at: u32, code: u32) -> Op {
    let (d, m) = (low_reg(code, 0), low_reg(code, 3));
    if code & 0xf500 == 0xb100 {
        let way = bits(code, 3, 5) << 1 | bits(code, 9, 1) << 6;
        return Op::BranchZero {
            n: d,
            nonzero: code & 0x800 != 0,
            target: at + 4 + way,
        };
    }
    let extend = |kind| Op::Extend {
        kind,
        d,
        n: ZERO,
        m,
        rotate: 0,
    };
    let unary = |f| Op::Unary { f, d, m };
    let list = bits(code, 0, 8) as u16;
    match bits(code, 6, 6) {
        0b000000 | 0b000001 => plain(Alu::Add, false, 13, 13, 4 * bits(code, 0, 7)),
        0b000010 | 0b000011 => plain(Alu::Sub, false, 13, 13, 4 * bits(code, 0, 7)),
        0b001000 => extend(Extend::SignedHalf),
        0b001001 => extend(Extend::SignedByte),
        0b001010 => extend(Extend::Half),
        0b001011 => extend(Extend::Byte),
        0b010000..=0b010111 => Op::StoreMany {
            n: 13,
            list: list | ((code & 0x100) as u16) << 6,
            back: true,
            before: true,
        },
        0b110000..=0b110111 => Op::LoadMany {
            n: 13,
            list: list | ((code & 0x100) as u16) << 7,
            back: true,
            before: false,
        },
        0b011001 => Op::Cps {
            disable: code & 0x10 != 0,
            i: code & 2 != 0,
            f: code & 1 != 0,
        },
        0b101000 => unary(Unary::Rev),
        0b101001 => unary(Unary::Rev16),
        0b101011 => unary(Unary::Revsh),
        0b111000..=0b111011 => Op::Bkpt,
        0b111100..=0b111111 => hint(bits(code, 4, 4)),
        _ => Op::Undefined { code },
    }
}

pub(crate) fn hint(number: u32) -> Op {
    match number {
        2 => Op::Wfe,
        3 => Op::Wfi,
        4 => Op::Sev,
        _ => Op::Nop,
    }
}

fn many(code: u32) -> Op {
    let (n, list) = (low_reg(code, 8), bits(code, 0, 8) as u16);
    match code & 0x800 != 0 {
        true => Op::LoadMany {
            n,
            list,
            back: list >> n & 1 == 0,
            before: false,
        },
        false => Op::StoreMany {
            n,
            list,
            back: true,
            before: false,
        },
    }
}
