//! What each instruction does.

use super::Core;
use super::arithmetic::{extended, lanes, shifted, unary};
use super::float;
use super::op::{Carry, Op};
use crate::chip::Chip;

impl Core {
    /// Writes a register; the program counter is a jump.
    fn put(&mut self, chip: &mut Chip, d: u8, value: u32) {
        match d {
            15 => self.jump(chip, value),
            d => self.r[d as usize] = value,
        }
    }

    fn reg(&self, index: u8) -> u32 {
        self.r[index as usize]
    }

    #[inline(always)]
    pub(super) fn execute(&mut self, chip: &mut Chip, op: Op, at: u32, until: u64) {
        match op {
            Op::Alu {
                f,
                s,
                d,
                n,
                m,
                shift,
                by,
            } => {
                let (b, carry) = shifted(self.reg(m), shift, u32::from(by), self.c);
                let result = self.alu(f, s, self.reg(n), b, carry);
                self.put(chip, d, result);
            }
            Op::AluImm {
                f,
                s,
                d,
                n,
                imm,
                carry,
            } => {
                let carry = match carry {
                    Carry::Kept => self.c,
                    other => other == Carry::Set,
                };
                let result = self.alu(f, s, self.reg(n), imm, carry);
                self.put(chip, d, result);
            }
            Op::Load {
                width,
                t,
                n,
                imm,
                mode,
            } => {
                let at = self.address(n, imm, mode);
                let value = self.load(chip, width, at);
                self.put(chip, t, value);
            }
            Op::Store {
                width,
                t,
                n,
                imm,
                mode,
            } => {
                let value = self.reg(t);
                let at = self.address(n, imm, mode);
                self.store(chip, width, at, value);
            }
            Op::LoadReg { width, t, n, m, by } => {
                let at = self.reg(n).wrapping_add(self.reg(m) << by);
                let value = self.load(chip, width, at);
                self.put(chip, t, value);
            }
            Op::StoreReg { width, t, n, m, by } => {
                let at = self.reg(n).wrapping_add(self.reg(m) << by);
                self.store(chip, width, at, self.reg(t));
            }
            Op::LoadAt { width, t, at } => {
                let value = self.load(chip, width, at);
                self.put(chip, t, value);
            }
            Op::Branch { target } => self.next = target,
            Op::BranchLink { target } => {
                self.r[14] = self.next | 1;
                self.next = target;
            }
            Op::BranchReg { m, link } => {
                let to = self.reg(m);
                if link {
                    self.r[14] = self.next | 1;
                }
                self.jump(chip, to);
            }
            Op::BranchZero { n, nonzero, target } => {
                if (self.reg(n) == 0) != nonzero {
                    self.next = target;
                }
            }
            Op::Idle { target } => {
                self.next = target;
                chip.now = chip.now.max(until);
            }
            Op::Nop => {}
            Op::Float { .. }
            | Op::FloatUnary { .. }
            | Op::FloatImm { .. }
            | Op::Fixed { .. }
            | Op::FloatCompare { .. }
            | Op::FloatFromCore { .. }
            | Op::FloatToCore { .. }
            | Op::FloatsFromCore { .. }
            | Op::FloatsToCore { .. }
            | Op::FloatStatus { .. }
            | Op::SetFloatStatus { .. }
            | Op::FloatLoad { .. }
            | Op::FloatStore { .. }
            | Op::FloatMany { .. } => {
                if self.float_ready || self.make_float_ready(chip, at) {
                    self.execute_float(chip, op);
                }
            }
            _ => self.execute_rarer(chip, op, at),
        }
    }

