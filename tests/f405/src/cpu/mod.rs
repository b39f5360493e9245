//! The core: a Cortex-M4F that takes one instruction after the other. All of them cost the same time, a
//! parameter: cycle-exact timing of this core depends on its prefetch and is not modelled.

mod arithmetic;
pub(crate) mod decode;
mod decode_float;
mod decode_wide;
mod exception;
mod execute;
mod float;
mod memory;
mod op;

use crate::chip::{Chip, FLASH};
use op::Instruction;
pub(crate) use op::Op;
use std::collections::HashMap;

/// The registers and the decoded program.
pub struct Core {
    /// R0 to R15; then one that takes what nobody wants, and one that is 0.
    pub(crate) r: [u32; 18],
    /// The address of the next instruction.
    pub(crate) next: u32,
    pub(crate) n: bool,
    pub(crate) z: bool,
    pub(crate) c: bool,
    pub(crate) v: bool,
    q: bool,
    /// The stack pointer that is not in use.
    other_sp: u32,
    control: u32,
    /// The exception that runs.
    pub(crate) ipsr: u32,
    pub(crate) s: [u32; 33],
    fpscr: u32,
    /// FPU state may be used as it is: no lazy frame waits, and CONTROL.FPCA is set.
    float_ready: bool,
    exclusive: bool,
    pub(crate) asleep: bool,
    event: bool,
    decoded: Vec<Option<Instruction>>,
    elsewhere: HashMap<u32, (u32, Instruction)>,
    /// Instructions executed, and of them in each exception: its mean and largest are a budget.
    pub instructions: u64,
    pub(crate) entered: Vec<(u32, u64)>,
}

impl Core {
    /// A core whose decoded program covers `bytes` of flash.
    pub(crate) fn new(bytes: usize) -> Self {
        Core {
            r: [0; 18],
            next: 0,
            n: false,
            z: false,
            c: false,
            v: false,
            q: false,
            other_sp: 0,
            control: 0,
            ipsr: 0,
            s: [0; 33],
            fpscr: 0,
            float_ready: false,
            exclusive: false,
            asleep: false,
            event: false,
            decoded: vec![None; bytes / 2],
            elsewhere: HashMap::new(),
            instructions: 0,
            entered: Vec::new(),
        }
    }

    /// Starts at the reset vector.
    pub(crate) fn reset(&mut self, chip: &mut Chip) {
        let decoded = std::mem::take(&mut self.decoded);
        let instructions = self.instructions;
        *self = Core::new(0);
        (self.decoded, self.instructions) = (decoded, instructions);
        self.r[13] = chip.word(FLASH) & !3;
        self.r[14] = u32::MAX;
        self.next = chip.word(FLASH + 4) & !1;
    }

    /// Runs instructions until the chip wants something: an event that is due, an access that may change an
    /// interrupt.
    pub(crate) fn run(&mut self, chip: &mut Chip, until: u64) {
        let cost = chip.instruction_time();
        while chip.now < until && !chip.attention {
            let instruction = self.fetch(chip);
            chip.now += cost;
            self.instructions += 1;
            let at = self.next;
            self.r[15] = at.wrapping_add(4);
            self.next = at.wrapping_add(u32::from(instruction.length));
            if instruction.condition == 14 || self.holds(instruction.condition) {
                self.execute(chip, instruction.op, at, until);
            }
            if self.asleep {
                return;
            }
        }
    }

    fn fetch(&mut self, chip: &mut Chip) -> Instruction {
        let index = (self.next.wrapping_sub(FLASH) >> 1) as usize;
        if let Some(Some(instruction)) = self.decoded.get(index) {
            return *instruction;
        }
        self.decode(chip, index)
    }

    #[cold]
    fn decode(&mut self, chip: &mut Chip, index: usize) -> Instruction {
        let at = self.next;
        let raw = |at: u32| chip.peek(at);
        let word = u32::from(raw(at)) | u32::from(raw(at.wrapping_add(2))) << 16;
        // Outside of the program, in RAM, what is there may have changed.
        if let Some((was, instruction)) = self.elsewhere.get(&at)
            && *was == word
        {
            return *instruction;
        }
        let all = decode::decode(at, raw);
        for (at, instruction) in &all {
            let index = (at.wrapping_sub(FLASH) >> 1) as usize;
            match self.decoded.get_mut(index) {
                Some(slot) => *slot = Some(*instruction),
                None => {
                    let word = u32::from(raw(*at)) | u32::from(raw(at.wrapping_add(2))) << 16;
                    self.elsewhere.insert(*at, (word, *instruction));
                }
            }
        }
        let _ = index;
        all[0].1
    }

    fn holds(&self, condition: u8) -> bool {
        let holds = match condition >> 1 {
            0 => self.z,
            1 => self.c,
            2 => self.n,
            3 => self.v,
            4 => self.c && !self.z,
            5 => self.n == self.v,
            6 => self.n == self.v && !self.z,
            _ => true,
        };
        holds != (condition & 1 == 1 && condition != 15)
    }

    /// The flags as they stand in xPSR.
    fn flags(&self) -> u32 {
        u32::from(self.n) << 31
            | u32::from(self.z) << 30
            | u32::from(self.c) << 29
            | u32::from(self.v) << 28
            | u32::from(self.q) << 27
    }

    fn set_flags(&mut self, psr: u32) {
        self.n = psr >> 31 & 1 == 1;
        self.z = psr >> 30 & 1 == 1;
        self.c = psr >> 29 & 1 == 1;
        self.v = psr >> 28 & 1 == 1;
        self.q = psr >> 27 & 1 == 1;
    }

    /// Replaces the decoded instruction at an address by a jump to itself: what runs there hangs.
    pub(crate) fn hang_at(&mut self, at: u32) {
        let hang = Instruction {
            op: op::Op::Idle { target: at },
            condition: 14,
            length: 2,
        };
        if let Some(slot) = self.decoded.get_mut((at.wrapping_sub(FLASH) >> 1) as usize) {
            *slot = Some(hang);
        }
    }

    /// Forgets what was decoded, such as [`Core::hang_at`].
    pub(crate) fn forget(&mut self) {
        self.decoded.fill(None);
        self.elsewhere.clear();
    }
}
