//! Exceptions: entry and return with the lazy stacking of the FPU, faults, and the instructions of the system.

use super::Core;
use super::op::Op;
use crate::chip::Chip;

/// Cycles of an entry and of a return (DDI 0439B, 3.9), the vector's fetch from flash not counted.
const ENTRY_CYCLES: u64 = 12;
const RETURN_CYCLES: u64 = 10;
const HARD_FAULT: u32 = 3;
/// CONTROL: the process stack is in use; the FPU has been used.
const SPSEL: u32 = 2;
const FPCA: u32 = 4;
/// FPCCR: state is kept, lazily; a lazy frame waits.
const ASPEN: u32 = 1 << 31;
const LSPEN: u32 = 1 << 30;
const LSPACT: u32 = 1;

impl Core {
    /// Jumps to an address that came out of a register or of memory; the highest ones end an exception.
    pub(super) fn jump(&mut self, chip: &mut Chip, to: u32) {
        match to >= 0xffff_ffe0 && self.ipsr != 0 {
            true => self.end_exception(chip, to),
            false => self.next = to & !1,
        }
    }

    /// Takes an exception.
    pub(crate) fn begin_exception(&mut self, chip: &mut Chip, number: u32) {
        let with_float = self.control & FPCA != 0;
        let size = if with_float { 0x68 } else { 0x20 };
        let before = self.r[13];
        let frame = before.wrapping_sub(size) & !7;
        let aligned = before & 4;
        let psr = self.flags() | self.ipsr | aligned << 7;
        let (r, next) = (self.r, self.next);
        let words = [r[0], r[1], r[2], r[3], r[12], r[14], next, psr];
        for (index, word) in words.into_iter().enumerate() {
            chip.write(frame + 4 * index as u32, 4, word);
        }
        if with_float {
            chip.scs.fpcar = frame + 0x20;
            match chip.scs.fpccr & LSPEN != 0 {
                true => chip.scs.fpccr |= LSPACT,
                false => self.save_float(chip),
            }
        }
        self.r[13] = frame;
        self.r[14] = self.exception_return(with_float);
        self.use_stack(false);
        self.control &= !FPCA;
        self.float_ready = false;
        self.exclusive = false;
        self.ipsr = number;
        self.next = chip.word(chip.scs.vtor + 4 * number) & !1;
        chip.scs.begin(number);
        chip.now += ENTRY_CYCLES * chip.cycle();
        self.entered.push((number, self.instructions));
        chip.trace.entered(number, chip.now);
    }

    fn exception_return(&self, with_float: bool) -> u32 {
        let to = match (self.ipsr != 0, self.control & SPSEL != 0) {
            (true, _) => 0xffff_fff1,
            (false, false) => 0xffff_fff9,
            (false, true) => 0xffff_fffd,
        };
        if with_float { to & !0x10 } else { to }
    }

    fn end_exception(&mut self, chip: &mut Chip, how: u32) {
        chip.now += RETURN_CYCLES * chip.cycle();
        chip.scs.end(self.ipsr);
        if let Some((number, started)) = self.entered.pop() {
            chip.trace
                .left(number, self.instructions - started, chip.now);
        }
        self.use_stack(how & 4 != 0);
        let frame = self.r[13];
        let word = |chip: &mut Chip, index: u32| chip.read(frame + 4 * index, 4);
        for index in 0..4 {
            self.r[index as usize] = word(chip, index);
        }
        self.r[12] = word(chip, 4);
        self.r[14] = word(chip, 5);
        self.next = word(chip, 6) & !1;
        let psr = word(chip, 7);
        let with_float = how & 0x10 == 0;
        self.control = self.control & !FPCA | if with_float { FPCA } else { 0 };
        self.float_ready = with_float;
        if with_float && chip.scs.fpccr & LSPACT != 0 {
            // Nobody has touched the registers since.
            chip.scs.fpccr &= !LSPACT;
        } else if with_float {
            for index in 0..16 {
                self.s[index as usize] = word(chip, 8 + index);
            }
            self.fpscr = word(chip, 24);
        }
        let size = if with_float { 0x68 } else { 0x20 };
        self.r[13] = frame + size + (psr >> 7 & 4);
        self.ipsr = psr & 0x1ff;
        self.set_flags(psr);
        self.exclusive = false;
        chip.attention = true;
    }

    /// Makes the process stack or the main stack the one in use.
    fn use_stack(&mut self, process: bool) {
        if process != (self.control & SPSEL != 0) {
            std::mem::swap(&mut self.r[13], &mut self.other_sp);
            self.control ^= SPSEL;
        }
    }