    fn execute_rarer(&mut self, chip: &mut Chip, op: Op, at: u32) {
        match op {
            Op::ShiftReg { shift, s, d, n, m } => {
                let (result, carry) = shifted(self.reg(n), shift, self.reg(m) & 0xff, self.c);
                if s {
                    self.signs(result);
                    self.c = carry;
                }
                self.put(chip, d, result);
            }
            Op::Movt { d, imm } => {
                self.r[d as usize] = self.reg(d) & 0xffff | u32::from(imm) << 16;
            }
            Op::Bfi { d, n, lsb, width } => {
                let mask = (u64::from(u32::MAX) >> (32 - width)) as u32;
                let value = (self.reg(n) & mask) << lsb;
                self.r[d as usize] = self.reg(d) & !(mask << lsb) | value;
            }
            Op::Bfx {
                signed,
                d,
                n,
                lsb,
                width,
            } => {
                let top = self.reg(n) << (32 - u32::from(width) - u32::from(lsb));
                self.r[d as usize] = match signed {
                    true => (top as i32 >> (32 - width)) as u32,
                    false => top >> (32 - width),
                };
            }
            Op::Saturate {
                signed,
                d,
                n,
                to,
                shift,
                by,
            } => {
                let (value, _) = shifted(self.reg(n), shift, u32::from(by), false);
                self.r[d as usize] = self.saturate(signed, value, to);
            }
            Op::Pkh { d, n, m, by, top } => {
                let (n, m) = (self.reg(n), self.reg(m));
                self.r[d as usize] = match top {
                    true => n & 0xffff_0000 | (m as i32 >> by.min(31)) as u32 & 0xffff,
                    false => n & 0xffff | m << by & 0xffff_0000,
                };
            }
            Op::Extend {
                kind,
                d,
                n,
                m,
                rotate,
            } => {
                let value = extended(kind, self.reg(m).rotate_right(u32::from(rotate)));
                self.r[d as usize] = self.reg(n).wrapping_add(value);
            }
            Op::Unary { f, d, m } => self.r[d as usize] = unary(f, self.reg(m)),
            Op::Lanes { f, d, n, m } => self.r[d as usize] = lanes(f, self.reg(n), self.reg(m)),
            Op::LoadMany {
                n,
                list,
                back,
                before,
            } => self.load_many(chip, n, list, (back, before)),
            Op::StoreMany {
                n,
                list,
                back,
                before,
            } => self.store_many(chip, n, list, (back, before)),
            Op::LoadTwo {
                t,
                t2,
                n,
                imm,
                mode,
            } => {
                let at = self.address(n, imm, mode);
                let (low, high) = (chip.read(at, 4), chip.read(at.wrapping_add(4), 4));
                (self.r[t as usize], self.r[t2 as usize]) = (low, high);
            }
            Op::StoreTwo {
                t,
                t2,
                n,
                imm,
                mode,
            } => {
                let (low, high) = (self.reg(t), self.reg(t2));
                let at = self.address(n, imm, mode);
                chip.write(at, 4, low);
                chip.write(at.wrapping_add(4), 4, high);
            }
            Op::TableBranch { half, n, m } => {
                let (base, index) = (self.reg(n), self.reg(m));
                let way = match half {
                    true => chip.read(base.wrapping_add(2 * index), 2),
                    false => chip.read(base.wrapping_add(index), 1),
                };
                self.next = self.r[15].wrapping_add(2 * way);
            }
            Op::LoadEx { width, t, n, imm } => {
                let at = self.reg(n).wrapping_add(u32::from(imm));
                self.r[t as usize] = self.load(chip, width, at);
                self.exclusive = true;
            }
            Op::StoreEx {
                width,
                d,
                t,
                n,
                imm,
            } => {
                let at = self.reg(n).wrapping_add(u32::from(imm));
                if self.exclusive {
                    self.store(chip, width, at, self.reg(t));
                }
                self.r[d as usize] = u32::from(!self.exclusive);
                self.exclusive = false;
            }
            Op::Clrex => self.exclusive = false,
            _ => self.execute_multiply(chip, op, at),
        }
    }

    fn execute_multiply(&mut self, chip: &mut Chip, op: Op, at: u32) {
        let half = |value: u32, top: bool| match top {
            true => i64::from(value as i32 >> 16),
            false => i64::from(value as i16),
        };
        match op {
            Op::Mul { s, d, n, m } => {
                let result = self.reg(n).wrapping_mul(self.reg(m));
                if s {
                    self.signs(result);
                }
                self.r[d as usize] = result;
            }
            Op::Mla {
                subtract,
                d,
                n,
                m,
                a,
            } => {
                let product = self.reg(n).wrapping_mul(self.reg(m));
                self.r[d as usize] = match subtract {
                    true => self.reg(a).wrapping_sub(product),
                    false => self.reg(a).wrapping_add(product),
                };
            }
            Op::SmlaHalf {
                d,
                n,
                m,
                a,
                n_top,
                m_top,
            } => {
                let product = half(self.reg(n), n_top) * half(self.reg(m), m_top);
                self.r[d as usize] = self.reg(a).wrapping_add(product as u32);
            }
            Op::SmlaWord { d, n, m, a, m_top } => {
                let product = (i64::from(self.reg(n) as i32) * half(self.reg(m), m_top)) >> 16;
                self.r[d as usize] = self.reg(a).wrapping_add(product as u32);
            }
            Op::Smmla { d, n, m, a, round } => {
                let product = i64::from(self.reg(n) as i32) * i64::from(self.reg(m) as i32);
                let base = i64::from(self.reg(a)) << 32;
                let rounding = if round { 0x8000_0000 } else { 0 };
                let all = base.wrapping_add(product).wrapping_add(rounding);
                self.r[d as usize] = (all >> 32) as u32;
            }
            Op::Long { f, low, high, n, m } => self.long(f, (low, high), self.reg(n), self.reg(m)),
            Op::Div { signed, d, n, m } => {
                let (n, m) = (self.reg(n), self.reg(m));
                self.r[d as usize] = match (m, signed) {
                    (0, _) => 0,
                    (_, true) => (n as i32).wrapping_div(m as i32) as u32,
                    (_, false) => n / m,
                };
            }
            _ => self.execute_system(chip, op, at),
        }
    }

    fn execute_float(&mut self, chip: &mut Chip, op: Op) {
        let s = |core: &Core, index: u8| core.s[index as usize];
        match op {
            Op::Float { f, d, n, m } => {
                self.s[d as usize] = float::binary(f, s(self, d), s(self, n), s(self, m));
            }
            Op::FloatUnary { f, d, m } => self.s[d as usize] = float::unary(f, s(self, m)),
            Op::FloatImm { d, bits } => self.s[d as usize] = bits,
            Op::Fixed {
                d,
                to_fixed,
                unsigned,
                half,
                fraction,
            } => {
                let bits = s(self, d);
                self.s[d as usize] = float::fixed(bits, to_fixed, unsigned, half, fraction);
            }
            Op::FloatCompare { d, m } => self.compare(s(self, d), s(self, m)),
            Op::FloatFromCore { s, t } => self.s[s as usize] = self.reg(t),
            Op::FloatToCore { s, t } => self.r[t as usize] = self.s[s as usize],
            Op::FloatsFromCore { s, t, t2 } => {
                (self.s[s as usize], self.s[s as usize + 1]) = (self.reg(t), self.reg(t2));
            }
            Op::FloatsToCore { s, t, t2 } => {
                self.r[t as usize] = self.s[s as usize];
                self.r[t2 as usize] = self.s[s as usize + 1];
            }
            Op::FloatStatus { t: 15 } => {
                let q = self.q;
                self.set_flags(self.fpscr);
                self.q = q;
            }
            Op::FloatStatus { t } => self.r[t as usize] = self.fpscr,
            Op::SetFloatStatus { t } => self.fpscr = self.reg(t),
            Op::FloatLoad { s, words, n, imm } => {
                let at = self.float_base(n).wrapping_add_signed(imm);
                self.float_many(chip, true, s, words, at);
            }
            Op::FloatStore { s, words, n, imm } => {
                let at = self.float_base(n).wrapping_add_signed(imm);
                self.float_many(chip, false, s, words, at);
            }
            Op::FloatMany {
                load,
                s,
                words,
                n,
                back,
                before,
            } => {
                let at = self.span(n, u32::from(words), back, before);
                self.float_many(chip, load, s, words, at);
            }
            _ => {}
        }
    }

    /// A literal lies at a multiple of four from the program counter.
    fn float_base(&self, n: u8) -> u32 {
        match n {
            15 => self.r[15] & !3,
            n => self.reg(n),
        }
    }
}