    /// Prepares the FPU for an instruction: false if it is off.
    #[cold]
    pub(super) fn make_float_ready(&mut self, chip: &mut Chip, at: u32) -> bool {
        const NO_COPROCESSOR: u32 = 1 << 19;
        if chip.scs.cpacr >> 20 & 0xf != 0xf {
            self.fault(chip, at, NO_COPROCESSOR);
            return false;
        }
        if chip.scs.fpccr & LSPACT != 0 {
            self.save_float(chip);
            chip.scs.fpccr &= !LSPACT;
        }
        if self.control & FPCA == 0 && chip.scs.fpccr & ASPEN != 0 {
            self.control |= FPCA;
            self.fpscr = chip.scs.fpdscr;
        }
        self.float_ready = true;
        true
    }

    fn save_float(&mut self, chip: &mut Chip) {
        let frame = chip.scs.fpcar;
        for index in 0..16 {
            chip.write(frame + 4 * index, 4, self.s[index as usize]);
        }
        chip.write(frame + 64, 4, self.fpscr);
        // 18 words: what lazy stacking saves where it is not needed.
        chip.now += 18 * chip.cycle();
    }

    /// A fault of an instruction: a hard fault, since nothing enables the finer ones.
    pub(super) fn fault(&mut self, chip: &mut Chip, at: u32, why: u32) {
        self.next = at;
        chip.scs.cfsr |= why;
        chip.scs.hfsr |= 1 << 30;
        chip.scs.pend(HARD_FAULT);
        chip.attention = true;
    }

    pub(super) fn execute_system(&mut self, chip: &mut Chip, op: Op, at: u32) {
        const UNDEFINED: u32 = 1 << 16;
        match op {
            Op::Cps { disable, i, f } => {
                if i {
                    chip.scs.primask = disable;
                }
                if f {
                    chip.scs.faultmask = disable;
                }
                chip.attention = true;
            }
            Op::Mrs { d, special } => self.r[d as usize] = self.special(chip, special),
            Op::Msr { n, special } => self.set_special(chip, special, self.r[n as usize]),
            Op::Wfi => {
                self.asleep = true;
                chip.attention = true;
            }
            Op::Wfe => {
                self.asleep = !self.event;
                self.event = false;
                chip.attention = true;
            }
            Op::Sev => self.event = true,
            Op::Svc => {
                chip.scs.pend(11);
                chip.attention = true;
            }
            Op::Bkpt => {
                chip.scs.hfsr |= 1 << 31;
                self.fault(chip, at, 0);
            }
            Op::Undefined { code } => {
                chip.trace.undefined(at, code);
                self.fault(chip, at, UNDEFINED);
            }
            other => {
                chip.trace.undefined(at, 0);
                debug_assert!(false, "{other:?} has no meaning");
                self.fault(chip, at, UNDEFINED);
            }
        }
    }

    /// A special register (DDI 0403E, B5.1.1).
    fn special(&self, chip: &Chip, special: u8) -> u32 {
        let process = self.control & SPSEL != 0;
        match special {
            0..=3 => {
                let flags = if special & 4 == 0 { self.flags() } else { 0 };
                flags | if special & 1 == 1 { self.ipsr } else { 0 }
            }
            5 => self.ipsr,
            8 if process => self.other_sp,
            8 => self.r[13],
            9 if process => self.r[13],
            9 => self.other_sp,
            16 => u32::from(chip.scs.primask),
            17 | 18 => u32::from(chip.scs.basepri),
            19 => u32::from(chip.scs.faultmask),
            20 => self.control,
            _ => 0,
        }
    }

    fn set_special(&mut self, chip: &mut Chip, special: u8, value: u32) {
        let process = self.control & SPSEL != 0;
        match special {
            0..=3 => self.set_flags(value),
            8 if process => self.other_sp = value & !3,
            8 => self.r[13] = value & !3,
            9 if process => self.r[13] = value & !3,
            9 => self.other_sp = value & !3,
            16 => chip.scs.primask = value & 1 == 1,
            17 => chip.scs.basepri = value as u8 & 0xf0,
            18 => {
                let (now, new) = (chip.scs.basepri, value as u8 & 0xf0);
                if new != 0 && (now == 0 || new < now) {
                    chip.scs.basepri = new;
                }
            }
            19 => chip.scs.faultmask = value & 1 == 1,
            20 => {
                if self.ipsr == 0 {
                    self.use_stack(value & SPSEL != 0);
                }
                self.control = self.control & !(FPCA | 1) | value & (FPCA | 1);
                self.float_ready &= value & FPCA != 0;
            }
            _ => {}
        }
        chip.attention = true;
    }
}
